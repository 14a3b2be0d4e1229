# SPDX-License-Identifier: Apache-2.0
"""Encodes contents of ROS 2 messages as ROS 2 does on the wire and in bags: CDR of OMG's DDS-XTypes, little-endian."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np

from .ros2_messages import Content

# The types of messages in a bag, as ROS 2 (Humble to Jazzy) and marine_acoustic_msgs publish them.
DEFINITIONS = {
    "builtin_interfaces/Time": "int32 sec\nuint32 nanosec",
    "std_msgs/Header": "builtin_interfaces/Time stamp\nstring frame_id",
    "geometry_msgs/Vector3": "float64 x\nfloat64 y\nfloat64 z",
    "geometry_msgs/Quaternion": "float64 x 0\nfloat64 y 0\nfloat64 z 0\nfloat64 w 1",
    "geometry_msgs/Transform": "geometry_msgs/Vector3 translation\ngeometry_msgs/Quaternion rotation",
    "geometry_msgs/TransformStamped": "std_msgs/Header header\nstring child_frame_id\ngeometry_msgs/Transform transform",
    "tf2_msgs/TFMessage": "geometry_msgs/TransformStamped[] transforms",
    "rosgraph_msgs/Clock": "builtin_interfaces/Time clock",
    "sensor_msgs/PointField": "\n".join(f"uint8 {name}={number}" for number, name in enumerate(
        ("INT8", "UINT8", "INT16", "UINT16", "INT32", "UINT32", "FLOAT32", "FLOAT64"), 1)) +
    "\nstring name\nuint32 offset\nuint8 datatype\nuint32 count",
    "sensor_msgs/PointCloud2": "std_msgs/Header header\nuint32 height\nuint32 width\nsensor_msgs/PointField[] fields\n"
    "bool is_bigendian\nuint32 point_step\nuint32 row_step\nuint8[] data\nbool is_dense",
    "marine_acoustic_msgs/PingInfo": "float32 frequency\nfloat32 sound_speed\nfloat32[] tx_beamwidths\nfloat32[] rx_beamwidths",
    "marine_acoustic_msgs/SonarImageData": "bool is_bigendian\n" + "\n".join(
        f"uint32 DTYPE_{name}={number}" for number, name in enumerate(
            ("UINT8", "INT8", "UINT16", "INT16", "UINT32", "INT32", "UINT64", "INT64", "FLOAT32", "FLOAT64"))) +
    "\nuint32 dtype\nuint32 beam_count\nuint8[] data",
    "marine_acoustic_msgs/ProjectedSonarImage": "std_msgs/Header header\nmarine_acoustic_msgs/PingInfo ping_info\n"
    "geometry_msgs/Vector3[] beam_directions\nfloat32[] ranges\nmarine_acoustic_msgs/SonarImageData image",
}
_FORMATS = {"bool": "?", "uint8": "B", "int32": "i", "uint32": "I", "float32": "f", "float64": "d"}


def _fields(kind: str) -> list[tuple[str, str]]:
    """Type and name of the fields, without constants."""
    lines = [line.split() for line in DEFINITIONS[kind].split("\n") if "=" not in line]
    return [(words[0], words[1]) for words in lines]


def schema(kind: str) -> str:
    """The definition of a type and of all types in it, as bags hold it."""
    found = [kind]
    for one in found:
        for field, _ in _fields(one):
            its_kind = field.replace("[]", "")
            if its_kind in DEFINITIONS and its_kind not in found:
                found.append(its_kind)
    others = [f"{80 * '='}\nMSG: {one}\n{DEFINITIONS[one]}\n" for one in found[1:]]
    return DEFINITIONS[kind] + "\n" + "".join(others)


def encode(content: Content) -> bytes:
    """A message with its encapsulation header. All fields must be given."""
    data = bytearray()
    _add(data, content.kind, content)
    return b"\0\1\0\0" + bytes(data)


def _add(data: bytearray, kind: str, value: Any) -> None:
    if kind.endswith("[]"):
        _add(data, "uint32", len(value))
        _add_elements(data, kind[:-2], value)
    elif kind == "string":
        text = value.encode() + b"\0"
        _add(data, "uint32", len(text))
        data += text
    elif kind in _FORMATS:
        _align(data, struct.calcsize(_FORMATS[kind]))
        data += struct.pack("<" + _FORMATS[kind], value)
    else:
        fields = _fields(kind)
        if value.kind != kind or {name for _, name in fields} != set(value.fields):
            raise ValueError(f"{value.kind} with the fields {sorted(value.fields)} is no whole {kind}")
        for its_kind, name in fields:
            _add(data, its_kind, value.fields[name])


def _add_elements(data: bytearray, kind: str, values: Any) -> None:
    if not isinstance(values, np.ndarray):
        for value in values:
            _add(data, kind, value)
    elif len(values):
        dtype = np.dtype(_FORMATS[kind]).newbyteorder("<")
        _align(data, dtype.itemsize)
        data += values.astype(dtype, casting="equiv").tobytes()


def _align(data: bytearray, size: int) -> None:
    data += bytes(-len(data) % size)
