#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tests sonard_client.poses against the module that protobuf generates from protocol/pose/pose.proto.

    poses_test.py --modules DIR [Encoding.test_name ...]
"""

import argparse
import math
import os
import socket
import subprocess
import sys
import unittest

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "..", ".."))
sys.path.insert(0, os.path.join(SOURCE, "clients", "python"))

from sonard_client import MovingBody, PosePublisher, encode_pose  # noqa: E402

POSITION_M, QUATERNION_XYZW = (1.5, -2.25, -30.0), (0.1, -0.2, 0.3, 0.9)


def decoded(*arguments, **named):
    import pose_pb2
    return pose_pb2.PoseUpdate.FromString(encode_pose(*arguments, **named))


def numbers(message, names="xyz"):
    return tuple(getattr(message, name) for name in names)


class Encoding(unittest.TestCase):
    def test_a_pose_alone(self):
        update = decoded(1_700_000_000_123_456_789, POSITION_M, QUATERNION_XYZW)
        self.assertEqual(update.time_ns, 1_700_000_000_123_456_789)
        self.assertEqual(update.frame, 0)
        self.assertEqual(numbers(update.vehicle.position_m), POSITION_M)
        self.assertEqual(numbers(update.vehicle.orientation, "xyzw"), QUATERNION_XYZW)
        self.assertFalse(update.HasField("twist"), "left out, the pose holds")
        self.assertEqual(len(update.bodies), 0)
        self.assertEqual(len(update.SerializeToString()), len(encode_pose(1_700_000_000_123_456_789, POSITION_M,
                                                                        QUATERNION_XYZW)) - 2, "but the frame, which is 0")

    def test_times(self):
        for time_ns in (0, 1, 127, 128, 2**32, 4 * 10**18, -1, -128, -10**9, -4 * 10**18):
            with self.subTest(time_ns):
                self.assertEqual(decoded(time_ns, POSITION_M, QUATERNION_XYZW).time_ns, time_ns)

    def test_axes(self):
        import pose_pb2
        self.assertEqual(decoded(1, POSITION_M, QUATERNION_XYZW, axes="enu_flu").frame, pose_pb2.FRAME_ENU_FLU)
        self.assertEqual(decoded(1, POSITION_M, QUATERNION_XYZW, axes="ned_frd").frame, pose_pb2.FRAME_NED_FRD)

    def test_velocities(self):
        twist = decoded(1, POSITION_M, QUATERNION_XYZW, (0.5, -1, 2), (3, 4, -5)).twist
        self.assertEqual((numbers(twist.linear_mps), numbers(twist.angular_radps)), ((0.5, -1, 2), (3, 4, -5)))
        for names in ({"linear_mps": (0.5, -1, 2)}, {"angular_radps": (0.5, -1, 2)}):
            with self.subTest(names):
                update = decoded(1, POSITION_M, QUATERNION_XYZW, **names)
                self.assertTrue(update.HasField("twist"))
                for name in ("linear_mps", "angular_radps"):
                    self.assertEqual(numbers(getattr(update.twist, name)), names.get(name, (0, 0, 0)))

    def test_bodies(self):
        buoy, rov = decoded(1, POSITION_M, QUATERNION_XYZW, bodies=[
            MovingBody("buoy", (1, 2, 3), (0, 0, 0, 1)),
            MovingBody("rov é", (4, 5, 6), (0.5, 0.5, 0.5, 0.5), linear_mps=(1, 0, 0), angular_radps=(0, 0, 0.5))]).bodies
        self.assertEqual((buoy.name, numbers(buoy.pose.position_m)), ("buoy", (1, 2, 3)))
        self.assertFalse(buoy.HasField("twist"))
        self.assertEqual((rov.name, numbers(rov.pose.orientation, "xyzw")), ("rov é", (0.5, 0.5, 0.5, 0.5)))
        self.assertEqual((numbers(rov.twist.linear_mps), numbers(rov.twist.angular_radps)), ((1, 0, 0), (0, 0, 0.5)))
        for names, reason in ((("", ), "name is empty"), (("rov", "rov"), "bodies has a name twice")):
            with self.assertRaisesRegex(ValueError, reason):
                encode_pose(1, POSITION_M, QUATERNION_XYZW,
                            bodies=[MovingBody(name, POSITION_M, QUATERNION_XYZW) for name in names])

    def test_what_sonard_refuses(self):
        good = {"time_ns": 1, "position_m": (1, 2, 3), "quaternion_xyzw": (0, 0, 0, 1), "linear_mps": (0, 0, 0),
                "angular_radps": (0, 0, 0), "axes": "enu_flu"}
        encode_pose(**good)
        bad = {"time_ns": (4 * 10**18 + 1, -4 * 10**18 - 1),
               "position_m": ((math.nan, 0, 0), (0, math.inf, 0), (0, 0, -1.1e8), (0, 0), (0, 0, 0, 0)),
               "quaternion_xyzw": ((0, 0, 0, 0), (0, 0, 0, 1001), (0, math.nan, 0, 1), (math.inf, 0, 0, 0), (0, 0, 1)),
               "linear_mps": ((math.nan, 0, 0), (0, 1.1e6, 0), (0, 0)), "angular_radps": ((0, 0, -math.inf), (0, 0, 1.1e6)),
               "axes": ("flu", "")}
        for name, values in bad.items():
            for value in values:
                with self.subTest(name, value=value), self.assertRaisesRegex(ValueError, f"^{name} is "):
                    encode_pose(**{**good, name: value})

    def test_publisher(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sonard:
            sonard.bind(("127.0.0.1", 0))
            sonard.settimeout(5)
            with PosePublisher("127.0.0.1", sonard.getsockname()[1]) as poses:
                poses.send(7, POSITION_M, QUATERNION_XYZW, (1, 2, 3), (4, 5, 6), "ned_frd")
            self.assertEqual(sonard.recv(2048), encode_pose(7, POSITION_M, QUATERNION_XYZW, (1, 2, 3), (4, 5, 6), "ned_frd"))

    def test_publisher_by_tcp(self):
        """Each message follows its length, a varint (docs/poses.md)."""
        with socket.create_server(("127.0.0.1", 0)) as sonard:
            poses = PosePublisher("127.0.0.1", sonard.getsockname()[1], tcp=True)
            connection, _ = sonard.accept()
            with connection:
                connection.settimeout(5)
                poses.send(7, POSITION_M, QUATERNION_XYZW)
                poses.send(8, POSITION_M, QUATERNION_XYZW, (1, 2, 3), (4, 5, 6), "ned_frd")
                with self.assertRaises(TimeoutError):
                    poses.finish(timeout_s=0.05)
                received = b""
                while piece := connection.recv(2048):
                    received += piece
        expected = b""
        for message in (encode_pose(7, POSITION_M, QUATERNION_XYZW),
                        encode_pose(8, POSITION_M, QUATERNION_XYZW, (1, 2, 3), (4, 5, 6), "ned_frd")):
            # 7 bits per byte, low bits first. The highest bit is set in all bytes but the last.
            length = bytes([len(message)]) if len(message) < 128 else bytes([len(message) % 128 + 128, len(message) // 128])
            expected += length + message
        self.assertEqual(received, expected)
        self.assertRaises(ConnectionRefusedError, PosePublisher, "127.0.0.1", self.closed_port(), tcp=True)

    @staticmethod
    def closed_port():
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            return probe.getsockname()[1]

    def test_needs_no_numpy(self):
        """Replaces NumPy by a module whose import fails."""
        program = ("import sys; sys.modules['numpy'] = None\n"
                   "from sonard_client import PosePublisher, encode_pose\n"
                   "PosePublisher().send(1, (0, 0, 0), (0, 0, 0, 1))\n"
                   "try:\n    from sonard_client import Gemini\nexcept ImportError as error:\n    print(error.name)\n")
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False,
                              env={**os.environ, "PYTHONPATH": os.path.join(SOURCE, "clients", "python")})
        self.assertEqual((done.returncode, done.stdout), (0, "numpy\n"), done.stderr)

    def test_everything_that_is_named_is_there(self):
        import sonard_client
        for name in sonard_client.__all__:
            self.assertIsNotNone(getattr(sonard_client, name))
        self.assertRaises(AttributeError, getattr, sonard_client, "Sonar")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--modules", required=True, help="folder of pose_pb2.py")
    options, rest = parser.parse_known_args()
    sys.path.insert(0, os.path.abspath(options.modules))
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
