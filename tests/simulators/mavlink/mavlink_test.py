#!/usr/bin/env python3
"""The image of the daemon follows what node-mavlink publishes: ranges of walls whose places are known.

    mavlink_test.py --programs DIR --publisher DIR [TestCase.test_name ...]
"""

import argparse
import os
import sys
import time
import unittest

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path.insert(0, os.path.join(SOURCE, "tests", "system", "gemini"))

import link_test  # noqa: E402
import wire  # noqa: E402
from lab import Deadline, need  # noqa: E402

WORLD = os.path.join(SOURCE, "tests", "data", "system", "two_walls.sdf")
PORT = "14660"
PUBLISHER = None  # folder with publish.js and node_modules

DAEMON = """
world:
  file: {world}
backend: ray
poses:
  mavlink:
    bind: 127.0.0.1:{port}
sampling:
  preset: grid
  views: 3
  columns_per_view: 64
  rows: 32
heads:
{head}
"""


class Mavlink(link_test.LinkTest):
    """Every vehicle here begins its clock anew, so each change of publisher is a reboot, too."""

    def setUp(self):
        super().setUp()
        need("node")
        self.lab = self.make_lab()
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(DAEMON.format(world=WORLD, port=PORT, head=self.head_config(noisy=False)))
        self.daemon = self.lab.start(self.lab.head, os.path.join(link_test.PROGRAMS, "sonard"), "run", path)
        self.daemon.wait_for_line(r"sonard ready heads=1 ", link_test.START_S)
        self.surface = link_test.RawSurface(self.lab)
        self.addCleanup(self.surface.close)

    def publish(self, kind, version, *numbers):
        """Until the test, or the caller, ends it."""
        return self.lab.start(self.lab.head, "node", os.path.join(PUBLISHER, "publish.js"), PORT, str(version), kind,
                              *(str(number) for number in numbers))

    def range_ahead(self):
        """Of the first echo in the middle beam, metres; None without one, or without a ping: there is no pose yet."""
        self.surface.send(wire.ping_config(513, lines=840, spreading=293))  # 7 m
        try:
            ping = self.surface.next_ping(seconds=2)
        except AssertionError:
            return None
        first = next((i for i in range(ping.count) if ping.lines[i][128] > 0), None)
        return None if first is None else first * wire.line_step_m(1500.0)

    def check_range(self, expected_m):
        """The first pings may still be of the pose before."""
        deadline = Deadline(link_test.PATIENCE_S)
        seen = []
        while not deadline.over():
            seen.append(self.range_ahead())
            # Two lines, and what the footprint of a sample adds.
            if len(seen) >= 3 and all(range_m and abs(range_m - expected_m) < 0.03 for range_m in seen[-3:]):
                return
        self.fail(f"expected {expected_m} m three times in a row, saw {seen[-8:]}; {self.daemon.tail()}")

    def end_vehicle(self, vehicle):
        """Its clock has run for longer by then than what counts as a late message of the same clock, 250 ms."""
        time.sleep(0.6)
        vehicle.kill()

    def follow(self, kind, version):
        # Heading north from 1.5 m north of the origin: the north wall. A mix-up of axes would give 4 or 5.5 m.
        vehicle = self.publish(kind, version, 1.5, -1, 1, 0, 0, 0)
        self.check_range(2.5)
        self.end_vehicle(vehicle)
        # Heading east, rolled, from 2.75 m east: the east wall.
        vehicle = self.publish(kind, version, 0.5, 2.75, 1, 20, 0, 90)
        self.check_range(3.25)
        self.end_vehicle(vehicle)
        # Nose straight down from 1 m depth: the floor.
        vehicle = self.publish(kind, version, 0, 0, 1, 0, -90, 0)
        self.check_range(4.0)
        vehicle.kill()
        self.end_daemon(self.daemon)
        ends = link_test.key_values(self.daemon.wait_for_line(r"mavlink udp .* ends: ", link_test.PATIENCE_S))
        self.assertGreater(int(ends["samples"]), 0)
        for never in ("malformed", "bad_value", "bad_checksums", "stray_bytes", "wrong_system", "unknown_frame"):
            self.assertEqual(ends[never], "0", ends)
        return ends

    def test_odometry_of_version_2(self):
        self.follow("odometry", 2)

    def test_position_and_angles_of_version_1(self):
        ends = self.follow("angles", 1)
        self.assertEqual(ends["clock_restarts"], "2")

    def test_position_and_quaternion_of_version_2(self):
        ends = self.follow("quaternion", 2)
        self.assertEqual(ends["clock_restarts"], "2")


def main():
    global PUBLISHER
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder with sonard")
    parser.add_argument("--publisher", required=True, help="folder with publish.js, where npm has installed its needs")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    link_test.PROGRAMS = os.path.abspath(arguments.programs)
    PUBLISHER = os.path.abspath(arguments.publisher)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
