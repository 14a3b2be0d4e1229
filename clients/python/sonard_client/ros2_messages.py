# SPDX-License-Identifier: Apache-2.0
"""The contents of ROS 2 messages of pings, without ROS. The nodes of clients/ros2 publish them, to_rosbag writes them.

Times are nanoseconds. Frames follow REP-103: x ahead, y to port, z up.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Sequence

import numpy as np

from .ping import Array, Ping
from .ping1d import Sounding
from .sonar3d15 import Shot

_DTYPE_UINT8, _DTYPE_UINT16 = 0, 2  # constants of marine_acoustic_msgs/SonarImageData
_FLOAT32 = 7  # constant of sensor_msgs/PointField
_ULTRASOUND = 0  # constant of sensor_msgs/Range


@dataclass(frozen=True)
class Content:
    """The fields of a message of type `kind`; those that are left out have their defaults. Values: numbers, texts, arrays of
    NumPy in the type of the field, contents, lists of contents."""

    kind: str
    fields: dict[str, Any]


def content(kind: str, **fields: Any) -> Content:
    return Content(kind, fields)


def time(time_ns: int) -> Content:
    return content("builtin_interfaces/Time", sec=time_ns // 10**9, nanosec=time_ns % 10**9)


def _header(time_ns: int, frame_id: str) -> Content:
    return content("std_msgs/Header", stamp=time(time_ns), frame_id=frame_id)


def _vector(x: float, y: float, z: float) -> Content:
    return content("geometry_msgs/Vector3", x=float(x), y=float(y), z=float(z))


def _bytes(samples: Array) -> Array:
    """The samples as little-endian bytes, row after row."""
    return np.frombuffer(samples.astype(samples.dtype.newbyteorder("<")).tobytes(), np.uint8)


def clock(time_ns: int) -> Content:
    return content("rosgraph_msgs/Clock", clock=time(time_ns))


def transform(time_ns: int, frame_id: str, child_frame_id: str, position_m: Sequence[float],
              quaternion_xyzw: Sequence[float]) -> Content:
    """A geometry_msgs/TransformStamped."""
    rotation = content("geometry_msgs/Quaternion", **{name: float(value) for name, value in zip("xyzw", quaternion_xyzw)})
    return content("geometry_msgs/TransformStamped", header=_header(time_ns, frame_id), child_frame_id=child_frame_id,
                   transform=content("geometry_msgs/Transform", translation=_vector(*position_m), rotation=rotation))


def quaternion_xyzw(rpy_deg: Sequence[float]) -> tuple[float, float, float, float]:
    """The rotation Rz(yaw) Ry(pitch) Rx(roll), as in URDF and in `mount` of sonard's configuration."""
    (sr, cr), (sp, cp), (sy, cy) = ((math.sin(math.radians(angle) / 2), math.cos(math.radians(angle) / 2)) for angle in rpy_deg)
    return (sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy)


def beams_frame(frame_id: str) -> str:
    """The name of the frame in which ProjectedSonarImage has the beams of a head whose frame is `frame_id`."""
    return frame_id + "_beams"


def beams_transform(time_ns: int, frame_id: str) -> Content:
    """The frame of ProjectedSonarImage, z ahead, x up and y to starboard, in the head's frame: half a turn about the line
    between x and z, which exchanges x and z."""
    return transform(time_ns, frame_id, beams_frame(frame_id), (0, 0, 0), (math.sqrt(0.5), 0, math.sqrt(0.5), 0))


def distance(ping: Sounding, time_ns: int, frame_id: str) -> Content:
    """A sensor_msgs/Range. Without an echo it is infinite (REP-117)."""
    half_m = (ping.ranges_m[-1] - ping.ranges_m[0]) / max(2 * (len(ping.ranges_m) - 1), 1)
    return content("sensor_msgs/Range", header=_header(time_ns, frame_id), radiation_type=_ULTRASOUND,
                   field_of_view=float(ping.beamwidth_rad), min_range=float(ping.ranges_m[0] - half_m),
                   max_range=float(ping.ranges_m[-1] + half_m),
                   range=float(ping.distance_m) if ping.confidence_percent > 0 else math.inf)


