# SPDX-License-Identifier: Apache-2.0
"""Reads pings of sonard's .mcap logs. The container is specified at mcap.dev/spec, the messages in
protocol/log/sonard_log.proto, whose field numbers are used below; the wire format is Protocol Buffers."""

from __future__ import annotations

import math
import re
import struct
import zlib
from typing import Any, Iterator, Optional

import numpy as np

from .damage import warn, warn_of_bytes, warn_of_end
from .mcap_format import (ATTACHMENT, CHANNEL, CHUNK, CHUNK_INDEX, DATA_END, FOOTER, HEADER, MAGIC, MESSAGE, MESSAGE_INDEX,
                          METADATA, SCHEMA, STATISTICS, SUMMARY_OFFSET)
from .ping import Array, LoggedPing, is_plausible_time

_LAST_KNOWN = 15
# Parts of a record's content: a number of bytes, or bytes after their length in 32 or 64 bits.
_SIZED_32, _SIZED_64 = -4, -8
_FORMS = {HEADER: (_SIZED_32, _SIZED_32), FOOTER: (20,), SCHEMA: (2, _SIZED_32, _SIZED_32, _SIZED_32),
          CHANNEL: (4, _SIZED_32, _SIZED_32, _SIZED_32), CHUNK: (28, _SIZED_32, _SIZED_64),
          MESSAGE_INDEX: (2, _SIZED_32), CHUNK_INDEX: (32, _SIZED_32, 8, _SIZED_32, 16),
          ATTACHMENT: (16, _SIZED_32, _SIZED_32, _SIZED_64, 4), STATISTICS: (42, _SIZED_32),
          METADATA: (_SIZED_32, _SIZED_32), SUMMARY_OFFSET: (17,), DATA_END: (4,)}
_WITHOUT_MESSAGES = (HEADER, SCHEMA, CHANNEL, MESSAGE_INDEX, DATA_END)
_AFTER_DATA = (FOOTER, STATISTICS, DATA_END)
# The start of a chunk with a known compression, of a schema of sonard, and of a message index below 16 MiB.
_READABLE = re.compile(rb"\x06(?=.{36}(?:\x00{4}|\x04\x00{3}zstd|\x03\x00{3}lz4))|\x03(?=.{14}sonard\.log\.)"
                       rb"|\x07(?=.{3}\x00{5}.{5}\x00)", re.DOTALL)
