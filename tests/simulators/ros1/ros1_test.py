#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""roscast between ROS's own tools and the daemon: the image follows the poses, and errors are logged.

    ros1_test.py --programs DIR --modules DIR [Ros1.test_name ...]
"""

import argparse
import json
import math
import os
import signal
import sys
import time
import unittest

sys.path.insert(0, os.path.abspath(os.path.join(os.path.dirname(__file__), "..")))

import walls  # noqa: E402
from walls import AHEAD, PORT_MOST, STARBOARD_MOST, link_test  # noqa: E402
from lab import Deadline, need, receive  # noqa: E402

MASTER = "http://127.0.0.1:11311"
POSE_PORT = 14600


def quaternion(axis, degrees):
    half = math.radians(degrees) / 2
    return dict(zip("xyzw", [math.sin(half) * part for part in axis] + [math.cos(half)]))


LEVEL = {"x": 0, "y": 0, "z": 0, "w": 1}


def vector(x, y, z):
    return {"x": x, "y": y, "z": z}


def header(frame, stamp="now"):
    return {"stamp": stamp, "frame_id": frame}


def odometry(position, orientation, frame="world", linear=(0, 0, 0), angular=(0, 0, 0), stamp="now"):
    return {"header": header(frame, stamp), "child_frame_id": "base_link",
            "pose": {"pose": {"position": vector(*position), "orientation": orientation}},
            "twist": {"twist": {"linear": vector(*linear), "angular": vector(*angular)}}}


def transform(parent, child, position, orientation):
    return {"header": header(parent), "child_frame_id": child,
            "transform": {"translation": vector(*position), "rotation": orientation}}


class Ros1(walls.WallTest):
    def setUp(self):
        super().setUp()
        need("rosmaster")
        need("rostopic")
        os.environ.update(ROS_MASTER_URI=MASTER, ROS_IP="127.0.0.1", ROS_HOME=self.folder.name)
        self.lab = None

    def start_lab(self):
        """Without a daemon: this process receives the poses."""
        self.lab = self.make_lab()
        self.poses = self.lab.head.udp_socket("127.0.0.1", POSE_PORT)
        self.addCleanup(self.poses.close)

    def next_pose(self, seconds=link_test.PATIENCE_S):
        import pose_pb2
        got = receive(self.poses, seconds)
        self.assertIsNotNone(got, "no pose came")
        return pose_pb2.PoseUpdate.FromString(got[0])

    def start_master(self):
        """Starts a master and waits until it answers, because rostopic does not wait."""
        master = self.lab.start(self.lab.head, "rosmaster", "--core", "-p", "11311")
        deadline = Deadline(link_test.PATIENCE_S)
        while self.lab.start(self.lab.head, "bash", "-c", ": </dev/tcp/127.0.0.1/11311").wait(5) != 0:
            self.assertFalse(deadline.over(), master.tail())
            time.sleep(0.1)
        return master

    def publish(self, topic, kind, message, *options):
        """Publishes 50 times a second, until the test or the caller ends it."""
        return self.lab.start(self.lab.head, "rostopic", "pub", "-s", *(options or ("-r", "50")), topic, kind,
                              json.dumps(message))

    def publish_odometry(self, *arguments, **options):
        return self.publish("/odom", "nav_msgs/Odometry", odometry(*arguments, **options))

    def cast(self, *options):
        return self.lab.start(self.lab.head, os.path.join(link_test.PROGRAMS, "roscast"), *options)

    def end(self, program, code=0):
        program.signal(signal.SIGINT)
        self.assertEqual(program.wait(link_test.PATIENCE_S), code, program.tail())

    # ---- The image follows ----

    def test_odometry_in_enu(self):
        self.start_walls()
        self.start_master()
        bridge = self.cast("--odometry", "/odom")
        # Heading north from 1.5 m north of the origin. If axes were swapped, it would be 4 or 5.5 m.
        vehicle = self.publish_odometry((0, 1.5, -1), quaternion((0, 0, 1), 90))
        self.check_ranges({AHEAD: 2.5})
        vehicle.kill()
        # Heading east from 2.75 m east: the east wall.
        vehicle = self.publish_odometry((2.75, 0.5, -1), LEVEL)
        self.check_ranges({AHEAD: 3.25})
        vehicle.kill()
        # Heading north at the origin: the beam farthest to starboard meets the east wall before the north wall.
        vehicle = self.publish_odometry((0, 0, -1), quaternion((0, 0, 1), 90))
        self.check_ranges({PORT_MOST: 4 / math.cos(walls.INNER_RAD), STARBOARD_MOST: 6 / math.sin(walls.OUTER_RAD)})
        vehicle.kill()
        bridge.wait_for_line("first pose: 'base_link' in 'world' at ", 1)
        self.end(bridge)
        bridge.wait_for_line("wrong_frame=0 no_stamp=0 bad_value=0 clock_resets=0", 1)

    def test_odometry_in_ned_over_tcp(self):
        """As from Stonefish's own bridge."""
        self.start_walls("  tcp:\n    bind: 127.0.0.1:14601")
        self.start_master()
        self.cast("--odometry", "/odom", "--axes", "ned_frd", "--world-frame", "world_ned", "--tcp", "--to",
                  "127.0.0.1:14601")
        vehicle = self.publish_odometry((1.5, 0, 1), LEVEL, frame="world_ned")
        self.check_ranges({AHEAD: 2.5})
        vehicle.kill()
        # Nose down.
        self.publish_odometry((0, 0, 1), quaternion((0, 1, 0), -90), frame="world_ned")
        self.check_ranges({AHEAD: 4})

    def test_twist_carries_on(self):
        """One message only: sonard extrapolates for extrapolation_limit_ms, 300, and then holds the pose."""
        self.start_walls()
        self.start_master()
        bridge = self.cast("--odometry", "/odom")
        bridge.wait_for_line("listening to /odom", link_test.PATIENCE_S)
        # From the origin, heading north, at 5 m/s to its own starboard (-y), while it turns by 90 degrees to starboard: a
        # quarter of a circle, 1.5 m long, first to the east and finally to the south.
        turned = math.pi / 2
        self.lab.start(self.lab.head, "rostopic", "pub", "-s", "-1", "/odom", "nav_msgs/Odometry", json.dumps(
            odometry((0, 0, -1), quaternion((0, 0, 1), 90), linear=(0, -5, 0), angular=(0, 0, -turned / 0.3))))
        self.check_ranges({AHEAD: 6 - 1.5 / turned})

    def test_tf_with_a_body(self):
        self.start_walls()
        self.start_master()
        self.publish("/tf_static", "tf2_msgs/TFMessage",
                     {"transforms": [transform("map", "odom", (0, 1, 0), quaternion((0, 0, 1), 90))]}, "-l")
        tree = self.publish("/tf", "tf2_msgs/TFMessage", {"transforms": [
            transform("odom", "base_link", (0.5, 0, -1), LEVEL),
            transform("map", "barrier", (0, 0.75, 0), LEVEL)]})
        bridge = self.cast("--vehicle-frame", "base_link", "--world-frame", "/map", "--body", "barrier=walls")
        # 1.5 m north heading north, before a wall that is 0.75 m further away than in the world file.
        self.check_ranges({AHEAD: 3.25})
        tree.kill()
        self.end(bridge)
        bridge.wait_for_line("wrong_frame=0 no_stamp=0 bad_value=0 clock_resets=0", 1)

    # ---- Time ----

    def test_stamps_are_those_of_the_headers(self):
        self.start_lab()
        self.start_master()
        self.cast("--odometry", "/odom")
        self.publish_odometry((1, 2, 3), LEVEL, stamp={"secs": 12, "nsecs": 500000000}, linear=(1, 0, 0))
        update = self.next_pose()
        self.assertEqual(update.time_ns, 12_500_000_000)
        self.assertEqual((update.vehicle.position_m.x, update.vehicle.position_m.y, update.vehicle.position_m.z), (1, 2, 3))
        self.assertEqual(update.twist.linear_mps.x, 1)

    # ---- Errors are logged ----

    def test_master_comes_late_and_goes(self):
        self.start_lab()
        bridge = self.cast("--odometry", "/odom")
        bridge.wait_for_line("no ROS master answers at http://127.0.0.1:11311", link_test.PATIENCE_S)
        master = self.start_master()
        bridge.wait_for_line("listening to /odom", link_test.PATIENCE_S)
        master.kill()
        bridge.wait_for_line("the ROS master at http://127.0.0.1:11311 is gone", link_test.PATIENCE_S)
        self.start_master()
        bridge.wait_for_line("the ROS master is back", link_test.PATIENCE_S)
        self.publish_odometry((1, 2, 3), LEVEL)
        self.next_pose()
        self.end(bridge)

    def test_wrong_type(self):
        self.start_lab()
        self.start_master()
        self.publish("/odom", "geometry_msgs/PoseStamped", {"header": header("world")})
        bridge = self.cast("--odometry", "/odom")
        self.assertEqual(bridge.wait(link_test.PATIENCE_S), 1, bridge.tail())
        bridge.wait_for_line("/odom carries geometry_msgs/PoseStamped, not nav_msgs/Odometry", 1)

    def test_wrong_frame(self):
        self.start_lab()
        self.start_master()
        self.publish_odometry((1, 2, 3), LEVEL, frame="world_ned")
        bridge = self.cast("--odometry", "/odom")
        bridge.wait_for_line("frame_id 'world_ned' is dropped: expected 'world'.*--axes ned_frd", link_test.PATIENCE_S)
        self.assertIsNone(receive(self.poses, 0.5))
        self.end(bridge)
        self.assertEqual(sum("is dropped" in line for line in bridge.lines), 1)

    def test_topic_that_nobody_publishes(self):
        self.start_lab()
        self.start_master()
        self.publish("/rov/pose_gt", "nav_msgs/Odometry", odometry((0, 0, 0), LEVEL))
        bridge = self.cast("--odometry", "/odom")
        bridge.wait_for_line("no node publishes /odom; topics of nav_msgs/Odometry: ", link_test.PATIENCE_S)
        self.publish("/tf", "tf2_msgs/TFMessage", {"transforms": [transform("odom", "base_link", (0, 0, 0), LEVEL)]})
        by_tf = self.cast("--vehicle-frame", "base_link")
        by_tf.wait_for_line("no poses from /tf: .*world.*known frames: base_link, odom", link_test.PATIENCE_S)

    def test_command_line(self):
        self.lab = self.make_lab()
        for options, complaint in (([], "--odometry TOPIC or --vehicle-frame FRAME"),
                                   (["--odometry", "/odom", "--body", "crab"], "expected FRAME=BODY, found 'crab'"),
                                   (["--odometry", "/odom", "--body", "a=c", "--body", "b=c"], "'c' follows two frames"),
                                   (["--odometry", "/odom", "--to", "here"], "expected HOST:PORT, found 'here'")):
            bridge = self.cast(*options)
            self.assertEqual(bridge.wait(link_test.PATIENCE_S), 2, bridge.tail())
            self.assertIn(complaint, bridge.output())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder with sonard and roscast")
    parser.add_argument("--modules", required=True, help="folder with pose_pb2.py")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    link_test.PROGRAMS = os.path.abspath(arguments.programs)
    sys.path.insert(0, os.path.abspath(arguments.modules))
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
