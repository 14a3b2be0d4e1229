# SPDX-License-Identifier: Apache-2.0
"""nav_msgs/Odometry of ROS 2 as a message for sonard (docs/simulators/ros2.md).

Needs python3-protobuf and, once, the message module beside this file:
    protoc --proto_path=protocol/pose --python_out=clients/examples/ros2 pose.proto
"""
import pose_pb2


def pose_update(odometry, axes="enu_flu"):
    """Numbers go as they are: sonard knows both axes, and the twist of Odometry is in the vehicle's own."""
    stamp = odometry.header.stamp
    frame = {"enu_flu": pose_pb2.FRAME_ENU_FLU, "ned_frd": pose_pb2.FRAME_NED_FRD}[axes]
    update = pose_pb2.PoseUpdate(time_ns=stamp.sec * 10**9 + stamp.nanosec, frame=frame)
    pose, twist = odometry.pose.pose, odometry.twist.twist
    for ours, theirs, names in ((update.vehicle.position_m, pose.position, "xyz"),
                                (update.vehicle.orientation, pose.orientation, "wxyz"),
                                (update.twist.linear_mps, twist.linear, "xyz"),
                                (update.twist.angular_radps, twist.angular, "xyz")):
        for name in names:
            setattr(ours, name, getattr(theirs, name))
    return update
