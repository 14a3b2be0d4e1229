# SPDX-License-Identifier: Apache-2.0
"""A node that is a client of one head, emulated or real, and publishes its pings.

    ros2 run sonard_ros2 sonar_bridge --ros-args -p type:=gemini -p range_m:=20.0

Pings of a Gemini are published on `sonar` (marine_acoustic_msgs/ProjectedSonarImage) and `image` (sensor_msgs/Image),
lines of a Micron on `scan` (sensor_msgs/LaserScan).
"""

import threading
import traceback

from builtin_interfaces.msg import Time as Stamp
from marine_acoustic_msgs.msg import ProjectedSonarImage
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import Image, LaserScan
from sonard_client import Gemini, Micron, NoHead, NoPing, Ping
from tf2_ros import StaticTransformBroadcaster

from . import messages, parameters
from .running import run

_QUEUE = 5  # messages; reliable, which fits any subscriber
_RETRY_S = 1.0
_COMPLAINT_EVERY_S = 10.0
_END_S = 1.0


class SonarBridge(Node):
    """Its own thread talks to the head. Raises ValueError if a parameter (parameters.SONAR_BRIDGE) is invalid."""

    def __init__(self) -> None:
        super().__init__("sonar_bridge")
        self._options = parameters.declare(self, parameters.SONAR_BRIDGE)
        self._beams_frame_id = f"{self._options.frame_id}_beams"
        if self._options.device:
            self.get_logger().warning(f"parameter device is now type: use type:={self._options.device}")
        if (self._options.device or self._options.type) == "gemini":
            self._sonar = self.create_publisher(ProjectedSonarImage, "sonar", _QUEUE)
            self._image = self.create_publisher(Image, "image", _QUEUE)
            self._broadcaster = StaticTransformBroadcaster(self)
            self._broadcaster.sendTransform(messages.beams_frame(self.get_clock().now().to_msg(), self._options.frame_id,
                                                                 self._beams_frame_id))
            talk = self._talk_to_gemini
        else:
            self._scan = self.create_publisher(LaserScan, "scan", _QUEUE)
            talk = self._talk_to_micron
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._talk, args=(talk,), daemon=True)
        self._thread.start()

    def destroy_node(self) -> None:
        """A thread that waits for a silent head ends with the process; it does not use the node any more."""
        self._ended.set()
        self._thread.join(_END_S)
        super().destroy_node()

    def _talk(self, talk) -> None:
        """Retries until the end, because heads may restart."""
        while self._running():
            try:
                talk()
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

    def _talk_to_gemini(self) -> None:
        options = self._options
        with Gemini(options.sonar_id or None, options.local or None) as head:
            self._say_found(f"Gemini {head.status.sonar_id} at {head.status.address}")
            for ping in head.pings(options.interval_s, options.range_m, options.gain_percent, options.sound_speed_mps,
                                   options.compression, options.bits):
                if not self._running():
                    return
                stamp = self._transmit_stamp(ping)
                self._sonar.publish(messages.projected_sonar_image(ping, stamp, self._beams_frame_id, options.sound_speed_mps))
                self._image.publish(messages.image(ping, stamp, options.frame_id))

    def _talk_to_micron(self) -> None:
        options = self._options
        with Micron(options.micron_host, options.micron_port) as head:
            self._say_found(f"Micron at {options.micron_host}:{options.micron_port}")
            for line in head.lines(options.range_m, options.bins, options.step_deg, options.gain_percent,
                                   options.sound_speed_mps):
                if not self._running():
                    return
                self._scan.publish(messages.line_scan(line, self._transmit_stamp(line), options.frame_id))

    def _say_found(self, head: str) -> None:
        if self._running():
            self.get_logger().info(f"pings of {head}")

    def _transmit_stamp(self, ping: Ping) -> Stamp:
        """The transmit time as a client can estimate it: now, less the travel time of sound to the last bin and back. The
        delay of the network is not known."""
        travel_ns = round(2e9 * float(ping.ranges_m[-1]) / self._options.sound_speed_mps)
        return Time(nanoseconds=max(0, self.get_clock().now().nanoseconds - travel_ns)).to_msg()


def main() -> int:
    return run(SonarBridge)