def projected_sonar_image(ping: Ping, time_ns: int, frame_id: str) -> Content:
    """A ping of any head, or a line of a scanning head as an image of one beam."""
    beams = len(ping.bearings_rad)

    def widths(width_rad: float) -> Array:
        return np.full(beams if width_rad else 0, width_rad, np.float32)

    return content(
        "marine_acoustic_msgs/ProjectedSonarImage", header=_header(time_ns, beams_frame(frame_id)),
        ping_info=content("marine_acoustic_msgs/PingInfo", frequency=float(ping.frequency_hz),
                          sound_speed=float(ping.sound_speed_mps), tx_beamwidths=widths(ping.vertical_beamwidth_rad),
                          rx_beamwidths=widths(ping.beamwidth_rad)),
        beam_directions=[_vector(0, -math.sin(bearing), math.cos(bearing)) for bearing in ping.bearings_rad],
        ranges=ping.ranges_m.astype(np.float32),
        # Data has all beams of the nearest range, then all beams of the next.
        image=content("marine_acoustic_msgs/SonarImageData", is_bigendian=False, beam_count=beams, data=_bytes(ping.samples),
                      dtype=_DTYPE_UINT16 if ping.samples.itemsize == 2 else _DTYPE_UINT8))


def image(ping: Ping, time_ns: int, frame_id: str) -> Content:
    """A sensor_msgs/Image with a row for each range, the nearest first, and a column for each beam, port first."""
    height, width = ping.samples.shape
    return content("sensor_msgs/Image", header=_header(time_ns, frame_id), height=height, width=width, is_bigendian=0,
                   encoding="mono16" if ping.samples.itemsize == 2 else "mono8", step=width * ping.samples.itemsize,
                   data=_bytes(ping.samples))


def calibration(ping: Ping, time_ns: int, frame_id: str) -> Content:
    """A sensor_msgs/CameraInfo that says where each pixel of image() is. `k` stays 0, as for a camera that is not calibrated:
    no pinhole draws this image. `d` holds the range of the first row and from row to row, in metres, the speed of sound in m/s
    and the frequency in Hz, then the bearing of each column in radians, positive to port."""
    first_m, step_m = float(ping.ranges_m[0]), float(ping.ranges_m[-1] - ping.ranges_m[0]) / max(1, len(ping.ranges_m) - 1)
    parameters = np.array([first_m, step_m, ping.sound_speed_mps, ping.frequency_hz, *ping.bearings_rad])
    return content("sensor_msgs/CameraInfo", header=_header(time_ns, frame_id), height=ping.samples.shape[0],
                   width=ping.samples.shape[1], distortion_model="sonar_polar", d=parameters)


@dataclass(frozen=True)
class EchoFilter:
    """Which samples are echoes: those of at least `threshold_percent` of full scale, from `min_range_m` on. A Ping360 hears its
    own ringing up to 0.75 m. A sample of 0 is no echo."""

    threshold_percent: float = 30.0
    min_range_m: float = 0.75

    def passed(self, ping: Ping) -> Array:
        """The samples; those that are no echo are 0."""
        least = max(1, math.ceil(np.iinfo(ping.samples.dtype).max * self.threshold_percent / 100))
        return np.where((ping.samples >= least) & (ping.ranges_m >= self.min_range_m)[:, None], ping.samples, 0)


def points(ping: Ping, time_ns: int, frame_id: str, echoes: EchoFilter) -> Content:
    """A sensor_msgs/PointCloud2 of the echoes, row after row: x, y, z in metres, on the axis of the fan, and the sample as
    intensity."""
    rows, beams = np.nonzero(echoes.passed(ping))
    ranges_m, bearings_rad = ping.ranges_m[rows], ping.bearings_rad[beams]
    table = np.zeros((len(rows), 4), "<f4")
    table[:, 0], table[:, 1] = ranges_m * np.cos(bearings_rad), ranges_m * np.sin(bearings_rad)
    table[:, 3] = ping.samples[rows, beams]
    return _cloud(table, time_ns, frame_id)


