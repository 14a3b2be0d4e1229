#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The bridge's output for messages: frames, stamps, trees. ros1_test.py compares the images.

    pose_bridge_test.py --modules DIR [PoseBridgeTest.test_name ...]
"""

import argparse
import math
import os
import sys
import unittest

import genpy
from geometry_msgs.msg import Point, Quaternion, TransformStamped, Vector3
from nav_msgs.msg import Odometry

HALF = math.sqrt(0.5)
LEVEL = (1, 0, 0, 0)
TO_PORT = (HALF, 0, 0, HALF)


def quaternion(wxyz):
    return Quaternion(**dict(zip("wxyz", wxyz)))


def odometry(frame="world"):
    message = Odometry(child_frame_id="base_link")
    message.header.frame_id = frame
    message.header.stamp = genpy.Time(1)
    message.pose.pose.position = Point(1, 2, 3)
    message.pose.pose.orientation = quaternion(TO_PORT)
    message.twist.twist.linear = Vector3(4, 5, 6)
    message.twist.twist.angular = Vector3(7, 8, 9)
    return message


def at(seconds, frame, child, position, orientation=LEVEL):
    transform = TransformStamped(child_frame_id=child)
    transform.header.frame_id = frame
    transform.header.stamp = genpy.Time(0, round(seconds * 1e9))
    transform.transform.translation = Vector3(*position)
    transform.transform.rotation = quaternion(orientation)
    return transform


def xyz(vector):
    return vector.x, vector.y, vector.z


class PoseBridgeTest(unittest.TestCase):
    def setUp(self):
        self.sent = []
        self.said = []

    def bridge(self, **settings):
        import pose_bridge
        return pose_bridge.PoseBridge(self.sent.append, self.said.append, **settings)

    def odometry_bridge(self, **settings):
        return self.bridge(odometry=True, **settings)

    def tree_bridge(self, bodies=()):
        return self.bridge(odometry=False, world_frame="map", vehicle_frame="base_link", bodies=bodies)

    def assert_position(self, update, expected):
        for found, wanted in zip(xyz(update.vehicle.position_m), expected):
            self.assertAlmostEqual(found, wanted, 9)

    def assert_said(self, *parts):
        self.assertEqual(len(self.said), len(parts), self.said)
        for line, part in zip(self.said, parts):
            self.assertIn(part, line)

    def test_odometry_is_taken_as_it_is(self):
        import pose_pb2
        self.odometry_bridge().on_odometry(odometry())
        update, = self.sent
        self.assertEqual((update.time_ns, update.frame), (10**9, pose_pb2.FRAME_ENU_FLU))
        self.assertEqual(xyz(update.vehicle.position_m), (1, 2, 3))
        self.assertAlmostEqual(update.vehicle.orientation.w, HALF)
        self.assertAlmostEqual(update.vehicle.orientation.z, HALF)
        self.assertEqual(xyz(update.twist.linear_mps), (4, 5, 6))
        self.assertEqual(xyz(update.twist.angular_radps), (7, 8, 9))
        self.assert_said("first pose: 'base_link' in 'world' at 1.000 s, (1.00, 2.00, 3.00) east, north, up")

    def test_ned_is_said_to_be_ned(self):
        import pose_pb2
        self.odometry_bridge(world_frame="world_ned", axes="ned_frd").on_odometry(odometry("/world_ned"))
        update, = self.sent
        self.assertEqual(update.frame, pose_pb2.FRAME_NED_FRD)
        self.assertEqual(xyz(update.vehicle.position_m), (1, 2, 3))
        self.assert_said("(2.00, 1.00, -3.00) east, north, up")

    def test_other_frames_are_dropped_and_said_once(self):
        bridge = self.odometry_bridge(vehicle_frame="base_link")
        bridge.on_odometry(odometry("world_ned"))
        bridge.on_odometry(odometry("world_ned"))
        other = odometry()
        other.child_frame_id = "arm"
        bridge.on_odometry(other)
        self.assertEqual(self.sent, [])
        self.assertEqual(bridge.counters["wrong_frame"], 3)
        self.assert_said("frame_id 'world_ned' is dropped: expected 'world'",
                         "child_frame_id 'arm' is dropped: expected 'base_link'")

    def test_messages_without_time_or_sense_are_dropped(self):
        bridge = self.odometry_bridge()
        timeless = odometry()
        timeless.header.stamp = genpy.Time()
        no_rotation = odometry()
        no_rotation.pose.pose.orientation = Quaternion()
        huge_rotation = odometry()
        huge_rotation.pose.pose.orientation = quaternion((1e200, 0, 0, 0))
        nowhere = odometry()
        nowhere.pose.pose.position.y = math.inf
        turning_nan = odometry()
        turning_nan.twist.twist.angular.y = math.nan
        fast = odometry()
        fast.twist.twist.linear.x = 1e7
        for message in (timeless, no_rotation, huge_rotation, nowhere, turning_nan, fast):
            bridge.on_odometry(message)
        self.assertEqual(self.sent, [])
        self.assertEqual((bridge.counters["no_stamp"], bridge.counters["bad_value"]), (1, 5))
        self.assert_said("stamp of 0", "orientation has a norm", "position is not finite", "twist is not finite")

    def test_chain_of_transforms_at_its_newest_common_time(self):
        bridge = self.tree_bridge()
        bridge.on_transforms([at(0, "/map", "/site", (100, 0, 0), TO_PORT)], True)
        bridge.on_transforms([at(10.0, "site", "odom", (0, 0, 0)), at(10.2, "site", "odom", (2, 0, 0))], False)
        self.assertEqual(self.sent, [], "where the vehicle is in odom is not known")
        self.assertIn("known frames: map, odom, site", bridge.why_no_vehicle())
        bridge.on_transforms([at(10.1, "odom", "base_link", (0, 0, -5))], False)
        update, = self.sent
        self.assertEqual(update.time_ns, 10_100_000_000)
        self.assert_position(update, (100, 1, -5))  # half way, turned to port
        self.assertFalse(update.HasField("twist"))

        bridge.on_transforms([at(10.3, "base_link", "camera", (1, 0, 0))], False)
        self.assertEqual(len(self.sent), 1, "no news of the vehicle")

    def test_paused_simulation_keeps_sending(self):
        bridge = self.tree_bridge()
        for _ in range(3):
            bridge.on_transforms([at(10, "map", "base_link", (1, 0, 0))], False)
        self.assertEqual(len(self.sent), 3)
        self.assertEqual(bridge.counters["clock_resets"], 0)

    def test_reset_forgets_all_but_static_transforms(self):
        bridge = self.tree_bridge()
        bridge.on_transforms([at(0, "map", "odom", (100, 0, 0))], True)
        bridge.on_transforms([at(50, "odom", "base_link", (1, 0, 0))], False)
        bridge.on_transforms([at(49.9, "odom", "base_link", (7, 0, 0))], False)
        self.assertEqual([update.time_ns for update in self.sent], [50 * 10**9] * 2, "late, but no reset")
        bridge.on_transforms([at(0.1, "odom", "base_link", (2, 0, 0))], False)
        bridge.on_transforms([at(0.2, "odom", "base_link", (3, 0, 0))], False)
        self.assertEqual([update.time_ns for update in self.sent[2:]], [100_000_000, 200_000_000])
        self.assert_position(self.sent[3], (103, 0, 0))
        self.assertEqual(bridge.counters["clock_resets"], 1)
        self.assertIn("the stamps of frame 'base_link' went back to 0.100 s", self.said[-1])

    def test_bodies_follow_their_frames(self):
        bridge = self.tree_bridge([("crab_frame", "crab"), ("never_seen", "fish")])
        bridge.on_transforms([at(1, "map", "crab_frame", (0, 0, 0)), at(2, "map", "crab_frame", (4, 0, 0)),
                              at(1.25, "map", "base_link", (0, 0, 0))], False)
        body, = self.sent[0].bodies
        self.assertEqual(body.name, "crab")
        self.assertAlmostEqual(body.pose.position_m.x, 1, 9, "at the vehicle's time")

        bridge.on_transforms([at(3, "map", "base_link", (0, 0, 0))], False)
        self.assertEqual(len(self.sent), 2)
        self.assertAlmostEqual(self.sent[1].bodies[0].pose.position_m.x, 4, 9, "the newest there is")

    def test_transforms_that_mean_nothing_are_dropped(self):
        bridge = self.tree_bridge()
        bridge.on_transforms([at(1, "map", "base_link", (0, 0, 0), (0, 0, 0, 0)),
                              at(1, "map", "base_link", (2e8, 0, 0))], False)
        self.assertEqual(self.sent, [])
        self.assertEqual(bridge.counters["bad_value"], 2)

    def test_vehicle_that_never_moves_has_no_time(self):
        bridge = self.tree_bridge()
        bridge.on_transforms([at(0, "map", "base_link", (1, 0, 0))], True)
        bridge.on_transforms([at(1, "map", "other", (1, 0, 0))], False)
        self.assertEqual(self.sent, [])
        self.assertEqual(bridge.counters["no_stamp"], 1)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--modules", required=True, help="folder with pose_bridge.py and pose_pb2.py")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    sys.path.insert(0, os.path.abspath(arguments.modules))
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
