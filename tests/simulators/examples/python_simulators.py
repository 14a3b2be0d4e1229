#!/usr/bin/env python3
"""Stands in for ROS 2 and for HoloOcean: 50 messages a second, or a few, through the conversion of the example.

    python_simulators.py ros2|holoocean PORT COUNT X Y Z ROLL PITCH YAW VX VY VZ WX WY WZ      COUNT 0: until it is ended

Both count metres, x forward, y left, z up, and turn by yaw, pitch, roll. ROS 2 gives velocities on board, HoloOcean in the
world's axes, and turn rates on board.
"""
import itertools
import math
import os
import socket
import sys
import time
from types import SimpleNamespace

EXAMPLES = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", "..", "clients", "examples"))


def parts(names, values):
    return SimpleNamespace(**dict(zip(names, values)))


def odometry(seconds, position, angles, velocity, turn_rate):
    (cr, cp, cy), (sr, sp, sy) = ([function(angle / 2) for angle in angles] for function in (math.cos, math.sin))
    orientation = parts("wxyz", (cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                                 cr * cp * sy - sr * sp * cy))
    stamp = SimpleNamespace(sec=int(seconds), nanosec=int(seconds % 1 * 1e9))
    return SimpleNamespace(header=SimpleNamespace(stamp=stamp, frame_id="world"), child_frame_id="base_link",
                           pose=SimpleNamespace(pose=SimpleNamespace(position=parts("xyz", position), orientation=orientation)),
                           twist=SimpleNamespace(twist=SimpleNamespace(linear=parts("xyz", velocity),
                                                                       angular=parts("xyz", turn_rate))))


def state(seconds, position, angles, velocity, turn_rate):
    (cr, cp, cy), (sr, sp, sy) = ([function(angle) for angle in angles] for function in (math.cos, math.sin))
    rotation = [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr]]
    return {"t": seconds, "PoseSensor": [row + [p] for row, p in zip(rotation, position)] + [[0, 0, 0, 1]],
            "VelocitySensor": velocity, "IMUSensor": [[0, 0, 9.81], turn_rate]}


def main():
    simulator, port, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    sys.path.insert(0, os.path.join(EXAMPLES, simulator))
    if simulator == "ros2":
        from odometry_to_pose import pose_update
        observe = odometry
    else:
        from holoocean_pose import pose_update
        observe = state
    numbers = [float(text) for text in sys.argv[4:]]
    position, angles, velocity, turn_rate = numbers[:3], [math.radians(angle) for angle in numbers[3:6]], numbers[6:9], numbers[9:]
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for i in itertools.count():
        if count and i >= count:
            break
        seen = observe(time.monotonic(), position, angles, velocity, turn_rate)
        udp.sendto(pose_update(seen).SerializeToString(), ("127.0.0.1", port))
        time.sleep(0.02)


main()
