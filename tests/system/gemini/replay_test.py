#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`sonard replay` and a client as processes on one machine (a network namespace), with logs that are written here.

    replay_test.py --programs DIR [TestCase.test_name ...]
"""

import argparse
import os
import sys
import tempfile
import unittest

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "support"))
import glf_writer
from lab import Lab, need

PROGRAMS = None
PATIENCE_S = 60
LINES = 482  # 4 m, uncompressed


def key_values(line):
    return dict(item.split("=", 1) for item in line.split() if "=" in item)


class ReplayTest(unittest.TestCase):
    def setUp(self):
        need("ip")
        folder = tempfile.TemporaryDirectory(prefix="sonard-replay-")
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.lab = Lab()
        self.lab.__enter__()
        self.addCleanup(self.lab.__exit__)

    def log(self, count, suffix=".glf", **settings):
        """Writes a log of `self.images`. Returns its path."""
        self.images = glf_writer.noise(count, LINES, **settings)
        path = os.path.join(self.folder, "log" + suffix)
        (glf_writer.write_dat if suffix == ".dat" else glf_writer.write_glf)(path, self.images)
        return path

    def replay(self, *arguments):
        daemon = self.lab.start(self.lab.head, os.path.join(PROGRAMS, "sonard"), "replay", *arguments)
        daemon.wait_for_line("sonard ready heads=", PATIENCE_S)
        return daemon

    def view(self, count, *options):
        """Receives pings on loopback, all complete. Returns what sonarview logged of each."""
        viewer = self.lab.start(self.lab.head, os.path.join(PROGRAMS, "sonarview"), "--client-address", "127.0.0.1",
                                "--log-pings", "--quiet", "--wait", str(PATIENCE_S), "--ping-wait", str(PATIENCE_S),
                                "--pings", str(count), *options)
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        pings = [key_values(line) for line in viewer.lines if line.startswith("ping ")]
        self.assertEqual(len(pings), count)
        return pings

    def crcs(self):
        return [f"{image.crc32():08x}" for image in self.images]

    def offsets_ms(self, pings):
        return [(int(ping["transmit_us"]) - int(pings[0]["transmit_us"])) / 1000 for ping in pings]

    def check_offsets(self, pings, speed=1):
        """On time except for the delays of a busy machine; early at most by the clocks' rounding."""
        expected = [1000 * (image.time_s - self.images[0].time_s) / speed for image in self.images]
        late = sorted(offset - due for offset, due in zip(self.offsets_ms(pings), expected))
        self.assertGreater(late[0], -0.01)
        self.assertLess(late[len(late) // 4], 10)


class Timing(ReplayTest):
    def test_times_of_the_log_are_kept_and_the_end_ends_it(self):
        path = self.log(40, interval_s=0.08)
        for number, image in enumerate(self.images):  # no clock would make these
            image.time_s += 0.013 * (number % 5)
        glf_writer.write_glf(path, self.images)
        daemon = self.replay(path)
        pings = self.view(40, "--range", "4", "--continuous", "20")
        self.assertEqual([ping["crc32"] for ping in pings], self.crcs())
        self.assertEqual({ping["lines"] for ping in pings}, {str(LINES)})
        self.check_offsets(pings)
        self.assertEqual(daemon.wait(10), 0, daemon.tail())
        self.assertIn("the recording has ended", daemon.output())
        self.assertNotIn("differ", daemon.output())

    def test_twice_as_fast(self):
        daemon = self.replay(self.log(30, interval_s=0.1), "--speed", "2")
        pings = self.view(30, "--range", "4")
        self.assertEqual([ping["crc32"] for ping in pings], self.crcs())
        self.check_offsets(pings, speed=2)
        self.assertEqual(daemon.wait(10), 0, daemon.tail())

    def test_loop_starts_again(self):
        daemon = self.replay(self.log(7), "--loop")
        pings = self.view(20, "--range", "4")
        self.assertEqual([ping["crc32"] for ping in pings], (3 * self.crcs())[:20])
        code, _ = daemon.terminate(10)
        self.assertEqual(code, 0)

    def test_started_at_once_it_skips_what_nobody_wants(self):
        daemon = self.replay(self.log(20, interval_s=0.1), "--start", "now")
        self.assertEqual(daemon.wait(20), 0, daemon.tail())
        self.assertIn("20 pings of the recording were skipped", daemon.output())


class Requests(ReplayTest):
    def test_what_differs_is_answered_and_reported_once(self):
        daemon = self.replay(self.log(10))
        pings = self.view(10, "--range", "20", "--gain", "80", "--compression", "2", "--bits", "16")
        self.assertEqual([ping["crc32"] for ping in pings], self.crcs())
        self.assertEqual({ping["lines"] for ping in pings}, {str(LINES)})
        self.assertEqual(daemon.wait(10), 0, daemon.tail())
        for text in ("range 20.00 m requested, 4.00 m sent", "gain 80 % requested, 50 % sent",
                     "compression x4 requested, x1 sent", "16 bits requested, 8 bits sent"):
            self.assertEqual(daemon.output().count("differs from the recording: " + text), 1, daemon.tail())
        self.assertIn("range=10 compression=10 gain=10 16_bit=10", daemon.output())


class Logs(ReplayTest):
    def test_a_cut_log_is_played_as_far_as_it_goes(self):
        path = self.log(12, ".dat")
        os.truncate(path, os.path.getsize(path) - 5000)  # in the middle of the last image
        daemon = self.replay(path)
        pings = self.view(11, "--range", "4")
        self.assertEqual([ping["crc32"] for ping in pings], self.crcs()[:11])
        self.assertEqual(daemon.wait(10), 0, daemon.tail())
        self.assertRegex(daemon.output(), "warning .*: cut or damaged")

    def test_a_broken_image_is_told_at_the_start_and_left_out(self):
        self.images = glf_writer.noise(6, LINES)
        for image in self.images:
            image.pixels = bytes(byte & 15 for byte in image.pixels)  # so that they are packed
        path = os.path.join(self.folder, "log.glf")
        glf_writer.write_glf(path, self.images)
        with open(path, "r+b") as file:
            content = file.read()
            broken = content.index(glf_writer.image_record(self.images[3])[:60]) + 1000
            file.seek(broken)
            file.write(bytes([content[broken] ^ 1]))
        daemon = self.replay(path)
        self.assertRegex(daemon.output(), r"warning .*damaged: .* cannot be read .*; 1 ping is lost")
        pings = self.view(5, "--range", "4")
        self.assertEqual([ping["crc32"] for ping in pings], self.crcs()[:3] + self.crcs()[4:])
        self.assertEqual(daemon.wait(10), 0, daemon.tail())
        self.assertNotIn("cannot render", daemon.output())

    def refused(self, *arguments):
        """The only line that `sonard replay` prints."""
        daemon = self.lab.start(self.lab.head, os.path.join(PROGRAMS, "sonard"), "replay", *arguments)
        self.assertEqual(daemon.wait(20), 2, daemon.tail())
        self.assertEqual(len(daemon.lines), 1, daemon.tail())
        return daemon.lines[0]

    def test_what_cannot_be_played_is_told_in_one_line(self):
        text = os.path.join(self.folder, "text.glf")
        with open(text, "w", encoding="utf-8") as file:
            file.write("no log")
        self.assertEqual(self.refused(text), f"{text}: is not a log (expected a .glf, .dat, .mcap, .pcapng or .sonar)")
        missing = os.path.join(self.folder, "missing.glf")
        self.assertEqual(self.refused(missing), f"{missing}: cannot be opened: No such file or directory")
        wide = self.log(3, beams=512)
        self.assertIn("an image of 482 range bins of 512 beams, which a Gemini 720i cannot send", self.refused(wide))


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    PROGRAMS = os.path.abspath(arguments.programs)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