_MOST_BYTES = 1 << 30  # of one chunk
_FRONT_BYTES = 49  # of a chunk without compression, up to its records
_SMALLEST_CHUNK = _FRONT_BYTES + 9 + 22  # with one message
_ENOUGH = 64  # whole records in a row are no coincidence
_FOOTER_BYTES = 9 + 20
_MOST_BINS = 65535  # of a scan line
_VARINT, _EIGHT_BYTES, _BYTES, _FOUR_BYTES = 0, 1, 2, 5  # wire types of fields
_SIZES = {_EIGHT_BYTES: 8, _FOUR_BYTES: 4}


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
        self._without_channel = 0  # messages
        self._ended = False  # the end of the data section was found
        self._tail_bytes = 0  # of an unfinished record at the end

    def pings(self) -> Iterator[LoggedPing]:
        for kind, body in self._records():
            # Records in chunks have a checksum and come first, so they take precedence.
            if kind == SCHEMA and len(body) >= 6:
                self._schemas.setdefault(struct.unpack_from("<H", body)[0], _text(body, 2))
            elif kind == CHANNEL and len(body) >= 4:
                number, schema = struct.unpack_from("<HH", body)
                self._channels.setdefault(number, schema)
            elif kind == MESSAGE and len(body) >= 22:
                (channel,) = struct.unpack_from("<H", body)
                schema_name = self._schema_of(channel)
                self._without_channel += channel not in self._channels
                if schema_name in _MAKERS:
                    try:
                        ping = _MAKERS[schema_name](_Fields(body[22:]))
                    except (IndexError, ValueError) as error:
                        warn(self._path, f"a {schema_name} cannot be decoded ({error}); it is lost")
                    else:
                        yield ping
        if self._without_channel:
            warn(self._path, f"{self._without_channel} messages belong to no channel and are left out")

    def _schema_of(self, channel: int) -> str:
        return self._schemas.get(self._channels.get(channel, 0), "")

    def _records(self) -> Iterator[tuple[int, bytes]]:
        """Records outside and inside of chunks. Warns if the end of the log is missing or damaged."""
        yield from self._data_section()
        self._tell_lost_chunk()
        if not self._ended and not _has_end(self._data):
            warn_of_end(self._path, self._tail_bytes)
        elif self._ended and not _has_whole_summary(self._data):
            warn(self._path, "the index at its end cannot be read; no ping is lost")

    def _data_section(self) -> Iterator[tuple[int, bytes]]:
        """Records outside and inside of chunks, up to the end of the data or an unfinished last record."""
        data = self._data
        at: Optional[int] = self._start()
        while at is not None and at < len(data):
            end = _end(data, at)
            try:
                if (end_of_records := _end_of_open_chunk(data, at)) is not None:
                    self._tell_lost_chunk()
                    yield from _split(data[at + _FRONT_BYTES: end_of_records], has_crc=False)
                    if end is not None and end > end_of_records:
                        warn_of_bytes(self._path, end_of_records, end - end_of_records, "a record in an open chunk",
                                      "its pings are lost")
                    end = max(end or 0, end_of_records)
                elif end is None:
                    raise _Damaged("a length beyond the end")
                elif data[at] == CHUNK:
                    if not _sizes_agree(data, at):
                        raise _Damaged("the length of a chunk")
                    self._tell_lost_chunk()
                    yield from _records_of_chunk(data[at + 9: end], self._path)
                elif _sizes_agree(data, at) or not (_leads_on(data, end) if _is_unknown(data[at]) else
                                                    _has_form(data, at, data[at])):
                    raise _Damaged(f"a record of type {data[at]}")
                elif data[at] in _AFTER_DATA:
                    self._ended = True
                    return
                elif data[at] == MESSAGE_INDEX:
                    self._count_lost(data[at + 9: end])
                else:
                    yield data[at], data[at + 9: end]
                at = end
            except _Damaged as why:
                at = self._behind_damage(at, end, str(why))

    def _start(self) -> int:
        """The first record. Reports a damaged magic; raises ValueError if no record follows it."""
        data, at = self._data, len(MAGIC)
        if bytes(data[:at]) == MAGIC:
            return at
        if len(data) <= at or data[at] != HEADER or not _has_form(data, at, HEADER):
            found = _next_readable(data, -1, None)
            if found is None:
                raise ValueError(f"{self._path} is not an .mcap log, or none of its pings can be read")
            at = found
        warn_of_bytes(self._path, 0, at, "the magic", "no ping is lost" if at < _SMALLEST_CHUNK else "pings may be lost")
        return at

    def _behind_damage(self, at: int, end: Optional[int], why: str) -> Optional[int]:
        """Reports damage at `at`. Returns where to continue; None if there is no place."""
        self._tell_lost_chunk()
        data = self._data
        following = None if _is_cut_chunk(data, at) else _next_readable(data, at, end)
        if following is None and end is None and not _has_end(data):
            self._tail_bytes = len(data) - at
            return None  # the record is cut, or still being written
        size = (len(data) if following is None else following) - at
        if _was_chunk(data, at):
            self._lost_chunk = at, size, why
        else:
            warn_of_bytes(self._path, at, size, why, "the rest is lost" if following is None else
                          "no ping is lost" if _held_no_message(data, at, following) else "pings may be lost")
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
    return _has_form(data, at, CHUNK)


