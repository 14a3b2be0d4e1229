#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Stands in for ROS 2 and for HoloOcean: 50 messages a second, or a few, through the example for it.

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


def states(count, numbers, observe):
    """What the simulator says, in time."""
    position, angles, velocity, turn_rate = numbers[:3], [math.radians(angle) for angle in numbers[3:6]], numbers[6:9], numbers[9:]
    for i in itertools.count():
        if count and i >= count:
            break
        yield observe(time.monotonic(), position, angles, velocity, turn_rate)
        time.sleep(0.02)


def run_ros2(port, messages):
    """The node itself, with the few names of rclpy that it takes."""
    class Node:
        def __init__(self, name):
            self.name = name

        def declare_parameter(self, name, default):
            return SimpleNamespace(value=port if name == "port" else default)

        def create_subscription(self, kind, topic, callback, qos):
            self.callback = callback

        def get_logger(self):
            return SimpleNamespace(info=print, error=lambda text, throttle_duration_sec: print(text))

    def spin(node):
        for message in messages:
            node.callback(message)

    sys.modules.update({"rclpy": SimpleNamespace(init=lambda: None, spin=spin), "rclpy.node": SimpleNamespace(Node=Node),
                        "rclpy.qos": SimpleNamespace(qos_profile_sensor_data=None),
                        "nav_msgs": SimpleNamespace(), "nav_msgs.msg": SimpleNamespace(Odometry=None)})
    import sonard_bridge  # noqa: F401


def run_holoocean(port, messages):
    from holoocean_pose import pose_update
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for message in messages:
        udp.sendto(pose_update(message).SerializeToString(), ("127.0.0.1", port))


def main():
    simulator, port, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    sys.path.insert(0, os.path.join(EXAMPLES, simulator))
    observe, run = {"ros2": (odometry, run_ros2), "holoocean": (state, run_holoocean)}[simulator]
    run(port, states(count, [float(text) for text in sys.argv[4:]], observe))


main()
