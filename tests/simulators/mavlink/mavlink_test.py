#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon's image follows poses from node-mavlink: the test compares ranges of walls whose places are known.

    mavlink_test.py --programs DIR --publisher DIR [TestCase.test_name ...]
"""

import argparse
import os
import sys
import time
import unittest

sys.path.insert(0, os.path.abspath(os.path.join(os.path.dirname(__file__), "..")))

import walls  # noqa: E402
from walls import AHEAD, link_test  # noqa: E402
from lab import need  # noqa: E402

PORT = "14660"
PUBLISHER = None  # folder with publish.js and node_modules


class Mavlink(walls.WallTest):
    """Every vehicle here starts its own clock, so each change of publisher is also a reboot."""

    def setUp(self):
        super().setUp()
        need("node")
        self.start_walls(f"  mavlink:\n    bind: 127.0.0.1:{PORT}")

    def publish(self, kind, version, *numbers):
        """Publishes until the test or the caller ends it."""
        return self.lab.start(self.lab.head, "node", os.path.join(PUBLISHER, "publish.js"), PORT, str(version), kind,
                              *(str(number) for number in numbers))

    def reboot(self, vehicle):
        """The daemon takes a clock that goes back by less than 250 ms for a late message, not for a reboot."""
        time.sleep(1)
        vehicle.kill()

    def follow(self, kind, version):
        # Heading north from 1.5 m north of the origin: the north wall. If axes were swapped, it would be 4 or 5.5 m.
        vehicle = self.publish(kind, version, 1.5, -1, 1, 0, 0, 0)
        self.check_ranges({AHEAD: 2.5})
        self.reboot(vehicle)
        # Heading east, rolled, from 2.75 m east: the east wall.
        vehicle = self.publish(kind, version, 0.5, 2.75, 1, 20, 0, 90)
        self.check_ranges({AHEAD: 3.25})
        self.reboot(vehicle)
        # Nose straight down from 1 m depth: the floor.
        vehicle = self.publish(kind, version, 0, 0, 1, 0, -90, 0)
        self.check_ranges({AHEAD: 4.0})
        vehicle.kill()
        self.end_daemon(self.daemon)
        ends = link_test.key_values(self.daemon.wait_for_line(r"pose mavlink udp .*: ended ", link_test.PATIENCE_S))
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
