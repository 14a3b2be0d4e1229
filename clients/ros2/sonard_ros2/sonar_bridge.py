# SPDX-License-Identifier: Apache-2.0
"""A node that is a client of one head, emulated or real, and publishes its pings.

    ros2 run sonard_ros2 sonar_bridge --ros-args -p type:=gemini -p range_m:=20.0

Topics: `sonar` (marine_acoustic_msgs/ProjectedSonarImage) and `points` (sensor_msgs/PointCloud2) of each ping or line;
`range` (sensor_msgs/Range) of each ping of an echo sounder; `range_image` (sensor_msgs/Image) of each shot of a Sonar 3D-15,
which has no `sonar`;
`image` (sensor_msgs/Image), and `scan` (sensor_msgs/LaserScan) of a scanning head, of each ping or turn; `calibration`
(sensor_msgs/CameraInfo) of the image when it changes, for late subscribers, too.
"""

import math
import threading
import traceback

from marine_acoustic_msgs.msg import ProjectedSonarImage
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from sensor_msgs.msg import CameraInfo, Image, LaserScan, PointCloud2, Range
from sonard_client import NoHead, NoPing, Ping, Shot, Sounding
from sonard_client import ros2_messages as contents
from sonard_client.turn import TurnCollector
from tf2_ros import StaticTransformBroadcaster

from . import parameters
from .heads import HEADS
from .messages import message
from .parameter import declare
from .running import run

_QUEUE = 5  # messages; reliable, which fits any subscriber
_LATCHED = QoSProfile(depth=1, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL)
_RETRY_S = 1.0
_COMPLAINT_EVERY_S = 10.0
_END_S = 1.0


class SonarBridge(Node):
    """Its own thread talks to the head. Raises ValueError if a parameter (parameters.SONAR_BRIDGE) is invalid."""

    def __init__(self) -> None:
        super().__init__("sonar_bridge")
        self._options = options = declare(self, parameters.SONAR_BRIDGE)
        if options.device:
            self.get_logger().warning(f"parameter device is now type: use type:={options.device}")
        self._head = HEADS[options.device or options.type]
        self._echoes = contents.EchoFilter(options.threshold_percent, options.min_range_m)
        self._turn = TurnCollector(math.radians(options.step_deg)) if self._head.IS_SCANNING else None
        self._turn_ns = None  # stamp of the last turn
        self._topics = {"points": self.create_publisher(PointCloud2, "points", _QUEUE),
                        "image": self.create_publisher(Image, "image", _QUEUE)}
        if self._head is HEADS["sonar3d15"]:
            self._topics["range_image"] = self.create_publisher(Image, "range_image", _QUEUE)
        else:
            self._topics["sonar"] = self.create_publisher(ProjectedSonarImage, "sonar", _QUEUE)
        if self._head is HEADS["ping1d"]:
            self._topics["range"] = self.create_publisher(Range, "range", _QUEUE)
        if self._turn:
            self._topics["scan"] = self.create_publisher(LaserScan, "scan", _QUEUE)
        self._calibration = self.create_publisher(CameraInfo, "calibration", _LATCHED)
        self._calibrated = None  # parameters of the published calibration
        self._broadcaster = StaticTransformBroadcaster(self)
        self._broadcaster.sendTransform([message(one) for one in self._static_transforms()])
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._talk, daemon=True)
        self._thread.start()

    def destroy_node(self) -> None:
        """A thread that waits for a silent head ends with the process; it does not use the node any more."""
        self._ended.set()
        self._thread.join(_END_S)
        super().destroy_node()

    def _static_transforms(self) -> list:
        options, now_ns = self._options, self.get_clock().now().nanoseconds
        transforms = [contents.beams_transform(now_ns, options.frame_id)]
        if options.parent_frame:
            transforms.append(contents.transform(now_ns, options.parent_frame, options.frame_id, options.mount_position_m,
                                                 contents.quaternion_xyzw(options.mount_rpy_deg)))
        return transforms

    def _talk(self) -> None:
        """Retries until the end, because heads may restart."""
        while self._running():
            try:
                self._pass_on_pings()
            except (NoHead, NoPing, OSError) as error:
                self._complain(str(error))
            except Exception:  # a fault of this program; without this line, the node would seem to work
                self._complain(traceback.format_exc())
            self._ended.wait(_RETRY_S)

    def _running(self) -> bool:
        """False after ROS was shut down, when nothing may be published or logged."""
        return not self._ended.is_set() and self.context.ok()

    def _complain(self, why: str) -> None:
        if self._running():
            self.get_logger().error(f"no ping is published: {why}", throttle_duration_sec=_COMPLAINT_EVERY_S)

    def _pass_on_pings(self) -> None:
        with self._head.connected(self._options) as (name, pings):
            if self._running():
                self.get_logger().info(f"pings of {name}")
            for ping in pings:
                if not self._running():
                    return
                if isinstance(ping, Shot):
                    self._pass_on_shot(ping, self._transmit_ns(ping.range_m))
                else:
                    self._pass_on(ping, self._transmit_ns(ping.ranges_m[-1]))

    def _pass_on(self, ping: Ping, time_ns: int) -> None:
        frame_id = self._options.frame_id
        self._offer("sonar", contents.projected_sonar_image, ping, time_ns, frame_id)
        self._offer("points", contents.points, ping, time_ns, frame_id, self._echoes)
        if isinstance(ping, Sounding):
            self._offer("range", contents.distance, ping, time_ns, frame_id)
        picture = self._turn.add(ping) if self._turn else ping
        if picture is None:
            return
        self._calibrate(contents.calibration(picture, time_ns, frame_id))
        self._offer("image", contents.image, picture, time_ns, frame_id)
        if self._turn:
            seconds = 0.0 if self._turn_ns is None else (time_ns - self._turn_ns) * 1e-9
            self._offer("scan", contents.scan, picture, time_ns, frame_id, self._echoes, seconds)
            self._turn_ns = time_ns

    def _pass_on_shot(self, shot: Shot, time_ns: int) -> None:
        frame_id = self._options.frame_id
        self._offer("points", contents.shot_points, shot, time_ns, frame_id)
        self._calibrate(contents.shot_calibration(shot, time_ns, frame_id))
        self._offer("range_image", contents.range_image, shot, time_ns, frame_id)
        self._offer("image", contents.signal_image, shot, time_ns, frame_id)

    def _offer(self, topic: str, make, *arguments) -> None:
        """Makes and publishes a message if somebody listens."""
        if self._topics[topic].get_subscription_count():
            self._topics[topic].publish(message(make(*arguments)))

    def _calibrate(self, calibration: contents.Content) -> None:
        parameters_of_image = calibration.fields["height"], calibration.fields["d"].tobytes()
        if parameters_of_image != self._calibrated:
            self._calibration.publish(message(calibration))
            self._calibrated = parameters_of_image

    def _transmit_ns(self, last_m: float) -> int:
        """The transmit time as a client can estimate it: now, less the travel time of sound to the last range and back. The
        delay of the network is not known."""
        travel_ns = round(2e9 * float(last_m) / self._options.sound_speed_mps)
        return max(0, self.get_clock().now().nanoseconds - travel_ns)


def main() -> int:
    return run(SonarBridge)
