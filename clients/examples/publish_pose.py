#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Publishes a vehicle that drives a circle, as any simulator can (docs/poses.md).

Needs python3-protobuf and, once, the message module beside this file:
    protoc --proto_path=protocol/pose --python_out=clients/examples pose.proto
"""
import argparse
import math
import socket
import time

import pose_pb2

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--to", default="127.0.0.1", help="address sonard listens on")
parser.add_argument("--port", type=int, default=14600)
parser.add_argument("--seconds", type=float, default=math.inf, help="end after this time")
args = parser.parse_args()

RADIUS_M, SPEED_MPS, DEPTH_M, RATE_HZ = 10.0, 0.5, 20.0, 50.0
udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
begin = time.monotonic_ns()
while (now := time.monotonic_ns()) - begin < args.seconds * 1e9:
    angle = SPEED_MPS / RADIUS_M * (now - begin) * 1e-9
    heading = angle + math.pi / 2  # along the circle, counter-clockwise from east

    update = pose_pb2.PoseUpdate(time_ns=now, frame=pose_pb2.FRAME_ENU_FLU)
    position, orientation = update.vehicle.position_m, update.vehicle.orientation
    position.x, position.y, position.z = RADIUS_M * math.cos(angle), RADIUS_M * math.sin(angle), -DEPTH_M
    orientation.w, orientation.z = math.cos(heading / 2), math.sin(heading / 2)
    update.twist.linear_mps.x = SPEED_MPS  # forward, in the vehicle's axes
    update.twist.angular_radps.z = SPEED_MPS / RADIUS_M  # to port

    udp.sendto(update.SerializeToString(), (args.to, args.port))
    time.sleep(1 / RATE_HZ)
