#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests sonard_client.read_log() on logs with one wrong bit, for each bit, against the samples written.

    damaged_logs_test.py [DamagedLogs.test_name ...]
"""

import os
import struct
import sys
import tempfile
import unittest
import warnings
import zlib

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "clients", "python"), os.path.join(SOURCE, "tests", "support")]

import glf_writer  # noqa: E402
from sonard_client import DamagedLog, read_log  # noqa: E402

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
    """A ScanLine: head, time and bins."""
    return b"\x0a\x03bow\x20" + bytes([number + 1]) + b"\x32" + bytes([len(samples_of(number))]) + samples_of(number)


def message(number):
    return record(5, struct.pack("<HIQQ", 1, number, number, number) + scan_line(number))


def chunk(records):
    return record(6, struct.pack("<QQQI", 0, 9, len(records), zlib.crc32(records)) + text(b"") +
                  struct.pack("<Q", len(records)) + records)


def mcap_log():
    """A log as sonard writes it (docs/logs.md 2): chunks, message indexes, schema and channel, a summary."""
    schema = record(3, struct.pack("<H", 1) + text(b"sonard.log.ScanLine") + text(b"protobuf") + text(b"\1\2\3"))
    channel = record(4, struct.pack("<HH", 1, 1) + text(b"/bow/line") + text(b"protobuf") + text(b""))
    parts = [MAGIC, record(1, text(b"") + text(b"sonard 0.1.0"))]
    for first in range(0, PINGS, PINGS_IN_CHUNK):
        messages = b"".join(message(number) for number in range(first, first + PINGS_IN_CHUNK))
        parts += [chunk(messages if first else schema + channel + messages),
                  record(7, struct.pack("<HI", 1, 16 * PINGS_IN_CHUNK) + bytes(16 * PINGS_IN_CHUNK))]
        parts += [] if first else [schema, channel]
    parts += [record(15, bytes(4)), schema, channel, record(11, bytes(42) + text(b"")), record(2, bytes(20)), MAGIC]
    return b"".join(parts)


class DamagedLogs(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sonard-logs-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def read(self, suffix, content):
        """Returns the samples of the pings, and the warnings."""
        path = os.path.join(self.folder, "log" + suffix)
        with open(path, "wb") as file:
            file.write(content)
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            pings = [ping.samples.tobytes() for ping in read_log(path)]
        return pings, [str(one.message) for one in caught if issubclass(one.category, DamagedLog)]

    def expect_at_most(self, most_lost, suffix, whole, written):
        self.assertEqual(self.read(suffix, whole), (written, []))
        for at in range(len(whole)):
            for bit in range(8):
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

    def test_a_flipped_bit_in_a_dat_costs_its_record(self):
        images = [glf_writer.Image(1000.0 + number, samples_of(number), lines=4, beams=3) for number in range(4)]
        self.expect_at_most(1, ".dat", glf_writer.dat(images), [image.pixels for image in images])

    def test_an_image_of_another_type_is_told_in_a_dat_and_in_a_glf(self):
        images = [glf_writer.Image(1000.0 + number, samples_of(number), lines=4, beams=3) for number in range(4)]
        size = len(glf_writer.image_record(images[0]))
        told = rf"{size} bytes at byte {size} cannot be read \(an image of type 2\); the image is lost"
        path = os.path.join(self.folder, "whole.glf")
        glf_writer.write_glf(path, images)
        with open(path, "rb") as file:
            archive = file.read()
        for suffix, content in ((".dat", glf_writer.dat(images)), (".glf", archive)):
            at = content.index(glf_writer.image_record(images[1])) + 14
            pings, warned = self.read(suffix, content[:at] + b"\x02" + content[at + 1:])
            self.assertEqual(pings, [image.pixels for image in images if image is not images[1]])
            self.assertRegex(warned[0], told)

    def test_lost_pings_of_an_mcap_are_counted(self):
        whole = mcap_log()
        at = whole.index(samples_of(PINGS_IN_CHUNK))
        pings, told = self.read(".mcap", whole[:at] + bytes([whole[at] ^ 1]) + whole[at + 1:])
        self.assertEqual(len(pings), PINGS - PINGS_IN_CHUNK)
        self.assertRegex(told[0], r"the checksum of a chunk\); 2 pings are lost$")


if __name__ == "__main__":
    unittest.main()
