# SPDX-License-Identifier: Apache-2.0
"""Reads pings of sonard's .mcap logs. The container is specified at mcap.dev/spec, the messages in
protocol/log/sonard_log.proto, whose field numbers are used below; the wire format is Protocol Buffers."""

from __future__ import annotations

import re
import struct
import zlib
from typing import Any, Iterator, Optional

import numpy as np

from .damage import warn, warn_of_bytes
from .ping import Array, LoggedPing

MAGIC = b"\x89MCAP0\r\n"
_HEADER, _FOOTER, _SCHEMA, _CHANNEL, _MESSAGE, _CHUNK, _MESSAGE_INDEX, _ATTACHMENT, _STATISTICS, _METADATA, _DATA_END = (
    1, 2, 3, 4, 5, 6, 7, 9, 11, 12, 15)
# Fixed bytes of a record, and the number of fields with a length that follow them.
_FORMS = {_HEADER: (0, 2), _FOOTER: (20, 0), _SCHEMA: (2, 3), _CHANNEL: (4, 3), _MESSAGE_INDEX: (2, 1),
          _STATISTICS: (42, 1), _METADATA: (0, 2), _DATA_END: (4, 0)}
_AFTER_DATA = (_FOOTER, _STATISTICS, _DATA_END)
# The start of a chunk with a known compression, of a schema of sonard, and of a message index below 16 MiB.
_READABLE = re.compile(rb"\x06(?=.{36}(?:\x00{4}|\x04\x00{3}zstd|\x03\x00{3}lz4))|\x03(?=.{14}sonard\.log\.)"
                       rb"|\x07(?=.{3}\x00{5}.{5}\x00)", re.DOTALL)
_MOST_BYTES = 1 << 30  # of one chunk


class _Damaged(Exception):
    pass


def pings(data: Any, path: Any) -> Iterator[LoggedPing]:
    """`data` is the file as bytes or as a memory map; `path` is for messages."""
    yield from _Reader(data, path).pings()


class _Reader:
    """Reads a file record by record, and skips damaged parts."""

    def __init__(self, data: Any, path: Any) -> None:
        self._data, self._path = data, path
        self._schemas: dict[int, str] = {}
        self._channels: dict[int, int] = {}
        self._lost_chunk: Optional[tuple[int, int, str]] = None  # offset, size and reason; its message indexes may follow
        self._lost_messages: dict[int, int] = {}  # by channel, counted from these indexes

    def pings(self) -> Iterator[LoggedPing]:
        for kind, body in self._records():
            # Records in chunks have a checksum and come first, so they take precedence.
            if kind == _SCHEMA and len(body) >= 6:
                self._schemas.setdefault(struct.unpack_from("<H", body)[0], _text(body, 2))
            elif kind == _CHANNEL and len(body) >= 4:
                number, schema = struct.unpack_from("<HH", body)
                self._channels.setdefault(number, schema)
            elif kind == _MESSAGE and len(body) >= 22:
                schema_name = self._schema_of(struct.unpack_from("<H", body)[0])
                if schema_name in _MAKERS:
                    try:
                        ping = _MAKERS[schema_name](_fields(body[22:]))
                    except (IndexError, ValueError, struct.error) as error:
                        warn(self._path, f"a {schema_name} cannot be decoded ({error}); it is lost")
                    else:
                        yield ping

    def _schema_of(self, channel: int) -> str:
        return self._schemas.get(self._channels.get(channel, 0), "")

    def _records(self) -> Iterator[tuple[int, bytes]]:
        """Records outside and inside of chunks, up to the end of the data or an unfinished last record."""
        data = self._data
        at: Optional[int] = len(MAGIC)
        while at is not None and at < len(data):
            end = _end(data, at)
            try:
                if end is None:
                    raise _Damaged("a length beyond the end")
                if data[at] == _CHUNK:
                    if not _sizes_agree(data, at):
                        raise _Damaged("the length of a chunk")
                    self._tell_lost_chunk()
                    yield from _records_of_chunk(data[at + 9: end], self._path)
                elif _sizes_agree(data, at) or not (data[at] == _ATTACHMENT or _has_form(data, at, data[at])):
                    raise _Damaged(f"a record of type {data[at]}")
                elif data[at] in _AFTER_DATA:
                    break
                elif data[at] == _MESSAGE_INDEX:
                    self._count_lost(data[at + 9: end])
                else:
                    yield data[at], data[at + 9: end]
                at = end
            except _Damaged as why:
                at = self._behind_damage(at, end, str(why))
        self._tell_lost_chunk()

    def _behind_damage(self, at: int, end: Optional[int], why: str) -> Optional[int]:
        """Reports damage at `at`. Returns where to continue; None if there is no place."""
        self._tell_lost_chunk()
        data = self._data
        following = _next_readable(data, at, end)
        if following is None and end is None and not data[-len(MAGIC):] == MAGIC:
            return None  # the record is still being written
        size = (len(data) if following is None else following) - at
        if _was_chunk(data, at):
            self._lost_chunk = at, size, why
        else:
            warn_of_bytes(self._path, at, size, why, "no ping is lost" if following else "what follows is lost")
        return following

    def _count_lost(self, index: bytes) -> None:
        """Counts the messages of `index`, a message index, if its chunk is lost."""
        if self._lost_chunk is not None:
            channel, size = struct.unpack_from("<HI", index)
            self._lost_messages[channel] = self._lost_messages.get(channel, 0) + size // 16

    def _tell_lost_chunk(self) -> None:
        if self._lost_chunk is not None:
            count = sum(messages for channel, messages in self._lost_messages.items() if self._schema_of(channel) in _MAKERS)
            lost = ("its pings are lost" if not self._lost_messages else "no ping is lost" if not count else
                    "1 ping is lost" if count == 1 else f"{count} pings are lost")
            warn_of_bytes(self._path, *self._lost_chunk, lost)
        self._lost_chunk = None
        self._lost_messages = {}