def _cloud(table: Array, time_ns: int, frame_id: str) -> Content:
    """A sensor_msgs/PointCloud2 with a point for each row of `table`."""
    fields = [content("sensor_msgs/PointField", name=name, offset=4 * place, datatype=_FLOAT32, count=1)
              for place, name in enumerate(("x", "y", "z", "intensity"))]
    return content("sensor_msgs/PointCloud2", header=_header(time_ns, frame_id), height=1, width=len(table), fields=fields,
                   is_bigendian=False, point_step=16, row_step=16 * len(table), is_dense=True,
                   data=np.frombuffer(table.tobytes(), np.uint8))


def shot_points(shot: Shot, time_ns: int, frame_id: str) -> Content:
    """A sensor_msgs/PointCloud2 of the directions with an echo, with the signal as intensity."""
    table = np.column_stack([shot.points_m(), shot.signals[shot.ranges_m > 0]]).astype("<f4")
    return _cloud(table, time_ns, frame_id)


def range_image(shot: Shot, time_ns: int, frame_id: str) -> Content:
    """A sensor_msgs/Image of ranges in metres along each direction; NaN: no echo. The first row is the highest."""
    return _shot_image(np.where(shot.ranges_m > 0, shot.ranges_m, np.nan).astype("<f4"), "32FC1", time_ns, frame_id)


def signal_image(shot: Shot, time_ns: int, frame_id: str) -> Content:
    """A sensor_msgs/Image of the signals; 0: no echo. The first row is the highest."""
    return _shot_image(shot.signals, "mono8", time_ns, frame_id)


def _shot_image(pixels: Array, encoding: str, time_ns: int, frame_id: str) -> Content:
    height, width = pixels.shape
    return content("sensor_msgs/Image", header=_header(time_ns, frame_id), height=height, width=width, is_bigendian=0,
                   encoding=encoding, step=width * pixels.itemsize, data=_bytes(pixels[::-1]))


def shot_calibration(shot: Shot, time_ns: int, frame_id: str) -> Content:
    """A sensor_msgs/CameraInfo of both images. `d` holds the speed of sound in m/s, then the bearing of each column, positive
    to port, and the elevation of each row, from the first, in radians."""
    height, width = shot.signals.shape
    parameters = np.concatenate([[shot.sound_speed_mps], shot.bearings_rad, shot.elevations_rad[::-1]])
    return content("sensor_msgs/CameraInfo", header=_header(time_ns, frame_id), height=height, width=width,
                   distortion_model="sonar_directions", d=parameters)


def scan(turn: Ping, time_ns: int, frame_id: str, echoes: EchoFilter, scan_time_s: float) -> Content:
    """A sensor_msgs/LaserScan of a turn with evenly spaced bearings, port first: the range of the strongest echo at each
    bearing, from starboard to port, and its sample as intensity. Where there is no echo, the range is infinite."""
    samples, bearings_rad = echoes.passed(turn)[:, ::-1], turn.bearings_rad[::-1]
    rows = samples.argmax(axis=0)
    strongest = samples[rows, np.arange(samples.shape[1])]
    return content("sensor_msgs/LaserScan", header=_header(time_ns, frame_id), angle_min=float(bearings_rad[0]),
                   angle_max=float(bearings_rad[-1]), angle_increment=2 * math.pi / len(bearings_rad),
                   scan_time=float(scan_time_s), range_min=float(echoes.min_range_m),
                   range_max=float(turn.ranges_m[-1] + turn.ranges_m[0]),
                   ranges=np.where(strongest > 0, turn.ranges_m[rows], np.inf).astype(np.float32),
                   intensities=strongest.astype(np.float32))
