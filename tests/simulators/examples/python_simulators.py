#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Stands in for ROS 2 and for HoloOcean: sends 50 messages a second, or a few, through the simulator's publisher for sonard.

    python_simulators.py ros2|holoocean PORT COUNT X Y Z ROLL PITCH YAW VX VY VZ WX WY WZ      COUNT 0: until it is ended

Both use metres, x forward, y left, z up, and rotate by yaw, pitch, roll. ROS 2 gives velocities in the vehicle's axes,
HoloOcean in the world's axes, and turn rates in the vehicle's axes.
"""
import itertools
import math
import os
import socket
import sys
import time

HERE = os.path.dirname(os.path.abspath(__file__))
HOLOOCEAN = os.path.join(HERE, "..", "..", "..", "clients", "examples", "holoocean")
STAND_INS = os.path.join(HERE, "..", "ros2")


def odometry(seconds, position, angles, velocity, turn_rate):
    from ros2_messages import CLASSES
    (cr, cp, cy), (sr, sp, sy) = ([function(angle / 2) for angle in angles] for function in (math.cos, math.sin))
    orientation = (cr * cp * cy + sr * sp * sy, sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy,
                   cr * cp * sy - sr * sp * cy)
    message = CLASSES["nav_msgs/Odometry"](child_frame_id="base_link")
    message.header.frame_id = "world"
    message.header.stamp.sec, message.header.stamp.nanosec = int(seconds), int(seconds % 1 * 1e9)
    pose, twist = message.pose.pose, message.twist.twist
    for vector, names, values in ((pose.position, "xyz", position), (pose.orientation, "wxyz", orientation),
                                  (twist.linear, "xyz", velocity), (twist.angular, "xyz", turn_rate)):
        for name, value in zip(names, values):
            setattr(vector, name, value)
    return message


def state(seconds, position, angles, velocity, turn_rate):
    (cr, cp, cy), (sr, sp, sy) = ([function(angle) for angle in angles] for function in (math.cos, math.sin))
    rotation = [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
                [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
                [-sp, cp * sr, cp * cr]]
    return {"t": seconds, "PoseSensor": [row + [p] for row, p in zip(rotation, position)] + [[0, 0, 0, 1]],
            "VelocitySensor": velocity, "IMUSensor": [[0, 0, 9.81], turn_rate]}


def states(count, numbers, observe):
    """The simulator's states, at its rate."""
    position, angles, velocity, turn_rate = numbers[:3], [math.radians(angle) for angle in numbers[3:6]], numbers[6:9], numbers[9:]
    for i in itertools.count():
        if count and i >= count:
            break
        yield observe(time.monotonic(), position, angles, velocity, turn_rate)
        time.sleep(0.02)


def run_ros2(port, messages):
    """The node of clients/ros2, with stand-ins for rclpy."""
    from ros2_stand_ins import ros
    ros.reset(port=port)
    ros.echo = True
    from sonard_ros2.pose_bridge import PoseBridge
    node = PoseBridge()
    for message in messages:
        ros.publish("/odom", message)
    node.destroy_node()


def run_holoocean(port, messages):
    from holoocean_pose import pose_update
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    for message in messages:
        udp.sendto(pose_update(message).SerializeToString(), ("127.0.0.1", port))


def main():
    simulator, port, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    sys.path[:0] = [HOLOOCEAN, STAND_INS]
    observe, run = {"ros2": (odometry, run_ros2), "holoocean": (state, run_holoocean)}[simulator]
    run(port, states(count, [float(text) for text in sys.argv[4:]], observe))


main()
