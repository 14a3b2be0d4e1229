#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A node of ROS 2 that passes a topic of nav_msgs/Odometry on to sonard.

    python3 sonard_bridge.py --ros-args -p topic:=/rov/odometry -p world_frame:=world

Tests run it without ROS 2, with a few names in place of rclpy.
"""
import socket

import rclpy
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data

from odometry_to_pose import pose_update


class SonardBridge(Node):
    def __init__(self):
        super().__init__("sonard_bridge")
        topic = self.declare_parameter("topic", "/odom").value
        self.world_frame = self.declare_parameter("world_frame", "world").value
        self.axes = self.declare_parameter("axes", "enu_flu").value  # or ned_frd
        self.receiver = (self.declare_parameter("host", "127.0.0.1").value, self.declare_parameter("port", 14600).value)
        self.udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.create_subscription(Odometry, topic, self.on_odometry, qos_profile_sensor_data)
        self.get_logger().info(f"poses of {topic} go to {self.receiver}")

    def on_odometry(self, odometry):
        header = odometry.header
        if header.frame_id != self.world_frame:
            self.complain(f"frame_id is '{header.frame_id}', expected '{self.world_frame}' (parameter world_frame)")
        elif header.stamp.sec == 0 and header.stamp.nanosec == 0:
            self.complain("the stamp is 0: its publisher has to fill in the time")
        else:
            self.send(odometry)

    def complain(self, text):
        self.get_logger().error(f"odometry is dropped: {text}", throttle_duration_sec=10)

    def send(self, odometry):
        self.udp.sendto(pose_update(odometry, self.axes).SerializeToString(), self.receiver)


rclpy.init()
rclpy.spin(SonardBridge())
