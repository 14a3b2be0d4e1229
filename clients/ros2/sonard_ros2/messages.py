# SPDX-License-Identifier: Apache-2.0
"""Converts pings to ROS 2 messages. `stamp` and `frame_id` are for the header.

Arrays are passed as array.array, which messages take unchanged. Messages check the numbers of any other sequence one by
one, and a ping has half a million.
"""

import math
from array import array
from typing import Iterable

from builtin_interfaces.msg import Time
from geometry_msgs.msg import TransformStamped, Vector3
from marine_acoustic_msgs.msg import ProjectedSonarImage, SonarImageData
from sensor_msgs.msg import Image, LaserScan
from sonard_client import Ping

# Of a Gemini 720i.
_FREQUENCY_HZ = 720e3
_VERTICAL_BEAMWIDTH_RAD = math.radians(20)
_HORIZONTAL_BEAMWIDTH_RAD = math.radians(1)


def _floats(numbers: Iterable[float]) -> "array[float]":
    return array("f", [float(number) for number in numbers])


def _little_endian(ping: Ping) -> "array[int]":
    """The samples as little-endian bytes, row after row."""
    return array("B", ping.samples.astype(ping.samples.dtype.newbyteorder("<")).tobytes())


def projected_sonar_image(ping: Ping, stamp: Time, frame_id: str, sound_speed_mps: float) -> ProjectedSonarImage:
    """A Gemini ping in the frame that ProjectedSonarImage defines: z ahead, x up, y to starboard (beams_frame())."""
    message = ProjectedSonarImage()
    message.header.stamp = stamp
    message.header.frame_id = frame_id
    beams = len(ping.bearings_rad)
    message.ping_info.frequency = _FREQUENCY_HZ
    message.ping_info.sound_speed = float(sound_speed_mps)
    message.ping_info.tx_beamwidths = _floats([_VERTICAL_BEAMWIDTH_RAD] * beams)
    message.ping_info.rx_beamwidths = _floats([_HORIZONTAL_BEAMWIDTH_RAD] * beams)
    message.beam_directions = [Vector3(x=0.0, y=-math.sin(bearing_rad), z=math.cos(bearing_rad))
                               for bearing_rad in ping.bearings_rad]
    message.ranges = _floats(ping.ranges_m)
    message.image.is_bigendian = False
    message.image.dtype = SonarImageData.DTYPE_UINT16 if ping.samples.itemsize == 2 else SonarImageData.DTYPE_UINT8
    message.image.beam_count = beams
    message.image.data = _little_endian(ping)  # all beams of the nearest range, then all beams of the next
    return message


def beams_frame(stamp: Time, frame_id: str, beams_frame_id: str) -> TransformStamped:
    """The frame of ProjectedSonarImage in the head's frame of REP-103: half a turn about the line between x and z, which
    exchanges x and z."""
    transform = TransformStamped()
    transform.header.stamp = stamp
    transform.header.frame_id = frame_id
    transform.child_frame_id = beams_frame_id
    rotation = transform.transform.rotation
    rotation.x, rotation.y, rotation.z, rotation.w = math.sqrt(0.5), 0.0, math.sqrt(0.5), 0.0
    return transform


def image(ping: Ping, stamp: Time, frame_id: str) -> Image:
    """An image with a row for each range, the nearest first, and a column for each beam, port first."""
    message = Image()
    message.header.stamp = stamp
    message.header.frame_id = frame_id
    message.height, message.width = (int(size) for size in ping.samples.shape)
    message.encoding = "mono16" if ping.samples.itemsize == 2 else "mono8"
    message.is_bigendian = 0
    message.step = message.width * ping.samples.itemsize
    message.data = _little_endian(ping)
    return message


def line_scan(line: Ping, stamp: Time, frame_id: str) -> LaserScan:
    """A line of a scanning head. All "rays" have the line's bearing, because angle_increment is 0. `ranges` are the middles
    of the bins, and `intensities` are their samples, so RViz shows each bin as a point at its position."""
    message = LaserScan()
    message.header.stamp = stamp
    message.header.frame_id = frame_id
    message.angle_min = message.angle_max = float(line.bearings_rad[0])
    message.range_max = float(line.ranges_m[-1] + line.ranges_m[0])  # the far end of the last bin
    message.ranges = _floats(line.ranges_m)
    message.intensities = _floats(line.samples[:, 0])
    return message
