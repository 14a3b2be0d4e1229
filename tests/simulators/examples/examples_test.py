#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Poses in the axes of other simulators, through the publishers of clients/examples and clients/ros2, to ranges in the image.

    examples_test.py --programs DIR --modules DIR [--unity FILE] [Examples.test_name ...]
"""

import argparse
import math
import os
import sys
import unittest

sys.path.insert(0, os.path.abspath(os.path.join(os.path.dirname(__file__), "..")))

import walls  # noqa: E402
from walls import AHEAD, INNER_RAD, OUTER_RAD, PORT_MOST, STARBOARD_MOST, link_test  # noqa: E402
from lab import need  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
PORT = "14600"
UNITY = None  # unity.exe

# Places of the vehicle, always at 1 m depth, and the ranges of the walls in the image.
PLACES = (
    # Heading north from 1.5 m north of the origin.
    ("north", {AHEAD: 2.5}),
    # Heading north at the origin: to port the north wall slantwise, to starboard the east wall.
    ("middle", {PORT_MOST: 4 / math.cos(INNER_RAD), STARBOARD_MOST: 6 / math.sin(OUTER_RAD)}),
    # Heading east from 2.75 m east, 0.5 m north.
    ("east", {AHEAD: 3.25}),
    # Nose straight down at the origin.
    ("down", {AHEAD: 4}),
    # Heading north at the origin, rolled by 90 degrees to starboard: the fan is vertical, starboard beams see the floor, port
    # beams look over the wall.
    ("rolled", {PORT_MOST: 0, STARBOARD_MOST: 4 / math.sin(OUTER_RAD)}),
)

# One message with a twist: the daemon extrapolates for 300 ms, over a quarter of a circle, 1.5 m long.
TURN = math.pi / 2 / 0.3
AWAY = 1.5 / (math.pi / 2)  # how far a quarter of a circle leads, along and across
TWISTS = (
    # Heading east at the origin, 5 m/s to port, turning to port: north-west of the origin and heading north.
    ("turning", {AHEAD: 4 - AWAY}),
    # Heading north at the origin, 5 m/s ahead, nose going down: deeper, and looking down.
    ("diving", {AHEAD: 4 - AWAY}),
    # Heading north at the origin, 5 m/s up, rolling to starboard: higher, and east.
    ("rolling", {STARBOARD_MOST: (4 + AWAY) / math.sin(OUTER_RAD)}),
)


class Examples(walls.WallTest):
    def follow(self, command, **states):
        """`states`: 12 numbers for each place and twist, in the simulator's axes and units."""
        self.start_walls()
        for name, expected in PLACES:
            vehicle = self.lab.start(self.lab.head, *command, PORT, "0", *map(str, states[name]), *["0"] * 6)
            with self.subTest(name):
                self.check_ranges(expected)
            vehicle.kill()
        for name, expected in TWISTS:
            once = self.lab.start(self.lab.head, *command, PORT, "1", *map(str, states[name]))
            self.assertEqual(once.wait(link_test.PATIENCE_S), 0, once.tail())
            with self.subTest(name):
                self.check_ranges(expected)
        if "body" in states:  # in front of the north wall again, with all walls 0.75 m further north
            numbers = [*states["north"], *[0] * 6, *states["body"]]
            vehicle = self.lab.start(self.lab.head, *command, PORT, "0", *map(str, numbers))
            with self.subTest("body"):
                self.check_ranges({AHEAD: 3.25})
            vehicle.kill()
        if "moving_body" in states:  # one message; the daemon moves the walls by 0.75 m within 300 ms, from 1 m further south
            numbers = [*states["north"], *[0] * 6, *states["moving_body"]]
            once = self.lab.start(self.lab.head, *command, PORT, "1", *map(str, numbers))
            self.assertEqual(once.wait(link_test.PATIENCE_S), 0, once.tail())
            with self.subTest("moving body"):
                self.check_ranges({AHEAD: 2.25})
        self.end_daemon(self.daemon)
        self.assertNotIn("is refused", self.daemon.output())

    def program(self, name):
        return [os.path.join(link_test.PROGRAMS, name)]

    def python(self, simulator):
        return [sys.executable, "-B", os.path.join(HERE, "python_simulators.py"), simulator]

    def test_ros2(self):
        """East, north, up; roll, pitch, yaw; velocities in the vehicle's axes."""
        self.follow(self.python("ros2"), north=(0, 1.5, -1, 0, 0, 90), middle=(0, 0, -1, 0, 0, 90),
                    east=(2.75, 0.5, -1, 0, 0, 0), down=(0, 0, -1, 0, 90, 90), rolled=(0, 0, -1, 90, 0, 90),
                    turning=(0, 0, -1, 0, 0, 0, 0, 5, 0, 0, 0, TURN), diving=(0, 0, -1, 0, 0, 90, 5, 0, 0, 0, TURN, 0),
                    rolling=(0, 0, -1, 0, 0, 90, 0, 0, 5, TURN, 0, 0))

    def test_holoocean(self):
        """East, north, up; roll, pitch, yaw; velocities in the world's axes."""
        self.follow(self.python("holoocean"), north=(0, 1.5, -1, 0, 0, 90), middle=(0, 0, -1, 0, 0, 90),
                    east=(2.75, 0.5, -1, 0, 0, 0), down=(0, 0, -1, 0, 90, 90), rolled=(0, 0, -1, 90, 0, 90),
                    turning=(0, 0, -1, 0, 0, 0, 0, 5, 0, 0, 0, TURN), diving=(0, 0, -1, 0, 0, 90, 0, 5, 0, 0, TURN, 0),
                    rolling=(0, 0, -1, 0, 0, 90, 0, 0, 5, TURN, 0, 0))

    def test_holoocean_rotations(self):
        """Half turns and nearly half turns, which are not among the places above, and rotations without symmetry."""
        from holoocean_pose import quaternion
        for q in ((0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1), (0.1, 0.9, -0.3, 0.2), (0.1, -0.2, 0.9, 0.3), (-0.1, 0.3, 0.2, 0.9),
                  (0.8, -0.1, 0.3, -0.2)):
            w, x, y, z = (part / math.hypot(*q) for part in q)
            found = quaternion([[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 0],
                                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 0],
                                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), 0]])
            self.assertAlmostEqual(abs(sum(a * b for a, b in zip(found, (w, x, y, z)))), 1, places=12, msg=q)

    def test_stonefish(self):
        """North, east, down; roll, pitch, yaw; velocities in the vehicle's axes."""
        self.follow(self.program("stonefish_example"), north=(1.5, 0, 1, 0, 0, 0), middle=(0, 0, 1, 0, 0, 0),
                    east=(0.5, 2.75, 1, 0, 0, 90), down=(0, 0, 1, 0, -90, 0), rolled=(0, 0, 1, 90, 0, 0),
                    turning=(0, 0, 1, 0, 0, 90, 0, -5, 0, 0, 0, -TURN), diving=(0, 0, 1, 0, 0, 0, 5, 0, 0, 0, -TURN, 0),
                    rolling=(0, 0, 1, 0, 0, 0, 0, 0, -5, TURN, 0, 0))

    def test_unreal(self):
        """East, south, up in cm; pitch, yaw, roll; velocities in the world's axes. A positive turn about up is to starboard,
        about right the nose goes down, and about forward starboard goes up."""
        self.follow(self.program("unreal_example"), north=(0, -150, -100, 0, -90, 0), middle=(0, 0, -100, 0, -90, 0),
                    east=(275, -50, -100, 0, 0, 0), down=(0, 0, -100, -90, -90, 0), rolled=(0, 0, -100, 0, -90, 90),
                    turning=(0, 0, -100, 0, 0, 0, 0, -500, 0, 0, 0, -TURN),
                    diving=(0, 0, -100, 0, -90, 0, 0, -500, 0, TURN, 0, 0),
                    rolling=(0, 0, -100, 0, -90, 0, 0, 0, 500, 0, TURN, 0), body=(0, -75, 0, 0, 0, 0),
                    moving_body=(0, 100, 0, 0, 0, 0, 0, -250, 0))

    def test_unity(self):
        """East, up, north; angles about these axes; velocities in the world's axes. A positive turn about up is to starboard,
        about right the nose goes down, and about forward starboard goes up."""
        need("mono")
        self.follow(["mono", UNITY], north=(0, -1, 1.5, 0, 0, 0), middle=(0, -1, 0, 0, 0, 0),
                    east=(2.75, -1, 0.5, 0, 90, 0), down=(0, -1, 0, 90, 0, 0), rolled=(0, -1, 0, 0, 0, -90),
                    turning=(0, -1, 0, 0, 90, 0, 0, 0, 5, 0, -TURN, 0), diving=(0, -1, 0, 0, 0, 0, 0, 0, 5, TURN, 0, 0),
                    rolling=(0, -1, 0, 0, 0, 0, 0, 5, 0, 0, 0, -TURN),
                    # The model's forward axis is x, as for the vehicle: in the world file it heads east.
                    body=(0, 0, 0.75, 0, 90, 0))


def main():
    global UNITY
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder with sonard and the examples in C++")
    parser.add_argument("--modules", required=True, help="folder with pose_pb2.py")
    parser.add_argument("--unity", help="unity.exe")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    link_test.PROGRAMS = os.path.abspath(arguments.programs)
    os.environ["PYTHONPATH"] = os.path.abspath(arguments.modules)
    sys.path += [os.environ["PYTHONPATH"], os.path.join(walls.SOURCE, "clients", "examples", "holoocean")]
    UNITY = arguments.unity and os.path.abspath(arguments.unity)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
