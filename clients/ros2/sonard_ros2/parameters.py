# SPDX-License-Identifier: Apache-2.0
"""The parameters of both nodes. The launch file has an argument for each; docs/simulators/ros2.md lists them."""

from .heads import HEADS
from .parameter import Parameter

# rclpy declares it in every node.
USE_SIM_TIME = Parameter("use_sim_time", False, "stamps are simulated time, of the topic /clock; both nodes")

POSE_BRIDGE = (
    Parameter("source", "odometry", "source of the poses", choices=("odometry", "pose", "tf")),
    Parameter("topic", "/odom", "topic of nav_msgs/Odometry, or of geometry_msgs/PoseStamped with source pose"),
    Parameter("world_frame", "world", "the frame of sonard's world"),
    Parameter("base_frame", "base_link", "the vehicle's frame, for source tf and publish_tf"),
    Parameter("publish_tf", False, "publish each pose that is sent on /tf; not with source tf"),
    Parameter("rate_hz", 50.0, "rate at which tf is read, in Hz; source tf only", 1.0, 1000.0),
    Parameter("axes", "enu_flu", "ned_frd if z points down", choices=("enu_flu", "ned_frd")),
    Parameter("host", "127.0.0.1", "address of sonard's pose input"),
    Parameter("port", 14600, "UDP port of sonard's pose input", 1, 65535),
)

SONAR_BRIDGE = (
    Parameter("type", "gemini", "the type of head", choices=tuple(HEADS)),
    Parameter("device", "", "former name of type; it is used if it is set", choices=("", *HEADS)),
    Parameter("frame_id", "sonar", "the head's frame: x ahead, y to port, z up"),
    Parameter("parent_frame", "", "if set, the frame on which the head is mounted; the mount is published on /tf_static"),
    Parameter("mount_position_m", (0.0, 0.0, 0.0), "x, y and z of the head in parent_frame"),
    Parameter("mount_rpy_deg", (0.0, 0.0, 0.0), "roll, pitch and yaw of the head in parent_frame"),
    Parameter("range_m", 20.0, "range of the pings in metres", 1.0, 150.0),
    Parameter("gain_percent", 50.0, "gain of the head in percent", 0.0, 100.0),
    Parameter("sound_speed_mps", 1500.0, "sound speed in m/s, to convert times to ranges", 1400.0, 1600.0),
    Parameter("threshold_percent", 30.0, "least sample of an echo, in percent of full scale; points, scan", 0.0, 100.0),
    Parameter("min_range_m", 0.75, "least range of an echo in metres; points, scan", 0.0, 150.0),
    Parameter("interval_s", 0.1, "seconds from ping to ping; Gemini, Oculus, Ping1D", 0.01, 60.0),
    Parameter("bits", 8, "bits per sample; Gemini, Oculus", choices=(8, 16)),
    Parameter("step_deg", 1.8, "degrees from line to line; Micron, Ping360", 0.06, 14.3),
    Parameter("bins", 400, "bins per line; Micron, Ping360", 20, 1500),
    Parameter("local", "", "address of this machine; empty: the one that routes to the head; Gemini, Sonar 3D-15"),
    Parameter("high_frequency", False, "the higher of its two frequencies; Oculus, Sonar 3D-15"),
    *(parameter for head in HEADS.values() for parameter in head.PARAMETERS),
)