def _end(data: Any, at: int) -> Optional[int]:
    """The end of the record at `at`; None if it is beyond the data."""
    if at + 9 > len(data):
        return None
    end: int = at + 9 + struct.unpack_from("<Q", data, at + 1)[0]
    return end if end <= len(data) else None


def _sizes_agree(data: Any, at: int) -> bool:
    """Whether the record has the inner sizes of a chunk, for any type byte."""
    end = _end(data, at)
    if end is None or end < at + 49:
        return False
    (name,) = struct.unpack_from("<I", data, at + 37)
    return bool(name <= end - at - 49 and at + 49 + name + struct.unpack_from("<Q", data, at + 41 + name)[0] == end)


def _has_form(data: Any, at: int, kind: int) -> bool:
    """Whether the lengths inside the record fit a record of this kind, for any type byte."""
    end = _end(data, at)
    if end is None or kind not in _FORMS:
        return False
    fixed, fields = _FORMS[kind]
    place = at + 9 + fixed
    for _ in range(fields):
        if place + 4 > end:
            return False
        place += 4 + struct.unpack_from("<I", data, place)[0]
    return place == end and (kind != _MESSAGE_INDEX or (end - at - 15) % 16 == 0)


def _was_chunk(data: Any, at: int) -> bool:
    """Whether an unreadable record is a chunk. Assumes that one bit is wrong, so its length or its type is right."""
    return _sizes_agree(data, at) or (data[at] == _CHUNK and not any(_has_form(data, at, kind) for kind in _FORMS))


def _next_readable(data: Any, at: int, end: Optional[int]) -> Optional[int]:
    """Where to continue: after the record if its content fits its length, which then is right; else at the next chunk,
    message index or schema."""
    if end is not None and (_sizes_agree(data, at) or any(_has_form(data, at, kind) for kind in _FORMS)):
        return end
    for match in _READABLE.finditer(data, at + 1):
        found = match.start()
        if _sizes_agree(data, found) if data[found] == _CHUNK else _has_form(data, found, data[found]):
            return found
    return None


