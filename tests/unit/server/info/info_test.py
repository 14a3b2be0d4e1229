#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests `sonard info` on whole, cut and broken logs that the test writes.

    info_test.py --sonard PROGRAM
"""

import argparse
import json
import os
import struct
import subprocess
import sys
import tempfile
import unittest

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..", "support"))
import glf_writer

SONARD = None


class Info(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sonard-info-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        # From 2026-11-20 14:22:33.250 on the log's clock. Two sonars send in turn; one image is late, one has
        # other settings.
        self.bow = glf_writer.noise(10, 100, device_id=600, interval_s=0.5)
        self.bow[6].gain_percent = 80
        for image in self.bow[7:]:
            image.time_s += 2.0
        self.stern = glf_writer.noise(4, 50, device_id=601, interval_s=0.25, modulation_frequency_hz=45211,
                                      sound_speed_mps=1480.5)
        self.images = sorted(self.bow + self.stern, key=lambda image: image.time_s)
        self.statuses = [glf_writer.status_record(image.time_s) for image in self.bow[:3]]

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name):
        (glf_writer.write_dat if name.endswith(".dat") else glf_writer.write_glf)(self.path(name), self.images,
                                                                                  self.statuses)
        return self.path(name)

    def run_info(self, *arguments, code=0, zone="UTC"):
        done = subprocess.run([SONARD, "info", *arguments], capture_output=True, text=True, timeout=60,
                              env={**os.environ, "TZ": zone})
        self.assertEqual(done.returncode, code, done.stderr)
        return done

    def json(self, *arguments, **options):
        return json.loads(self.run_info("--json", *arguments, **options).stdout)

    def test_everything_that_was_written(self):
        for name in ("log.glf", "log.dat"):
            with self.subTest(name):
                path = self.write(name)
                seen = self.json(path)
                self.assertEqual((seen["file"], seen["kind"], seen["closed"], seen["problems"]),
                                 (path, name[-3:], True, []))
                self.assertEqual(seen["bytes"], os.path.getsize(path))
                self.assertEqual(seen["other_records"], {"statuses": 3})
                bow, stern = seen["heads"]
                self.assertEqual((bow["type"], bow["scanning"], bow["id"], bow["pings"]),
                                 ("gemini_720i", False, 600, 10))
                self.assertEqual((stern["id"], stern["pings"]), (601, 4))
                self.assertAlmostEqual(bow["median_interval_s"], 0.5, places=5)
                self.assertAlmostEqual(bow["rate_hz"], 2.0, places=4)
                self.assertEqual(bow["gaps"], 1)
                self.assertAlmostEqual(bow["longest_gap_s"], 2.5, places=5)
                self.assertEqual((stern["gaps"], stern["longest_gap_s"]), (0, 0))
                self.assertEqual([(s["pings"], s["bins"], s["beams"], s["gain_percent"]) for s in bow["settings"]],
                                 [(9, 100, 256, 50), (1, 100, 256, 80)])
                # 50 lines of 1480.5 / 2 / 45211 m each.
                self.assertAlmostEqual(stern["settings"][0]["range_m"], 50 * 1480.5 / 2 / 45211, places=6)
                self.assertEqual(stern["settings"][0]["sound_speed_mps"], 1480.5)

    def test_times_as_written_and_in_utc(self):
        path = self.write("log.glf")
        span = self.json(path, zone="UTC")["span"]
        self.assertEqual((span["first_as_written"], span["first_utc"]),
                         ("2026-11-20T14:22:33.250", "2026-11-20T14:22:33.250Z"))
        self.assertEqual(span["last_as_written"], "2026-11-20T14:22:39.750")
        self.assertAlmostEqual(span["seconds"], 6.5, places=5)
        # Two hours east of Greenwich, so the clock shows a later time than UTC.
        for options in ({"zone": "EET-2"}, {"zone": "UTC", "hours": "2"}):
            offset = ["--utc-offset", options.pop("hours")] if "hours" in options else []
            span = self.json(path, *offset, **options)["span"]
            self.assertEqual((span["first_as_written"], span["first_utc"], span["utc_offset_s"]),
                             ("2026-11-20T14:22:33.250", "2026-11-20T12:22:33.250Z", 7200))

    def test_text_for_people(self):
        text = self.run_info(self.write("log.glf")).stdout
        for part in ("closed", "Gemini 720i 600: 10 pings", "Gemini 720i 601: 4 pings", "9x 100 range bins of 256 beams",
                     "gain 80 %", "1 gaps of more than twice that, the longest 2.500 s", "3 statuses",
                     "2026-11-20T14:22:33.250 to 2026-11-20T14:22:39.750 as written"):
            self.assertIn(part, text)

    def test_a_cut_log_is_described_as_far_as_it_goes(self):
        for name in ("log.glf", "log.dat"):
            path = self.write(name)
            whole = os.path.getsize(path)
            last = 14
            for size in (whole - 1000, whole // 2, whole // 4, 60_000):
                os.truncate(path, size)
                done = self.run_info(path, "--json")
                seen = json.loads(done.stdout)
                pings = sum(head["pings"] for head in seen["heads"])
                self.assertFalse(seen["closed"])
                self.assertIn(f"warning: {path}: cut", done.stderr)
                self.assertLessEqual(pings, last)
                self.assertGreaterEqual(pings, size // 30_000 - 2, f"{name} cut to {size}")
                last = pings

    def test_broken_files_are_told_in_one_line(self):
        text = self.path("text.glf")
        with open(text, "w", encoding="utf-8") as file:
            file.write("no log at all")
        other = self.path("other.pcapng")
        with open(other, "wb") as file:
            file.write(bytes.fromhex("0a0d0d0a") + bytes(20))
        for path, message in ((text, "is not a log"), (other, "none of its blocks can be read (bad_"), (self.folder, "is not a file"),
                              (self.path("none.dat"), "cannot be opened: No such file")):
            done = self.run_info(path, code=2)
            self.assertEqual(done.stdout, "")
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
            self.assertTrue(done.stderr.startswith(path + ": "), done.stderr)
            self.assertIn(message, done.stderr)

    def test_pictures(self):
        folder = self.path("pictures")
        self.run_info(self.write("log.glf"), "--png", folder, "--every", "4")
        self.assertEqual(sorted(os.listdir(folder)),
                         ["600_000000.png", "600_000004.png", "600_000008.png", "601_000000.png"])
        for name in os.listdir(folder):
            with open(os.path.join(folder, name), "rb") as file:
                header = file.read(24)
            self.assertEqual(header[:8], b"\x89PNG\r\n\x1a\n")
            width, height = struct.unpack(">II", header[16:])
            self.assertGreater(min(width, height), 200)


def main():
    global SONARD
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sonard", required=True)
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    SONARD = os.path.abspath(arguments.sonard)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests])


if __name__ == "__main__":
    main()
