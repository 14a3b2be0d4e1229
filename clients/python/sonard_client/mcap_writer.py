# SPDX-License-Identifier: Apache-2.0
"""Writes MCAP files (mcap.dev/spec): chunks without compression, with indexes, a summary and checksums."""

from __future__ import annotations

import struct
import zlib
from typing import BinaryIO

from . import mcap_format as mcap

_CHUNK_BYTES = 1 << 20


def _text(value: str) -> bytes:
    return _sized(value.encode())


def _sized(value: bytes) -> bytes:
    return struct.pack("<I", len(value)) + value


def _record(kind: int, body: bytes) -> bytes:
    return struct.pack("<BQ", kind, len(body)) + body


class McapWriter:
    """Call close() at the end. `profile` says what the messages are: ros2."""

    def __init__(self, file: BinaryIO, profile: str, library: str) -> None:
        self._file = file
        self._offset = self._crc = 0
        self._definitions: list[tuple[int, bytes]] = []  # kind and record of schemas and channels, for the summary
        self._channels: dict[str, int] = {}
        self._schemas: dict[str, int] = {}
        self._counts: dict[int, int] = {}  # messages by channel
        self._chunk = bytearray()
        self._index: dict[int, list[tuple[int, int]]] = {}  # time and offset of the messages in the chunk, by channel
        self._chunk_indexes: list[bytes] = []
        self._first_ns, self._last_ns = 0, 0  # of the file
        self._write(mcap.MAGIC + _record(mcap.HEADER, _text(profile) + _text(library)))

    def add(self, topic: str, schema: str, encoding: str, definition: str, message_encoding: str, time_ns: int,
            data: bytes) -> None:
        """Adds a message, with its schema and channel if they are new."""
        if topic not in self._channels:
            self._define(topic, schema, encoding, definition, message_encoding)
        channel = self._channels[topic]
        number = self._counts[channel]
        self._index.setdefault(channel, []).append((time_ns, len(self._chunk)))
        self._chunk += _record(mcap.MESSAGE, struct.pack("<HIQQ", channel, number & 0xFFFF_FFFF, time_ns, time_ns) + data)
        self._first_ns = min(self._first_ns, time_ns) if sum(self._counts.values()) else time_ns
        self._last_ns = max(self._last_ns, time_ns)
        self._counts[channel] += 1
        if len(self._chunk) >= _CHUNK_BYTES:
            self._end_chunk()

    def close(self) -> None:
        """Writes the rest. The file stays open."""
        self._end_chunk()
        self._write(_record(mcap.DATA_END, struct.pack("<I", self._crc)))
        start = self._offset
        groups = [(kind, b"".join(body for its_kind, body in self._definitions if its_kind == kind))
                  for kind in (mcap.SCHEMA, mcap.CHANNEL)]
        groups += [(mcap.STATISTICS, self._statistics()), (mcap.CHUNK_INDEX, b"".join(self._chunk_indexes))]
        summary, offsets = b"", b""
        for kind, records in groups:
            if records:
                offsets += _record(mcap.SUMMARY_OFFSET, struct.pack("<BQQ", kind, start + len(summary), len(records)))
                summary += records
        footer = struct.pack("<BQQQ", mcap.FOOTER, 20, start, start + len(summary))
        crc = zlib.crc32(summary + offsets + footer)
        self._write(summary + offsets + footer + struct.pack("<I", crc) + mcap.MAGIC)

    def _write(self, data: bytes) -> None:
        self._file.write(data)
        self._crc = zlib.crc32(data, self._crc)
        self._offset += len(data)

    def _define(self, topic: str, schema: str, encoding: str, definition: str, message_encoding: str) -> None:
        if schema not in self._schemas:
            self._schemas[schema] = len(self._schemas) + 1
            self._add_definition(mcap.SCHEMA, struct.pack("<H", self._schemas[schema]) + _text(schema) + _text(encoding) +
                                 _text(definition))
        channel = self._channels[topic] = len(self._channels)
        self._counts[channel] = 0
        self._add_definition(mcap.CHANNEL, struct.pack("<HH", channel, self._schemas[schema]) + _text(topic) +
                             _text(message_encoding) + _sized(b""))

    def _add_definition(self, kind: int, body: bytes) -> None:
        record = _record(kind, body)
        self._definitions.append((kind, record))
        self._chunk += record

    def _end_chunk(self) -> None:
        """Writes the chunk with its indexes, if it has messages."""
        if not self._index:
            return
        times = [time_ns for entries in self._index.values() for time_ns, _ in entries]
        span = struct.pack("<QQ", min(times), max(times))
        start, data = self._offset, bytes(self._chunk)
        self._write(_record(mcap.CHUNK, span + struct.pack("<QI", len(data), zlib.crc32(data)) + _text("") +
                            struct.pack("<Q", len(data)) + data))
        length, index_start, offsets = self._offset - start, self._offset, b""
        for channel, entries in self._index.items():
            offsets += struct.pack("<HQ", channel, self._offset)
            self._write(_record(mcap.MESSAGE_INDEX, struct.pack("<H", channel) +
                                _sized(b"".join(struct.pack("<QQ", *entry) for entry in entries))))
        self._chunk_indexes.append(_record(mcap.CHUNK_INDEX, span + struct.pack("<QQ", start, length) + _sized(offsets) +
                                           struct.pack("<Q", self._offset - index_start) + _text("") +
                                           struct.pack("<QQ", len(data), len(data))))
        self._chunk.clear()
        self._index.clear()

    def _statistics(self) -> bytes:
        counts = b"".join(struct.pack("<HQ", *count) for count in self._counts.items())
        return _record(mcap.STATISTICS, struct.pack(
            "<QHIIIIQQ", sum(self._counts.values()), len(self._schemas), len(self._channels), 0, 0,
            len(self._chunk_indexes), self._first_ns, self._last_ns) + _sized(counts))
