# SPDX-License-Identifier: Apache-2.0
"""Finds the .dat in the ZIP archive of a .glf, also if the archive is damaged or truncated (docs/logs.md 1.2)."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from typing import Any, Iterator, Optional

LOCAL_SIGNATURE = b"PK\x03\x04"
_CENTRAL_SIGNATURE, _END_SIGNATURE = b"PK\x01\x02", b"PK\x05\x06"
_STORED, _DEFLATED = 0, 8
_BLOCK_BYTES = 65531  # in sonard's own archives


class Pieces:
    """Bytes in several pieces, read as one sequence."""

    def __init__(self, pieces: list[Any]) -> None:
        self._pieces = pieces
        self._starts = [0]
        for piece in pieces:
            self._starts.append(self._starts[-1] + len(piece))
        self.size = self._starts[-1]

    def read(self, at: int, size: int) -> bytes:
        """Returns `size` bytes at `at`. Raises EOFError beyond the end."""
        if at + size > self.size:
            raise EOFError("a record beyond the end")
        return b"".join(self._parts(at, size))

    def _parts(self, at: int, size: int) -> Iterator[bytes]:
        number = self._number(at)
        while size > 0:
            offset = at - self._starts[number]
            part = bytes(self._pieces[number][offset: offset + size])
            yield part
            at, size, number = at + len(part), size - len(part), number + 1

    def _number(self, at: int) -> int:
        low, high = 0, len(self._pieces)
        while low < high:
            middle = (low + high) // 2
            low, high = (middle + 1, high) if self._starts[middle + 1] <= at else (low, middle)
        return low

    def find(self, what: bytes, at: int) -> int:
        """The first offset of `what` at or after `at`; -1 if it does not occur."""
        while at < self.size:
            window = self.read(at, min(1 << 16, self.size - at))
            found = window.find(what)
            if found >= 0:
                return at + found
            at += max(1, len(window) - len(what) + 1)
        return -1

    def crc(self) -> int:
        crc = 0
        for piece in self._pieces:
            crc = zlib.crc32(piece, crc)
        return crc


@dataclass(frozen=True)
class Dat:
    content: Pieces
    crc: Optional[int]  # from the archive; None if the archive does not give it


def find_dat(data: Any) -> Optional[Dat]:
    """Finds the .dat by its local header, or else by the directory."""
    at = 0
    while (at := data.find(LOCAL_SIGNATURE, at)) >= 0:
        if at + 30 <= len(data):
            method, _, _, crc, stored, _, name, extra = struct.unpack_from("<HHHIIIHH", data, at + 8)
            if bytes(data[at + 30: at + 30 + name]).endswith(b".dat"):
                directory = _from_directory(data)
                start = at + 30 + name + extra
                if directory is not None:
                    _, _, crc, stored = directory  # the local header may lack them
                return Dat(_content(data, start, method, stored), crc if directory is not None else None)
        at += 4
    directory = _from_directory(data)
    if directory is None:
        return None
    start, method, crc, stored = directory
    return Dat(_content(data, start, method, stored), crc)


def _from_directory(data: Any) -> Optional[tuple[int, int, int, int]]:
    """Offset of the content (if the local header has the directory's lengths), method, CRC and stored size."""
    end = data.rfind(_END_SIGNATURE)
    if end < 0 or end + 22 > len(data):
        return None
    (at,) = struct.unpack_from("<I", data, end + 16)
    while at + 46 <= len(data) and bytes(data[at: at + 4]) == _CENTRAL_SIGNATURE:
        method, _, _, crc, stored, _, name, extra, comment = struct.unpack_from("<HHHIIIHHH", data, at + 10)
        if bytes(data[at + 46: at + 46 + name]).endswith(b".dat"):
            return struct.unpack_from("<I", data, at + 42)[0] + 30 + name + extra, method, crc, stored
        at += 46 + name + extra + comment
    return None


def _content(data: Any, start: int, method: int, stored: int) -> Pieces:
    view = memoryview(data)[start:]
    if method == _STORED:
        return Pieces([view[:stored] if stored else view])
    pieces = _stored_blocks(view)
    return Pieces(pieces or [_inflated(view)])


def _stored_blocks(data: memoryview) -> list[memoryview]:
    """Blocks that deflate stores uncompressed. Skips a damaged header if another one follows."""
    pieces = []
    at = before = 0
    while (header := _block_header(data, at)) is not None:
        kind, size, inverse = header
        sizes = [size] if _is_stored(header) else [
            guess for guess in (size, inverse ^ 0xFFFF, before, _BLOCK_BYTES)
            if (following := _block_header(data, at + 5 + guess)) is not None and _is_stored(following)]
        if not sizes or (sizes[0] == 0 and kind & 1):
            break
        before = sizes[0]
        pieces.append(data[at + 5: at + 5 + before])
        at += 5 + before
    return pieces


def _block_header(data: memoryview, at: int) -> Optional[tuple[int, int, int]]:
    if at + 5 > len(data):
        return None
    kind, size, inverse = struct.unpack_from("<BHH", data, at)
    return kind, size, inverse


def _is_stored(header: tuple[int, int, int]) -> bool:
    kind, size, inverse = header
    return kind & 6 == 0 and size ^ inverse == 0xFFFF


def _inflated(data: memoryview) -> bytes:
    """Decompresses up to the end or the first error."""
    unpacker = zlib.decompressobj(-zlib.MAX_WBITS)
    parts = []
    try:
        for at in range(0, len(data), 1 << 16):
            parts.append(unpacker.decompress(data[at: at + (1 << 16)]))
            if unpacker.eof:
                break
    except zlib.error:
        pass
    return b"".join(parts)
