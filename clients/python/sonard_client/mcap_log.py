# SPDX-License-Identifier: Apache-2.0
"""Pings of sonard's .mcap logs. The container is that of mcap.dev/spec, messages those of protocol/log/sonard_log.proto, whose
field numbers stand below; the wire format is Protocol Buffers'."""

from __future__ import annotations

import struct
from typing import Any, Iterator

import numpy as np

from .ping import Array, LoggedPing

MAGIC = b"\x89MCAP0\r\n"
_SCHEMA, _CHANNEL, _MESSAGE, _CHUNK = 3, 4, 5, 6


def pings(file: Any, path: Any) -> Iterator[LoggedPing]:
    """`path` is for messages."""
    file.read(len(MAGIC))
    schemas: dict[int, str] = {}
    channels: dict[int, int] = {}
    for kind, body in _records_of_file(file):
        for kind, body in _records_of_chunk(body, path) if kind == _CHUNK else [(kind, body)]:
            if kind == _SCHEMA:
                schemas[struct.unpack_from("<H", body)[0]] = _text(body, 2)
            elif kind == _CHANNEL:
                number, schema = struct.unpack_from("<HH", body)
                channels[number] = schema
            elif kind == _MESSAGE:
                schema_name = schemas.get(channels.get(struct.unpack_from("<H", body)[0], 0), "")
                if schema_name in _MAKERS:
                    yield _MAKERS[schema_name](_fields(body[22:]))


def _records_of_file(file: Any) -> Iterator[tuple[int, bytes]]:
    """Until the end, or the record that is being written."""
    while len(head := file.read(9)) == 9:
        kind, length = struct.unpack("<BQ", head)
        body = file.read(length)
        if len(body) < length:
            return
        yield kind, body


def _records_of_chunk(body: bytes, path: Any) -> Iterator[tuple[int, bytes]]:
    compression = _text(body, 28)
    at = 32 + len(compression)
    data = body[at + 8: at + 8 + struct.unpack_from("<Q", body, at)[0]]
    if compression == "zstd":
        try:
            import zstandard
        except ImportError as error:
            raise ValueError(f"{path} is compressed: pip install zstandard") from error
        data = zstandard.ZstdDecompressor().decompress(data, struct.unpack_from("<Q", body, 16)[0])
    elif compression:
        raise ValueError(f"{path} is compressed by '{compression}', which sonard does not write")
    at = 0
    while at + 9 <= len(data):
        kind, length = struct.unpack_from("<BQ", data, at)
        if at + 9 + length > len(data):
            raise ValueError(f"{path} is damaged: a record runs beyond its chunk")
        yield kind, data[at + 9: at + 9 + length]
        at += 9 + length


def _text(body: bytes, at: int) -> str:
    (length,) = struct.unpack_from("<I", body, at)
    return body[at + 4: at + 4 + length].decode()


def _varint(data: bytes, at: int) -> tuple[int, int]:
    value = shift = 0
    while True:
        value |= (data[at] & 0x7F) << shift
        at += 1
        if data[at - 1] < 0x80:
            return value, at
        shift += 7


def _fields(data: bytes) -> dict[int, Any]:
    """The last value of each field: an int, a float of 8 bytes, or bytes."""
    fields: dict[int, Any] = {}
    at = 0
    while at < len(data):
        tag, at = _varint(data, at)
        if tag & 7 == 0:
            fields[tag >> 3], at = _varint(data, at)
        elif tag & 7 == 1:
            (fields[tag >> 3],) = struct.unpack_from("<d", data, at)
            at += 8
        elif tag & 7 == 2:
            length, at = _varint(data, at)
            fields[tag >> 3] = data[at: at + length]
            at += length
        else:
            raise ValueError(f"a message has a field of wire type {tag & 7}")
    return fields


def _numbers(data: bytes, order: tuple[int, ...]) -> Array:
    """Fields of a Vector3 or Quaternion; those that are 0 are left out of the message."""
    values = _fields(data)
    return np.array([values.get(number, 0.0) for number in order])


def _ranges_m(first_m: float, step_m: float, count: int) -> Array:
    return first_m + (np.arange(count) + 0.5) * step_m


def _multibeam_ping(image: dict[int, Any]) -> LoggedPing:
    """SonarImage."""
    rows, beams = image.get(5, 0), image.get(6, 0)
    return LoggedPing(samples=np.frombuffer(image.get(7, b""), np.uint8).reshape(rows, beams),
                      ranges_m=_ranges_m(image.get(9, 0.0), image.get(10, 0.0), rows),
                      bearings_rad=np.frombuffer(image.get(8, b""), "<f8"), transmit_us=None,
                      head=image.get(1, b"").decode(), time_ns=image.get(4, 0), sonar_position_m=_numbers(_fields(image.get(15, b"")).get(1, b""), (1, 2, 3)),
                      sonar_quaternion_xyzw=_numbers(_fields(image.get(15, b"")).get(2, b""), (2, 3, 4, 1)))


def _scan_line(line: dict[int, Any]) -> LoggedPing:
    """ScanLine."""
    bins = np.frombuffer(line.get(6, b""), np.uint8)
    return LoggedPing(samples=bins[:, None], ranges_m=_ranges_m(line.get(7, 0.0), line.get(8, 0.0), bins.size),
                      bearings_rad=np.array([line.get(5, 0.0)]), transmit_us=None,
                      head=line.get(1, b"").decode(), time_ns=line.get(4, 0), sonar_position_m=_numbers(_fields(line.get(13, b"")).get(1, b""), (1, 2, 3)),
                      sonar_quaternion_xyzw=_numbers(_fields(line.get(13, b"")).get(2, b""), (2, 3, 4, 1)))


_MAKERS = {"sonard.log.SonarImage": _multibeam_ping, "sonard.log.ScanLine": _scan_line}
