# SPDX-License-Identifier: Apache-2.0
"""A node that sends the vehicle's pose to sonard, from nav_msgs/Odometry, geometry_msgs/PoseStamped or tf2.

    ros2 run sonard_ros2 pose_bridge --ros-args -p source:=odometry -p topic:=/rov/odometry

Numbers are sent unchanged: sonard supports the axes of ROS, and the twist of Odometry is in the vehicle's axes.
"""

from typing import Optional, Sequence, Tuple

from builtin_interfaces.msg import Time as Stamp
from geometry_msgs.msg import PoseStamped, Quaternion
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.qos import qos_profile_sensor_data
from rclpy.time import Time
from sonard_client import PosePublisher
from sonard_client.ros2_messages import transform
from std_msgs.msg import Header
from tf2_ros import Buffer, TransformBroadcaster, TransformException, TransformListener

from . import parameters
from .messages import message
from .parameter import declare
from .running import run

_COMPLAINT_EVERY_S = 10.0


def _nanoseconds(stamp: Stamp) -> int:
    return stamp.sec * 10**9 + stamp.nanosec


def _xyz(vector) -> Tuple[float, float, float]:
    """The components of a Vector3 or a Point."""
    return vector.x, vector.y, vector.z


class PoseBridge(Node):
    """Raises ValueError if a parameter (parameters.POSE_BRIDGE) is invalid."""

    def __init__(self) -> None:
        super().__init__("pose_bridge")
        self._options = declare(self, parameters.POSE_BRIDGE)
        self._poses = PosePublisher(self._options.host, self._options.port)
        self._last_stamp_ns: Optional[int] = None  # used for source tf
        publishes = self._options.publish_tf and self._options.source != "tf"
        self._broadcaster = TransformBroadcaster(self) if publishes else None
        # Best effort with a short queue fits the quality of service of any publisher, and an old pose is useless.
        if self._options.source == "odometry":
            self.create_subscription(Odometry, self._options.topic, self._on_odometry, qos_profile_sensor_data)
        elif self._options.source == "pose":
            self.create_subscription(PoseStamped, self._options.topic, self._on_pose, qos_profile_sensor_data)
        else:
            self._buffer = Buffer()
            self._listener = TransformListener(self._buffer, self)
            self.create_timer(1.0 / self._options.rate_hz, self._on_timer)
        self.get_logger().info(f"poses of {self._source()} go to {self._options.host}:{self._options.port}")

    def destroy_node(self) -> None:
        self._poses.close()
        super().destroy_node()

    def _source(self) -> str:
        if self._options.source == "tf":
            return f"{self._options.base_frame} in {self._options.world_frame}, by tf,"
        return str(self._options.topic)

    def _on_odometry(self, odometry: Odometry) -> None:
        twist = odometry.twist.twist
        self._send(odometry.header, _xyz(odometry.pose.pose.position), odometry.pose.pose.orientation, _xyz(twist.linear),
                   _xyz(twist.angular))

    def _on_pose(self, pose: PoseStamped) -> None:
        self._send(pose.header, _xyz(pose.pose.position), pose.pose.orientation)

    def _on_timer(self) -> None:
        try:
            found = self._buffer.lookup_transform(self._options.world_frame, self._options.base_frame, Time())
        except TransformException as error:
            self._complain(str(error))
            return
        stamp_ns = _nanoseconds(found.header.stamp)
        if stamp_ns != self._last_stamp_ns:  # tf may have no newer transform than last time
            self._last_stamp_ns = stamp_ns
            self._send(found.header, _xyz(found.transform.translation), found.transform.rotation)

    def _send(self, header: Header, position_m: Sequence[float], orientation: Quaternion,
              linear_mps: Optional[Sequence[float]] = None, angular_radps: Optional[Sequence[float]] = None) -> None:
        time_ns = _nanoseconds(header.stamp)
        if header.frame_id != self._options.world_frame:
            self._complain(f"frame_id is '{header.frame_id}', expected '{self._options.world_frame}' (parameter world_frame)")
            return
        if time_ns == 0:
            self._complain("the stamp is 0: its publisher must fill in the time")
            return
        quaternion_xyzw = (orientation.x, orientation.y, orientation.z, orientation.w)
        try:
            self._poses.send(time_ns, position_m, quaternion_xyzw, linear_mps, angular_radps, self._options.axes)
        except (OSError, ValueError) as error:
            self._complain(str(error))
            return
        if self._broadcaster:
            self._broadcaster.sendTransform(message(transform(time_ns, header.frame_id, self._options.base_frame, position_m,
                                                              quaternion_xyzw)))

    def _complain(self, why: str) -> None:
        self.get_logger().error(f"no pose is sent: {why}", throttle_duration_sec=_COMPLAINT_EVERY_S)


def main() -> int:
    return run(PoseBridge)