def _is_cut_chunk(data: Any, at: int) -> bool:
    """Whether the file ends inside the chunk at `at`, whose sizes agree."""
    if at + _FRONT_BYTES > len(data) or data[at] != CHUNK or _end(data, at) is not None or _has_end(data):
        return False
    (name,) = struct.unpack_from("<I", data, at + 37)
    return bool(at + 49 + name <= len(data) and struct.unpack_from("<Q", data, at + 1)[0] ==
                40 + name + struct.unpack_from("<Q", data, at + 41 + name)[0])


def _has_form(data: Any, at: int, kind: int, end: Optional[int] = None) -> bool:
    """Whether the lengths inside the record fit a record of this kind, for any type byte. `end` replaces its own end."""
    end = _end(data, at) if end is None else end
    if end is None or kind not in _FORMS:
        return False
    place = at + 9
    for part in _FORMS[kind]:
        if part in (_SIZED_32, _SIZED_64):
            if place - part > end:
                return False
            place += -part + struct.unpack_from("<I" if part == _SIZED_32 else "<Q", data, place)[0]
        else:
            place += part
    return place == end and (kind != MESSAGE_INDEX or (end - at - 15) % 16 == 0)


def _is_unknown(kind: int) -> bool:
    """Whether records of this kind are of a later version or of another program."""
    return kind > _LAST_KNOWN or (kind not in _FORMS and kind not in (0, MESSAGE))


def _leads_on(data: Any, at: int) -> bool:
    """Whether records of the data section begin at `at`. Bytes inside a record rarely look so: records of unknown kinds and
    definitions, which are also inside chunks, must lead to another consistent record."""
    for _ in range(_ENOUGH):
        if at == len(data) or _end_of_open_chunk(data, at) is not None:
            return True
        end = _end(data, at)
        unknown = end is not None and _is_unknown(data[at])
        if end is None or not (unknown or _has_form(data, at, data[at])):
            return False
        if not unknown and data[at] not in (SCHEMA, CHANNEL):
            return True
        at = end
    return True


def _looks_like_no_chunk(data: Any, at: int, end: Optional[int] = None) -> bool:
    return any(_has_form(data, at, kind, end) for kind in _WITHOUT_MESSAGES)


def _was_chunk(data: Any, at: int) -> bool:
    """Whether an unreadable record is a chunk. Assumes that one bit is wrong, so its length or its type is right."""
    return _sizes_agree(data, at) or (data[at] == CHUNK and not _looks_like_no_chunk(data, at))


def _held_no_message(data: Any, at: int, following: int) -> bool:
    """Whether the damaged bytes up to `following` are too few for a chunk, or a record of another kind."""
    return (following - at < _SMALLEST_CHUNK or (data[at] in _WITHOUT_MESSAGES and _end(data, at) == following)
            or _looks_like_no_chunk(data, at, following))


def _next_readable(data: Any, at: int, end: Optional[int]) -> Optional[int]:
    """Where to continue: after the record if its content fits its length and a record follows; else at the next chunk,
    message index or schema."""
    if end is not None and (_sizes_agree(data, at) or _looks_like_no_chunk(data, at)) and _leads_on(data, end):
        return end
    for match in _READABLE.finditer(data, at + 1):
        found = match.start()
        following = _end(data, found)
        if following is not None and _has_form(data, found, data[found]) and (
                data[found] == CHUNK or _leads_on(data, following)):
            return found
    return None


def _records_of_chunk(body: bytes, path: Any) -> list[tuple[int, bytes]]:
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
    return _split(data, has_crc=crc != 0)


def _split(data: bytes, has_crc: bool) -> list[tuple[int, bytes]]:
    """The records in a chunk. Without a checksum, a record of an unexpected type or form is damage."""
    records = []
    at = 0
    while at < len(data):
        end = _end(data, at)
        if end is None:
            raise _Damaged("a record beyond its chunk")
        if not has_crc and data[at] != MESSAGE and not (data[at] in (SCHEMA, CHANNEL) and _has_form(data, at, data[at])):
            raise _Damaged(f"a record of type {data[at]} in a chunk")
        records.append((data[at], data[at + 9: end]))
        at = end
    return records


