#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Sends the poses of a vehicle that drives a circle, like a simulator (docs/poses.md). Needs only Python."""
import argparse
import math
import os
import sys
import time

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "python"))
from sonard_client import PosePublisher  # noqa: E402

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--to", default="127.0.0.1", help="address of sonard's pose input")
parser.add_argument("--port", type=int, default=14600)
parser.add_argument("--tcp", action="store_true", help="connect by TCP (poses.tcp.bind) instead of sending UDP datagrams")
parser.add_argument("--seconds", type=float, default=math.inf, help="end after this many seconds")
args = parser.parse_args()

RADIUS_M, SPEED_MPS, DEPTH_M, RATE_HZ = 10.0, 0.5, 20.0, 50.0
begin = time.monotonic_ns()
with PosePublisher(args.to, args.port, tcp=args.tcp) as poses:
    while (now := time.monotonic_ns()) - begin < args.seconds * 1e9:
        angle = SPEED_MPS / RADIUS_M * (now - begin) * 1e-9
        heading = angle + math.pi / 2  # along the circle, counter-clockwise from east
        poses.send(
            now,  # nanoseconds on any clock, also a simulated one
            position_m=(RADIUS_M * math.cos(angle), RADIUS_M * math.sin(angle), -DEPTH_M),
            quaternion_xyzw=(0, 0, math.sin(heading / 2), math.cos(heading / 2)),
            linear_mps=(SPEED_MPS, 0, 0),  # forward, in the vehicle's axes
            angular_radps=(0, 0, SPEED_MPS / RADIUS_M))  # turning to port
        time.sleep(1 / RATE_HZ)
