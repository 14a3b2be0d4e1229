#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests two independent readers on the logs of two independent writers.

    readers_test.py --tool GLF_TOOL
"""

import argparse
import io
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile
import zlib

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "support"))
import glf_reader  # noqa: E402

TOOL = None
START_S = 1479651753.25  # 2026-11-20 14:22:33.25


def run_tool(*arguments):
    return subprocess.run([TOOL, *arguments], check=True, capture_output=True, text=True, timeout=60).stdout


class Written(unittest.TestCase):
    """A log of the library: twenty images of two sonars and four statuses."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        run_tool("write", cls.folder.name)
        cls.path = os.path.join(cls.folder.name, "log.glf")
        with open(os.path.join(cls.folder.name, "log.json")) as file:
            cls.meant = json.load(file)
        with open(os.path.join(cls.folder.name, "log.pixels"), "rb") as file:
            cls.pixels = file.read()
        cls.log = glf_reader.read(cls.path)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_archive_is_one_for_unzip(self):
        result = subprocess.run(["unzip", "-t", self.path], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("No errors detected", result.stdout)
        self.assertEqual(result.stderr, "")

    def test_names_and_config(self):
        with zipfile.ZipFile(self.path) as archive:
            self.assertEqual([(entry.filename, entry.date_time) for entry in archive.infolist()],
                             [("log_2026-11-20-142233.cfg", (2026, 11, 20, 14, 22, 34)),
                              ("data_2026-11-20-142233.dat", (2026, 11, 20, 14, 22, 34))])
        self.assertEqual(self.log.creation_time_s, START_S)
        self.assertEqual(self.log.close_time_s, START_S + 2.5)
        self.assertEqual(self.log.app_name, "glf_tool")
        self.assertEqual(self.log.device_info, "Gemini - 1194, Gemini - 2001")

    def test_dat_alone_is_the_same(self):
        self.assertEqual(glf_reader.read(os.path.join(self.folder.name, "log.dat")).records, self.log.records)

    def test_every_field_of_every_image(self):
        self.assertEqual(len(self.log.images), 20)
        self.assertEqual(len(self.log.records), 24)
        at = 0
        for image, meant in zip(self.log.images, [record for record in self.meant if record["type"] == 0]):
            for name in ("time_s", "device_id", "node_id"):
                self.assertEqual(getattr(image.header, name), meant[name], name)
            for name in ("lines", "beams", "state_flags", "modulation_frequency_hz", "aperture_deg", "transmit_time_s",
                         "ping_flags", "sound_speed_mps", "gain_percent", "chirp", "sonar_type", "platform"):
                self.assertEqual(getattr(image, name), meant[name], name)
            self.assertEqual(list(image.bearings_rad), meant["bearings_rad"])
            size = image.lines * image.beams
            self.assertEqual(image.pixels, self.pixels[at:at + size])
            at += size
        self.assertEqual(at, len(self.pixels))

    def test_images_are_those_of_the_recipe(self):
        """Calculated here: times, ranges, pixels (7f + 3r + 5b) mod 256 except in two noise images."""
        for number, image in enumerate(self.log.images):
            second = number % 2 == 1
            self.assertEqual(image.header.time_s, START_S + number / 8)
            self.assertEqual(image.header.device_id, 2001 if second else 1194)
            self.assertAlmostEqual(image.max_range_m, 35.0 if second else 20.0, places=3)
            self.assertEqual(image.compression, "raw" if number in (6, 7) else "zlib")
            self.assertGreater(image.bearings_rad[0], 0)
            self.assertEqual(sorted(image.bearings_rad, reverse=True), list(image.bearings_rad))
            if number not in (6, 7):
                for line in (0, 1, image.lines - 1):
                    self.assertEqual(image.row(line),
                                     bytes((7 * number + 3 * line + 5 * beam) % 256 for beam in range(image.beams)))

    def test_every_status(self):
        meant = [record for record in self.meant if record["type"] == 3]
        self.assertEqual(len(self.log.statuses), 4)
        for status, meant in zip(self.log.statuses, meant):
            self.assertEqual(status.header.time_s, meant["time_s"])
            self.assertEqual(status.header.node_id, meant["node_id"])
            self.assertEqual(status.header.device_id, meant["device_id"])
            self.assertEqual(status.temperatures_c[3], meant["transducer_c"])
            self.assertEqual(status.counts[0], meant["packet_count"])
            self.assertEqual(status.addresses[2], 0x00FFFFFF)
            for name in ("device_id", "bf_firmware_version", "fpga_time_us", "shutdown_status"):
                self.assertEqual(getattr(status, name), meant[name], name)

    def test_the_library_reads_the_same(self):
        for name in ("log.glf", "log.dat"):
            seen = json.loads(run_tool("read", os.path.join(self.folder.name, name)))
            self.assertTrue(seen["closed"])
            self.assertEqual(seen["records"], self.meant)
        for image, meant in zip(self.log.images, [record for record in self.meant if record["type"] == 0]):
            self.assertEqual(zlib.crc32(image.pixels), meant["pixels_crc"])


class Unseekable(io.RawIOBase):
    """A stream without seek(), so that zipfile writes data descriptors."""

    def __init__(self):
        self.bytes = bytearray()

    def writable(self):
        return True

    def write(self, data):
        self.bytes += data
        return len(data)


class Read(unittest.TestCase):
    """Logs made here without the library, in every container that readers are known to accept."""

    CONFIG = ("a.cfg", b"<x><logHeader><creationTime>5.5</creationTime></logHeader>"
                       b"<logTerminator><closeTime> 6.25 </closeTime></logTerminator></x>")

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.pixels = bytes((line + 2 * beam) % 251 for line in range(400) for beam in range(300))
        self.bearings = [1.0 - beam / 150 for beam in range(300)]
        data = zlib.compress(self.pixels)
        image = struct.pack("<HHHIIHIIHI", 1, 0xEFEF, 3, 0, 400, 0, 0, 300, 0, len(data)) + data + struct.pack(
            "<300d", *self.bearings) + struct.pack("<IIfdHfhBBBBH", 7, 20000, 65.0, 12.5, 0x0100, 1490.0, -3, 1, 2, 2, 0,
                                                   0xDEDE)
        raw = struct.pack("<HHHIIHIIHI", 1, 0xEFEF, 3, 0, 400, 0, 0, 300, 1, 120000) + self.pixels + image[30 + len(data):]
        status = bytearray(218)
        struct.pack_into("<H", status, 8, 77)
        struct.pack_into("<d", status, 35, 9.75)
        self.dat = b"".join(
            struct.pack("<cBIdBHHH", b"*", 2, 21 + len(body), 12.5, kind, 77, 103, 0) + body
            for kind, body in ((0, image), (3, status), (0, raw))) + b"\xde\xde"

    def read(self, data):
        path = os.path.join(self.folder.name, "log")
        with open(path, "wb") as file:
            file.write(data)
        return json.loads(run_tool("read", path))

    def check(self, data, closed=True):
        log = self.read(data)
        self.assertEqual(log["closed"], closed)
        first, status, second = log["records"]
        for image in (first, second):
            self.assertEqual(image, {
                "type": 0, "time_s": 12.5, "device_id": 77, "node_id": 103, "lines": 400, "beams": 300, "state_flags": 7,
                "modulation_frequency_hz": 20000, "aperture_deg": 65, "transmit_time_s": 12.5, "ping_flags": 256,
                "sound_speed_mps": 1490, "gain_percent": -3, "chirp": True, "sonar_type": 2, "platform": 2,
                "pixels_crc": zlib.crc32(self.pixels), "bearings_rad": self.bearings})
        self.assertEqual((status["type"], status["device_id"], status["transducer_c"]), (3, 77, 9.75))

    def archive(self, entries, target=None, **options):
        target = target or io.BytesIO()
        with zipfile.ZipFile(target, "w", **options) as archive:
            for name, data in entries:
                archive.writestr(name, data)
        return bytes(target.bytes) if isinstance(target, Unseekable) else target.getvalue()

    def test_containers(self):
        both = [self.CONFIG, ("b.dat", self.dat)]
        deflated = zipfile.ZIP_DEFLATED
        self.check(self.dat)
        self.check(self.archive(both))
        self.check(self.archive(both, compression=deflated))
        self.check(self.archive(both, compression=deflated, compresslevel=0))
        self.check(self.archive(both, target=Unseekable(), compression=deflated, compresslevel=0))
        self.check(self.archive(both[::-1]))
        self.check(self.archive([("c.xml", b"<x/>"), *both]))
        self.check(self.archive(both[1:]))
        self.check(self.archive([self.CONFIG, ("b.dat", self.dat[:-2])]), closed=False)

    def test_what_is_broken_is_refused(self):
        path = os.path.join(self.folder.name, "log")
        with open(path, "wb") as file:
            file.write(self.archive([self.CONFIG]))
        result = subprocess.run([TOOL, "read", path], capture_output=True, text=True, timeout=60)
        self.assertEqual(result.returncode, 1)
        self.assertIn("bad_value: field dat_entry", result.stderr)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--tool", required=True)
    options, rest = parser.parse_known_args()
    TOOL = os.path.abspath(options.tool)
    unittest.main(argv=[sys.argv[0], *rest])
