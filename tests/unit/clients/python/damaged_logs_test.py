#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests sonard_client.read_log() on logs with one wrong bit, for each bit, and on logs that are cut, for each length, against
the samples written.

    damaged_logs_test.py [DamagedLogs.test_name ...]
"""

import os
import re
import struct
import sys
import tempfile
import unittest
import warnings
import zipfile
import zlib

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "clients", "python"), os.path.join(SOURCE, "tests", "support")]

import glf_writer  # noqa: E402
from sonard_client import DamagedLog, read_log  # noqa: E402

try:
    import zstandard
except ImportError:
    zstandard = None

PINGS = 6
PINGS_IN_CHUNK = 2
MAGIC = b"\x89MCAP0\r\n"


def samples_of(number):
    return bytes((31 * number + 7 * i * i) % 251 for i in range(12))


def text(value):
    return struct.pack("<I", len(value)) + value


def record(kind, content):
    return struct.pack("<BQ", kind, len(content)) + content


def scan_line(number):
    """A ScanLine: head, time, bins, metres per bin and sound speed."""
    return (b"\x0a\x03bow\x20" + bytes([number + 1]) + b"\x32" + bytes([len(samples_of(number))]) + samples_of(number) +
            struct.pack("<BdBd", 0x41, 0.01, 0x49, 1500.0))


def message(number, channel=1):
    return record(5, struct.pack("<HIQQ", channel, number, number, number) + scan_line(number))


def chunk(records, crc=None, compression=b"", stored=None):
    stored = records if stored is None else stored
    return record(6, struct.pack("<QQQI", 0, 9, len(records), zlib.crc32(records) if crc is None else crc) +
                  text(compression) + struct.pack("<Q", len(stored)) + stored)


SCHEMA = record(3, struct.pack("<H", 1) + text(b"sonard.log.ScanLine") + text(b"protobuf") + text(b"\1\2\3"))
CHANNEL = record(4, struct.pack("<HH", 1, 1) + text(b"/bow/line") + text(b"protobuf") + text(b""))


def mcap_end(size):
    """The summary and the footer after `size` bytes."""
    data_end = record(15, bytes(4))
    summary = SCHEMA + CHANNEL + record(11, bytes(42) + text(b""))
    footer = struct.pack("<BQQQ", 2, 20, size + len(data_end), 0)
    return data_end + summary + footer + struct.pack("<I", zlib.crc32(summary + footer)) + MAGIC


def mcap_log(pack=None, count=PINGS):
    """A log as sonard writes it (docs/logs.md 2): chunks, message indexes, schema and channel, a summary.

    pack: compresses a chunk by Zstandard
    """
    parts = [MAGIC, record(1, text(b"") + text(b"sonard 0.1.0"))]
    for first in range(0, count, PINGS_IN_CHUNK):
        messages = b"".join(message(number) for number in range(first, first + PINGS_IN_CHUNK))
        records = messages if first else SCHEMA + CHANNEL + messages
        parts += [chunk(records, compression=b"zstd", stored=pack(records)) if pack else chunk(records),
                  record(7, struct.pack("<HI", 1, 16 * PINGS_IN_CHUNK) + bytes(16 * PINGS_IN_CHUNK))]
        parts += [] if first else [SCHEMA, CHANNEL]
    parts.append(mcap_end(sum(map(len, parts))))
    return b"".join(parts)


def open_mcap_log(stated):
    """A log without an end. Its only chunk is open: it has no CRC, and its length covers the first `stated` messages."""
    records = [SCHEMA + CHANNEL] + [message(number) for number in range(PINGS)]
    return MAGIC + record(1, text(b"") + text(b"sonard 0.1.0")) + chunk(b"".join(records[:1 + stated]), crc=0) + b"".join(
        records[1 + stated:])


def archive_of(content, packed):
    """An archive with a .dat: its content, and its deflated form."""
    entry = struct.pack("<HHHHHIIIHH", 20, 0, 8, 0, 33, zlib.crc32(content), len(packed), len(content), 8, 0)
    local = b"PK\x03\x04" + entry + b"data.dat" + packed
    central = b"PK\x01\x02" + struct.pack("<H", 20) + entry + struct.pack("<HHHII", 0, 0, 0, 0, 0) + b"data.dat"
    return local + central + b"PK\x05\x06" + struct.pack("<HHHHIIH", 0, 0, 1, 1, len(central), len(local), 0)


def sonard_archive(content, block_size):
    """An archive as sonard writes it (protocol/glf/README.md 1.2), but without a .cfg: stored blocks, then an empty one."""
    blocks = b"".join(struct.pack("<BHH", 0, len(block), len(block) ^ 0xFFFF) + block
                      for block in (content[at: at + block_size] for at in range(0, len(content), block_size)))
    return archive_of(content, blocks + b"\x01\0\0\xff\xff")


def images_of(count):
    return [glf_writer.Image(1000.0 + number, samples_of(number), lines=4, beams=3) for number in range(count)]


class DamagedLogs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sonard-logs-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def glf(self, images, compression=zipfile.ZIP_DEFLATED):
        """An archive as glf_writer writes it, or with its entries stored."""
        path = os.path.join(self.folder, "whole.glf")
        glf_writer.write_glf(path, images)
        if compression == zipfile.ZIP_STORED:
            with zipfile.ZipFile(path) as source:
                entries = {name: source.read(name) for name in source.namelist()}
            with zipfile.ZipFile(path, "w", compression) as archive:
                for name, content in entries.items():
                    archive.writestr(name, content)
        with open(path, "rb") as file:
            return file.read()

    def read(self, suffix, content):
        """Returns the samples of the pings, and the warnings."""
        path = os.path.join(self.folder, "log" + suffix)
        with open(path, "wb") as file:
            file.write(content)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            pings = [ping.samples.tobytes() for ping in read_log(path)]
        return pings, [str(one.message) for one in caught if issubclass(one.category, DamagedLog)]

    def expect_at_most(self, most_lost, suffix, whole, written, step=1):
        """Flips every `step`-th bit."""
        self.assertEqual(self.read(suffix, whole), (written, []))
        for number in range(0, 8 * len(whole), step):
            at, bit = divmod(number, 8)
            damaged = bytearray(whole)
            damaged[at] ^= 1 << bit
            pings, told = self.read(suffix, bytes(damaged))
            place = f"bit {bit} of byte {at}: {told}"
            lost = len(set(written).difference(pings))
            self.assertLessEqual(lost, most_lost, place)
            if len(pings) < len(written):
                self.assertTrue(any("is lost" in one or "are lost" in one for one in told), place)
            elif not lost:
                self.assertFalse(any(one.endswith(("pings are lost", "ping is lost", "image is lost")) and
                                     not one.endswith("no ping is lost") for one in told), place)

    def test_a_flipped_bit_in_an_mcap_costs_its_chunk(self):
        self.expect_at_most(PINGS_IN_CHUNK, ".mcap", mcap_log(), [samples_of(number) for number in range(PINGS)])

    def test_a_damaged_start_of_an_mcap_is_told_and_costs_no_ping(self):
        whole = mcap_log()
        first_chunk = len(MAGIC) + len(record(1, text(b"") + text(b"sonard 0.1.0")))
        for content, size in ((b"\x89MCAP1\r\n" + whole[8:], 8), (bytes(8) + whole[8:], 8), (bytes(20) + whole[20:], first_chunk),
                              (whole[5:], first_chunk - 5), (b"abc" + whole, 3 + first_chunk), (whole[first_chunk - 2:], 2)):
            for suffix in (".mcap", ".mcap.damaged", ".mcap.damaged-2"):
                pings, told = self.read(suffix, content)
                self.assertEqual(pings, [samples_of(number) for number in range(PINGS)], size)
                self.assertRegex(told[0], rf"damaged: the first {size} bytes cannot be read \(the magic\); no ping is lost$")

    def test_a_text_with_the_name_of_an_mcap_is_refused(self):
        with self.assertRaisesRegex(ValueError, "log.mcap is not an .mcap log, or none of its pings can be read"):
            self.read(".mcap", b"this is the text of somebody, not a log\n" * 100)

    def test_a_byte_too_many_in_a_long_mcap_costs_the_chunk_there(self):
        # The length of an index of two messages, read one byte too early, is 9735: many chunks of this log.
        whole = mcap_log(count=120)
        self.assertGreater(len(whole), 12000)
        written = [samples_of(number) for number in range(120)]
        begin, end = (whole.index(samples_of(number)) for number in (6, 8))
        for filler in (0x00, 0x05, 0x07, 0x09, 0x55, 0xFF):
            for at in range(begin, end):
                pings, told = self.read(".mcap", whole[:at] + bytes([filler]) + whole[at:])
                place = f"{filler} at {at}: {told}"
                self.assertLessEqual(len(set(written).difference(pings)), PINGS_IN_CHUNK, place)
                if len(pings) < len(written):
                    self.assertRegex(" ".join(told), "are lost|may be lost", place)

    def test_a_flipped_bit_in_a_dat_costs_its_record(self):
        images = images_of(4)
        self.expect_at_most(1, ".dat", glf_writer.dat(images), [image.pixels for image in images])

    def test_an_image_of_another_type_is_told_in_a_dat_and_in_a_glf(self):
        images = images_of(4)
        size = len(glf_writer.image_record(images[0]))
        told = rf"{size} bytes at byte {size} cannot be read \(an image of type 2\); the image is lost"
        for suffix, content in ((".dat", glf_writer.dat(images)), (".glf", self.glf(images))):
            at = content.index(glf_writer.image_record(images[1])) + 14
            pings, warned = self.read(suffix, content[:at] + b"\x02" + content[at + 1:])
            self.assertEqual(pings, [image.pixels for image in images if image is not images[1]])
            self.assertRegex(warned[0], told)

    def test_a_flipped_bit_in_a_glf_costs_one_record(self):
        images = images_of(3)
        for compression, step in ((zipfile.ZIP_DEFLATED, 3), (zipfile.ZIP_STORED, 7)):
            with self.subTest(compression=compression):
                self.expect_at_most(1, ".glf", self.glf(images, compression), [image.pixels for image in images], step)

    def test_a_wrong_local_header_costs_no_ping_of_a_glf(self):
        images = images_of(4)
        whole = self.glf(images)
        at = whole.index(b"data.dat") - 30
        for offset, form in ((8, "<H"), (14, "<I"), (18, "<I"), (22, "<I"), (26, "<H"), (28, "<H")):
            with self.subTest(offset=offset):
                damaged = bytearray(whole)
                struct.pack_into(form, damaged, at + offset, struct.unpack_from(form, whole, at + offset)[0] ^ 64)
                pings, told = self.read(".glf", bytes(damaged))
                self.assertEqual(pings, [image.pixels for image in images])
                if offset >= 26:
                    self.assertRegex(told[0], "content of data.dat cannot be read in its archive, which was searched for pings$")
                else:
                    self.assertEqual(told, [])  # the directory has the right values

    def test_inserted_and_missing_bytes_of_a_glf_cost_their_records(self):
        images = glf_writer.noise(count=10, lines=100)
        for block_size in (65531, 16383):
            whole = sonard_archive(glf_writer.dat(images), block_size)
            self.assertEqual(self.read(".glf", whole), ([image.pixels for image in images], []))
            begin = whole.index(b"*\x02")
            size = whole.index(b"PK\x01\x02") - 5 - begin
            for number in range(40):
                at = begin + 30 + number * (size - 600) // 40
                for damaged in (whole[:at] + bytes(range(256)) * 2 + whole[at:], whole[:at] + whole[at + 512:]):
                    pings, told = self.read(".glf", damaged)
                    self.assertGreaterEqual(len({image.pixels for image in images}.intersection(pings)), 8, (at, told))
                    unread = sum(int(size) for one in told for size in re.findall(r"(\d+) bytes", one))
                    self.assertGreater(unread, 25600, told)

    def test_a_damaged_entry_beside_the_dat_is_told(self):
        images = images_of(2)
        whole = self.glf(images)
        at = whole.index(b"log.cfg") + len("log.cfg")
        for offset in (0, 20):  # the front of its only block, and its content
            pings, told = self.read(".glf", whole[:at + offset] + bytes([whole[at + offset] ^ 1]) + whole[at + offset + 1:])
            self.assertEqual(pings, [image.pixels for image in images])
            self.assertRegex(told[0], "content of log.cfg cannot be read in its archive, which was searched for pings$")

    def test_a_glf_without_its_end_and_with_a_wrong_local_header_is_searched(self):
        images = images_of(4)
        whole = self.glf(images)
        at = whole.index(b"data.dat") - 30
        cut = whole[:whole.index(b"PK\x01\x02")]
        for offset in range(30):
            pings, told = self.read(".glf", cut[:at + offset] + bytes([cut[at + offset] ^ 4]) + cut[at + offset + 1:])
            self.assertEqual(pings, [image.pixels for image in images], offset)
            self.assertTrue(told[0].endswith("the end of the archive is missing"), told)

    def test_a_cut_dat_is_told(self):
        images = images_of(3)
        ends = [len(glf_writer.dat(images[:count])) - 2 for count in range(4)]
        whole = glf_writer.dat(images)
        for size in range(2, len(whole)):
            pings, told = self.read(".dat", whole[:size])
            count = sum(end <= size for end in ends) - 1
            self.assertEqual(pings, [image.pixels for image in images[:count]], size)
            left = size - ends[count]
            self.assertRegex(told[0], f"; the last {left} bytes are an incomplete record$" if left else "ended early$")
            self.assertEqual(len(told), 1)

    def test_a_cut_glf_is_told(self):
        images = images_of(3)
        for compression in (zipfile.ZIP_DEFLATED, zipfile.ZIP_STORED):
            whole = self.glf(images, compression)
            begin = whole.index(b"*\x02")
            ends = [begin + len(glf_writer.dat(images[:count])) - 2 for count in range(4)]
            for size in range(begin + 2, len(whole)):
                pings, told = self.read(".glf", whole[:size])
                count = sum(end <= size for end in ends) - 1
                self.assertEqual(pings, [image.pixels for image in images[:count]], size)
                self.assertTrue(told[0].endswith("the end of the archive is missing"), told)
                if count < 3 and size > ends[count]:
                    self.assertTrue(told[1].endswith(f"the last {size - ends[count]} bytes of its .dat are an incomplete record"))

    def test_a_cut_mcap_is_told(self):
        whole = mcap_log()
        chunks = [index for index in range(len(whole)) if whole.startswith(b"\x06", index) and
                  whole.startswith(struct.pack("<QQ", 0, 9), index + 9)]
        self.assertEqual(len(chunks), PINGS // PINGS_IN_CHUNK)
        ends = [at + 9 + struct.unpack_from("<Q", whole, at + 1)[0] for at in chunks]
        data_end = whole.index(record(15, bytes(4)))
        for size in range(len(MAGIC), len(whole)):
            pings, told = self.read(".mcap", whole[:size])
            count = PINGS_IN_CHUNK * sum(end <= size for end in ends)
            self.assertEqual(pings, [samples_of(number) for number in range(count)], size)
            self.assertEqual(len(told), 1, (size, told))
            self.assertIn("is not closed: cut" if size < data_end + 13 else "the index at its end cannot be read", told[0])
        _, told = self.read(".mcap", whole[:ends[1] - 5])
        self.assertTrue(told[0].endswith(f"; the last {ends[1] - 5 - chunks[1]} bytes are an incomplete record"), told)

    def test_an_open_chunk_is_read_to_its_last_whole_record(self):
        for stated in range(PINGS + 1):
            whole = open_mcap_log(stated)
            for missing in (0, 1, len(message(0)) - 1, len(message(0))):
                pings, told = self.read(".mcap", whole[:len(whole) - missing])
                count = PINGS if missing == 0 else PINGS - 1
                self.assertEqual(pings, [samples_of(number) for number in range(count)], (stated, missing))
                tail = (len(message(0)) - missing) % len(message(0))
                self.assertRegex(told[0], f"; the last {tail} bytes are an incomplete record$" if tail else "ended early$")

    def test_a_wrong_record_in_an_open_chunk_is_told(self):
        whole = open_mcap_log(PINGS)
        at = whole.index(samples_of(3)) - len(message(0)) + len(scan_line(0)) - scan_line(3).index(samples_of(3))
        pings, told = self.read(".mcap", whole[:at] + b"\x55" + whole[at + 1:])
        self.assertEqual(pings, [samples_of(number) for number in range(3)])
        self.assertIn(f"{3 * len(message(0))} bytes at byte {at} cannot be read", told[0])

    def test_a_wrong_size_of_a_chunk_costs_the_chunk(self):
        whole = mcap_log()
        at = whole.index(struct.pack("<QQ", 0, 9)) + 16
        for bit in (0, 13, 63):
            damaged = bytearray(whole)
            damaged[at + bit // 8] ^= 1 << bit % 8
            pings, told = self.read(".mcap", bytes(damaged))
            self.assertEqual(pings, [samples_of(number) for number in range(PINGS_IN_CHUNK, PINGS)])
            self.assertRegex(told[0], r"\(the size of a chunk\); 2 pings are lost$")

    @unittest.skipIf(zstandard is None, "needs zstandard")
    def test_a_flipped_bit_in_a_compressed_mcap_costs_its_chunk(self):
        self.expect_at_most(PINGS_IN_CHUNK, ".mcap", mcap_log(lambda records: zstandard.ZstdCompressor().compress(records)),
                            [samples_of(number) for number in range(PINGS)], step=7)

    def test_messages_without_a_channel_are_told(self):
        whole = MAGIC + record(1, text(b"") + text(b"x")) + chunk(SCHEMA + CHANNEL + message(0) + message(1, channel=2))
        pings, told = self.read(".mcap", whole + mcap_end(len(whole)))
        self.assertEqual(pings, [samples_of(0)])
        self.assertRegex(told[0], "1 messages belong to no channel and are left out$")

    def test_impossible_values_are_told_in_an_mcap(self):
        for wrong in (struct.pack("<Bd", 0x41, -1.0), struct.pack("<Bd", 0x49, float("nan")), b"\x32\0", b"\x37",
                      b"\x0a\1\xff", b"\x0a\5x", b"\x10" + b"\xff" * 11, b"\x62\1\7", b"\x20" + b"\xff" * 8 + b"\x7f"):
            line = record(5, struct.pack("<HIQQ", 1, 0, 0, 0) + scan_line(0) + wrong)
            whole = MAGIC + record(1, text(b"") + text(b"x")) + chunk(SCHEMA + CHANNEL + line + message(1))
            pings, told = self.read(".mcap", whole + mcap_end(len(whole)))
            self.assertEqual(pings, [samples_of(1)], wrong)
            self.assertRegex(told[0], r"a sonard.log.ScanLine cannot be decoded \(.*\); it is lost$")

    def test_a_field_of_another_type_is_no_value(self):
        line = record(5, struct.pack("<HIQQ", 1, 0, 0, 0) + scan_line(0) + b"\x30\5" + b"\x21" + bytes(8) + b"\x35" + bytes(4))
        whole = MAGIC + record(1, text(b"") + text(b"x")) + chunk(SCHEMA + CHANNEL + line)
        self.assertEqual(self.read(".mcap", whole + mcap_end(len(whole))), ([samples_of(0)], []))

    def test_a_compressed_glf_is_read_up_to_the_damage(self):
        images = images_of(60)
        content = glf_writer.dat(images)
        size = len(glf_writer.dat(images[:20])) - 2
        for begin, count in ((content[:size], 20), (b"", 0)):
            packer = zlib.compressobj(wbits=-zlib.MAX_WBITS)
            packed = packer.compress(begin) + packer.flush(zlib.Z_SYNC_FLUSH) + b"\x07" * 40  # no block begins so
            pings, told = self.read(".glf", archive_of(content, packed))
            self.assertEqual(pings, [image.pixels for image in images[:count]])
            self.assertIn("the content of data.dat cannot be read", told[0])

    def test_impossible_values_are_told_in_a_dat(self):
        for wrong in ({"sound_speed_mps": 0.0}, {"sound_speed_mps": float("inf")}, {"modulation_frequency_hz": 0},
                      {"time_s": float("nan")}, {"time_s": 5e9}):
            images = [glf_writer.dataclasses.replace(images_of(1)[0], **wrong), images_of(2)[1]]
            pings, told = self.read(".dat", glf_writer.dat(images))
            self.assertEqual(pings, [images[1].pixels], wrong)
            self.assertRegex(told[0], "the image is lost$")

    def test_an_archive_without_a_dat_is_no_log(self):
        path = os.path.join(self.folder, "other.glf")
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("a.txt", "text")
        with self.assertRaisesRegex(ValueError, "other.glf has no .dat log"):
            next(read_log(path))

    def test_the_time_is_that_of_transmission(self):
        path = os.path.join(self.folder, "log.dat")
        image = glf_writer.image_record(images_of(1)[0])
        with open(path, "wb") as file:
            file.write(image[:6] + struct.pack("<d", 1e300) + image[14:] + glf_writer.END)
        self.assertEqual([ping.time_ns for ping in read_log(path)],
                         [(glf_writer.SECONDS_1970_TO_1980 + 1000) * 10**9])

    def test_a_closed_dat_may_have_no_records(self):
        self.assertEqual(self.read(".dat", glf_writer.END), ([], []))

    def test_lost_pings_of_an_mcap_are_counted(self):
        whole = mcap_log()
        at = whole.index(samples_of(PINGS_IN_CHUNK))
        pings, told = self.read(".mcap", whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])
        self.assertEqual(len(pings), PINGS - PINGS_IN_CHUNK)
        self.assertRegex(told[0], r"the checksum of a chunk\); 2 pings are lost$")


if __name__ == "__main__":
    unittest.main()