def _end_of_open_chunk(data: Any, at: int) -> Optional[int]:
    """The end of the last whole record of a chunk that is still being written: it has no checksum and no compression, and its
    length may be too short. None if there is no such chunk."""
    begin = at + _FRONT_BYTES
    if begin > len(data) or data[at] != CHUNK or struct.unpack_from("<II", data, at + 33) != (0, 0):
        return None
    end = begin
    while end < len(data) and data[end] in (SCHEMA, CHANNEL, MESSAGE) and (following := _end(data, end)) is not None:
        end = following
    return end if end > begin else None


def _has_end(data: Any) -> bool:
    return len(data) >= 2 * len(MAGIC) and bool(data[-len(MAGIC):] == MAGIC)


def _has_whole_summary(data: Any) -> bool:
    """Whether the file has an end and a summary with the right checksum, or says that it has no summary."""
    at = len(data) - len(MAGIC) - _FOOTER_BYTES
    if not _has_end(data) or at < len(MAGIC) or data[at] != FOOTER or not _has_form(data, at, FOOTER):
        return False
    start, _, crc = struct.unpack_from("<QQI", data, at + 9)
    if crc == 0:
        return bool(start == 0 or len(MAGIC) <= start <= at)
    return bool(len(MAGIC) <= start <= at and zlib.crc32(data[start: at + _FOOTER_BYTES - 4]) == crc)


def _unpacked(compression: bytes, data: bytes, size: int, path: Any) -> bytes:
    if compression == b"zstd":
        try:
            import zstandard
        except ImportError as error:
            raise ValueError(f"{path} is compressed: pip install zstandard") from error
        try:
            if size > _MOST_BYTES or zstandard.frame_content_size(data) not in (size, -1):
                raise _Damaged("the size of a chunk")
            unpacked: bytes = zstandard.ZstdDecompressor().decompress(data, size)
        except (zstandard.ZstdError, MemoryError) as error:
            raise _Damaged("a chunk that does not unpack") from error
        if len(unpacked) != size:
            raise _Damaged("the size of a chunk")
        return unpacked
    if compression == b"lz4":
        raise ValueError(f"{path} is compressed by 'lz4', which sonard does not write")
    if compression:
        raise _Damaged("the compression of a chunk")
    if len(data) != size:
        raise _Damaged("the size of a chunk")
    return data


def _text(body: bytes, at: int) -> str:
    (length,) = struct.unpack_from("<I", body, at)
    return body[at + 4: at + 4 + length].decode(errors="replace")


def _varint(data: bytes, at: int) -> tuple[int, int]:
    value = 0
    for shift in range(0, 70, 7):
        value |= (data[at] & 0x7F) << shift
        at += 1
        if data[at - 1] < 0x80:
            return value & 0xFFFF_FFFF_FFFF_FFFF, at
    raise ValueError("a number has more than 10 bytes")


class _Fields:
    """The last value of each field of a message. A field of another type than expected is missing, as for every reader of
    Protocol Buffers."""

    def __init__(self, data: bytes) -> None:
        self._values: dict[tuple[int, int], Any] = {}
        at = 0
        while at < len(data):
            tag, at = _varint(data, at)
            number, kind = tag >> 3, tag & 7
            size = 0
            if kind == _VARINT:
                value, at = _varint(data, at)
                self._values[number, kind] = value
            elif kind in _SIZES:
                size = _SIZES[kind]
            elif kind == _BYTES:
                size, at = _varint(data, at)
            else:
                raise ValueError(f"a field of wire type {kind}")
            if not number or at + size > len(data):
                raise ValueError(f"field {number} of {size} bytes")
            if kind != _VARINT:
                self._values[number, kind] = data[at: at + size]
            at += size

    def number(self, field: int) -> int:
        """An unsigned number of 32 bits."""
        return int(self._values.get((field, _VARINT), 0)) & 0xFFFF_FFFF

    def signed(self, field: int) -> int:
        """A number of 64 bits."""
        value = int(self._values.get((field, _VARINT), 0))
        return value - (1 << 64) if value >= 1 << 63 else value

    def real(self, field: int) -> float:
        return float(struct.unpack("<d", self._values.get((field, _EIGHT_BYTES), bytes(8)))[0])

    def content(self, field: int) -> bytes:
        return bytes(self._values.get((field, _BYTES), b""))

    def text(self, field: int) -> str:
        return self.content(field).decode()