def _records_of_chunk(body: bytes, path: Any) -> Iterator[tuple[int, bytes]]:
    if len(body) < 40:
        raise _Damaged("a chunk without its front")
    size, crc = struct.unpack_from("<QI", body, 16)
    (name,) = struct.unpack_from("<I", body, 28)
    at = 32 + name
    if at + 8 > len(body) or at + 8 + struct.unpack_from("<Q", body, at)[0] != len(body):
        raise _Damaged("sizes of a chunk")
    data = _unpacked(body[32: at], body[at + 8:], size, path)
    if crc not in (0, zlib.crc32(data)):
        raise _Damaged("the checksum of a chunk")
    at = 0
    while at < len(data):
        end = _end(data, at)
        if end is None:
            raise _Damaged("a record beyond its chunk")
        if crc == 0 and data[at] != _MESSAGE and not (data[at] in (_SCHEMA, _CHANNEL) and _has_form(data, at, data[at])):
            raise _Damaged(f"a record of type {data[at]} in a chunk")
        yield data[at], data[at + 9: end]
        at = end


def _unpacked(compression: bytes, data: bytes, size: int, path: Any) -> bytes:
    if compression == b"zstd":
        try:
            import zstandard
        except ImportError as error:
            raise ValueError(f"{path} is compressed: pip install zstandard") from error
        try:
            unpacked: bytes = zstandard.ZstdDecompressor().decompress(data, min(size, _MOST_BYTES))
        except (zstandard.ZstdError, MemoryError) as error:
            raise _Damaged("a chunk that does not unpack") from error
        return unpacked
    if compression == b"lz4":
        raise ValueError(f"{path} is compressed by 'lz4', which sonard does not write")
    if compression:
        raise _Damaged("the compression of a chunk")
    return data


def _text(body: bytes, at: int) -> str:
    (length,) = struct.unpack_from("<I", body, at)
    return body[at + 4: at + 4 + length].decode(errors="replace")


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
    """Fields of a Vector3 or Quaternion; a missing field is 0."""
    values = _fields(data)
    return np.array([values.get(number, 0.0) for number in order])


def _ranges_m(first_m: float, step_m: float, count: int) -> Array:
    return first_m + (np.arange(count) + 0.5) * step_m


def _multibeam_ping(image: dict[int, Any]) -> LoggedPing:
    """Decodes a SonarImage."""
    rows, beams = image.get(5, 0), image.get(6, 0)
    return LoggedPing(samples=np.frombuffer(image.get(7, b""), np.uint8).reshape(rows, beams),
                      ranges_m=_ranges_m(image.get(9, 0.0), image.get(10, 0.0), rows),
                      bearings_rad=np.frombuffer(image.get(8, b""), "<f8"), transmit_us=None,
                      head=image.get(1, b"").decode(), time_ns=image.get(4, 0), sonar_position_m=_numbers(_fields(image.get(15, b"")).get(1, b""), (1, 2, 3)),
                      sonar_quaternion_xyzw=_numbers(_fields(image.get(15, b"")).get(2, b""), (2, 3, 4, 1)))


def _scan_line(line: dict[int, Any]) -> LoggedPing:
    """Decodes a ScanLine."""
    bins = np.frombuffer(line.get(6, b""), np.uint8)
    return LoggedPing(samples=bins[:, None], ranges_m=_ranges_m(line.get(7, 0.0), line.get(8, 0.0), bins.size),
                      bearings_rad=np.array([line.get(5, 0.0)]), transmit_us=None,
                      head=line.get(1, b"").decode(), time_ns=line.get(4, 0), sonar_position_m=_numbers(_fields(line.get(13, b"")).get(1, b""), (1, 2, 3)),
                      sonar_quaternion_xyzw=_numbers(_fields(line.get(13, b"")).get(2, b""), (2, 3, 4, 1)))


_MAKERS = {"sonard.log.SonarImage": _multibeam_ping, "sonard.log.ScanLine": _scan_line}