def _pose(data: bytes) -> tuple[Array, Array]:
    """Position and quaternion of a Pose; a missing number is 0."""
    pose = _Fields(data)
    position, orientation = _Fields(pose.content(1)), _Fields(pose.content(2))
    return (np.array([position.real(number) for number in (1, 2, 3)]),
            np.array([orientation.real(number) for number in (2, 3, 4, 1)]))


def _require_plausible(ping: _Fields, step_m: float, sound_speed_mps: float) -> None:
    """Raises ValueError for values that no sonar has. `sonard info` leaves out the same pings."""
    if (not is_plausible_time(ping.signed(4)) or ping.number(2) > 0xFFFF or not 0 < step_m < math.inf
            or not 0 < sound_speed_mps < math.inf):
        raise ValueError("impossible values")


def _ranges_m(first_m: float, step_m: float, count: int) -> Array:
    return first_m + (np.arange(count) + 0.5) * step_m


def _multibeam_ping(image: _Fields) -> LoggedPing:
    """Decodes a SonarImage."""
    rows, beams = image.number(5), image.number(6)
    samples, bearings_rad = np.frombuffer(image.content(7), np.uint8), np.frombuffer(image.content(8), "<f8")
    if not samples.size or samples.size != rows * beams or bearings_rad.size != beams:
        raise ValueError(f"{rows} rows of {beams} beams have {samples.size} samples and {bearings_rad.size} bearings")
    _require_plausible(image, image.real(10), image.real(11))
    _pose(image.content(14))  # of the vehicle; checked only, as the type is
    image.text(16)
    position_m, quaternion_xyzw = _pose(image.content(15))
    return LoggedPing(samples=samples.reshape(rows, beams), ranges_m=_ranges_m(image.real(9), image.real(10), rows),
                      bearings_rad=bearings_rad, transmit_us=None, sound_speed_mps=image.real(11),
                      frequency_hz=image.real(13), head=image.text(1), time_ns=image.signed(4),
                      sonar_position_m=position_m, sonar_quaternion_xyzw=quaternion_xyzw)


def _scan_line(line: _Fields) -> LoggedPing:
    """Decodes a ScanLine."""
    bins, bearing_rad = np.frombuffer(line.content(6), np.uint8), line.real(5)
    if not 0 < bins.size <= _MOST_BINS or not math.isfinite(bearing_rad):
        raise ValueError(f"{bins.size} bins at {bearing_rad} rad")
    _require_plausible(line, line.real(8), line.real(9))
    _pose(line.content(12))  # of the vehicle; checked only, as the type is
    line.text(16)
    position_m, quaternion_xyzw = _pose(line.content(13))
    return LoggedPing(samples=bins[:, None], ranges_m=_ranges_m(line.real(7), line.real(8), bins.size),
                      bearings_rad=np.array([bearing_rad]), transmit_us=None, sound_speed_mps=line.real(9),
                      frequency_hz=line.real(11), head=line.text(1), time_ns=line.signed(4),
                      sonar_position_m=position_m, sonar_quaternion_xyzw=quaternion_xyzw)


_MAKERS = {"sonard.log.SonarImage": _multibeam_ping, "sonard.log.ScanLine": _scan_line}
