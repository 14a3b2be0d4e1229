# SPDX-License-Identifier: Apache-2.0
"""Finds the .dat in the ZIP archive of a .glf, also if the archive is damaged or truncated (protocol/glf/README.md 1.2)."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass
from typing import Any, Iterator, Optional

import numpy as np

LOCAL_SIGNATURE = b"PK\x03\x04"
_CENTRAL_SIGNATURE, _END_SIGNATURE = b"PK\x01\x02", b"PK\x05\x06"
START_OF_RECORD = b"*\x02"
TERMINATOR = b"\xde\xde"  # ends a closed .dat
_LOCAL = struct.Struct("<4sHHHHHIIIHH")
_CENTRAL = struct.Struct("<4sHHHHHHIIIHHHHHII")
_END = struct.Struct("<4sHHHHIIH")
_STORED, _DEFLATED = 0, 8
_SIGNATURES = (LOCAL_SIGNATURE, _CENTRAL_SIGNATURE, _END_SIGNATURE)
_WINDOW_BYTES = 1 << 20
_ENCRYPTED = 1  # of an entry's flags
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


class _BadArchive(Exception):
    """The archive around the .dat is damaged or cut."""


def _unreadable(what: str) -> _BadArchive:
    return _BadArchive(f"{what} cannot be read in its archive, which was searched for pings")


@dataclass(frozen=True)
class Dat:
    candidates: list[Pieces]  # the most likely one first; more than one only if the archive is damaged
    crc: Optional[int]  # of the candidate, not checked yet; None if it is unknown, or checked
    damage: Optional[str]  # of the archive around the .dat


@dataclass(frozen=True)
class _Entry:
    """An entry of the directory."""

    name: bytes
    flags: int
    method: int
    crc: int
    stored_size: int
    size: int
    extra_size: int
    local_header: int  # its offset


def find_dat(data: Any) -> Dat:
    """Finds the .dat by the directory. If the archive is damaged or cut, also by the local headers; the last candidate is the
    whole file."""
    try:
        return _intact_dat(data)
    except _BadArchive as why:
        return Dat([*_by_local_header(data), *_by_directory(data), Pieces([data])], None, str(why))


def _intact_dat(data: Any) -> Dat:
    """Reads an archive without errors. Sizes, method and CRC come from the directory, because local headers may lack them."""
    dat = None
    for entry in _directory(data):
        content = _located(data, entry)
        if entry.name.endswith(b".dat") and dat is None:
            dat = entry, content
        elif entry.name.endswith(b".cfg"):
            _unpacked(entry, content)
    if dat is None:
        raise _unreadable("a .dat")
    entry, content = dat
    if entry.method == _STORED and bytes(content[:2]) not in (START_OF_RECORD, TERMINATOR, b""):
        raise _unreadable(f"the place of {_shown(entry)}")
    blocks = [content] if entry.method == _STORED else _whole_blocks(content)
    if blocks is not None and sum(map(len, blocks)) == entry.size:
        return Dat([Pieces(blocks)], entry.crc, None)
    return Dat([Pieces([_unpacked(entry, content)])], None, None)


def _directory(data: Any) -> Iterator[_Entry]:
    at, count = _end_record(data)
    for number in range(count):
        entry, at = _directory_entry(data, at, f"entry {number} of the directory")
        yield entry


def _directory_entry(data: Any, at: int, what: str) -> tuple[_Entry, int]:
    """The entry at `at`, and the offset of the next one."""
    if at + _CENTRAL.size > len(data):
        raise _unreadable(what)
    (signature, _, _, flags, method, _, _, crc, stored_size, size, name_size, extra_size, comment_size, _, _, _,
     local_header) = _CENTRAL.unpack_from(data, at)
    at += _CENTRAL.size
    if signature != _CENTRAL_SIGNATURE or at + name_size + extra_size + comment_size > len(data):
        raise _unreadable(what)
    name = bytes(data[at: at + name_size])
    return (_Entry(name, flags, method, crc, stored_size, size, extra_size, local_header),
            at + name_size + extra_size + comment_size)


def _end_record(data: Any) -> tuple[int, int]:
    """Offset of the directory and number of its entries, from the last end record with a comment up to the end of the file."""
    at = len(data)
    while (at := data.rfind(_END_SIGNATURE, max(0, len(data) - _END.size - 0xFFFF), at)) >= 0:
        if at + _END.size <= len(data):
            *_, entries, _, directory, comment_size = _END.unpack_from(data, at)
            if at + _END.size + comment_size == len(data):
                return directory, entries
        at += len(_END_SIGNATURE) - 1
    raise _BadArchive("the end of the archive is missing")


def _located(data: Any, entry: _Entry) -> memoryview:
    """The content of an entry after its local header."""
    at = entry.local_header
    if at + _LOCAL.size > len(data) or bytes(data[at: at + 4]) != LOCAL_SIGNATURE:
        raise _unreadable(f"the local header of {_shown(entry)}")
    *_, name_size, extra_size = _LOCAL.unpack_from(data, at)
    start = at + _LOCAL.size + name_size + extra_size
    if (start + entry.stored_size > len(data) or entry.flags & _ENCRYPTED or entry.method not in (_STORED, _DEFLATED)
            or (entry.method == _STORED and entry.stored_size != entry.size)):
        raise _unreadable(f"the sizes or method of {_shown(entry)}")
    return memoryview(data)[start: start + entry.stored_size]


def _unpacked(entry: _Entry, content: memoryview) -> bytes:
    """Unpacks an entry and checks its size and CRC."""
    unpacked, whole = (bytes(content), True) if entry.method == _STORED else _inflated(content)
    if not whole or len(unpacked) != entry.size or zlib.crc32(unpacked) != entry.crc:
        raise _unreadable(f"the content of {_shown(entry)}")
    return unpacked


def _shown(entry: _Entry) -> str:
    return entry.name.decode(errors="replace")


def _by_local_header(data: Any) -> Iterator[Pieces]:
    """The content after the first local header with the name of a .dat, by its method and by the other one."""
    at = -1
    while (at := data.find(LOCAL_SIGNATURE, at + 1)) >= 0 and at + _LOCAL.size <= len(data):
        _, _, _, method, _, _, _, stored_size, _, name_size, extra_size = _LOCAL.unpack_from(data, at)
        start = at + _LOCAL.size
        if bytes(data[start: start + name_size]).endswith(b".dat"):
            rest = memoryview(data)[start + name_size + extra_size:]
            stored = rest[:stored_size] if bytes(rest[stored_size: stored_size + 2]) == b"PK" else rest
            methods = (_STORED, _DEFLATED) if method == _STORED else (_DEFLATED, _STORED)
            yield from (_front(stored if kind == _STORED else rest, kind) for kind in methods)
            return


def _by_directory(data: Any) -> Iterator[Pieces]:
    """The content of the .dat at its offset in the directory. Assumes that the local header is as long as it should be."""
    try:
        for entry in _directory(data):
            if entry.name.endswith(b".dat"):
                start = entry.local_header + _LOCAL.size + len(entry.name) + entry.extra_size
                yield _front(memoryview(data)[start: start + entry.stored_size], entry.method)
                return
    except _BadArchive:
        return


def _front(content: memoryview, method: int) -> Pieces:
    """The readable part of a damaged entry."""
    if method == _STORED:
        return Pieces([content])
    return Pieces(_stored_blocks(content) or [_inflated(content)[0]])


def _whole_blocks(data: memoryview) -> Optional[list[memoryview]]:
    """The blocks of an entry that deflate stores uncompressed; None if it has other blocks or damaged ones."""
    pieces = []
    at, last = 0, False
    while not last:
        header = _block_header(data, at)
        if header is None or not _is_stored(header) or at + 5 + header[1] > len(data):
            return None
        pieces.append(data[at + 5: at + 5 + header[1]])
        at, last = at + 5 + header[1], bool(header[0] & 1)
    return pieces


def _stored_blocks(data: memoryview) -> list[memoryview]:
    """Blocks that deflate stores uncompressed. Skips a damaged header if another one follows. If bytes were inserted into a
    block or removed, the block ends at the next header."""
    pieces: list[memoryview] = []
    at = before = 0
    while (header := _block_header(data, at)) is not None and bytes(data[at: at + 4]) not in _SIGNATURES:
        kind, size, inverse = header
        sizes = [size] if _is_stored(header) else [
            guess for guess in (size, inverse ^ 0xFFFF, before, _BLOCK_BYTES)
            if (following := _block_header(data, at + 5 + guess)) is not None and _is_stored(following)]
        if not sizes and pieces:
            begin = at - len(pieces.pop())
            following = _next_block(data, begin, before)
            at = len(data) if following is None else following
            pieces.append(data[begin: at])
            continue
        if not sizes or (sizes[0] == 0 and kind & 1):
            break
        before = sizes[0]
        pieces.append(data[at + 5: at + 5 + before])
        at += 5 + before
    return pieces


def _next_block(data: memoryview, at: int, usual_size: int) -> Optional[int]:
    """Offset of the next header of a stored block that a header, or the end of the entry, follows. A block of the usual size
    may also be cut."""
    for start in range(at, len(data), _WINDOW_BYTES):
        window = np.frombuffer(data[start: start + _WINDOW_BYTES + 4], np.uint8)
        found = (window[:-4] < 2) & (window[1:-3] ^ window[3:-1] == 0xFF) & (window[2:-2] ^ window[4:] == 0xFF)
        for offset in np.flatnonzero(found).tolist():
            kind, size, _ = struct.unpack_from("<BHH", data, start + offset)
            end = start + offset + 5 + size
            header = _block_header(data, end)
            if (header is not None and header[0] < 2 and _is_stored(header)) or (
                    kind == 1 and bytes(data[end: end + 4]) in _SIGNATURES) or (size == usual_size and end > len(data)):
                return start + offset
    return None


def _block_header(data: memoryview, at: int) -> Optional[tuple[int, int, int]]:
    if at + 5 > len(data):
        return None
    kind, size, inverse = struct.unpack_from("<BHH", data, at)
    return kind, size, inverse


def _is_stored(header: tuple[int, int, int]) -> bool:
    kind, size, inverse = header
    return kind & 6 == 0 and size ^ inverse == 0xFFFF


def _inflated(data: memoryview) -> tuple[bytes, bool]:
    """Decompresses up to the end or the first error. Also returns whether the end was reached."""
    unpacker = zlib.decompressobj(-zlib.MAX_WBITS)
    parts = []
    for at in range(0, len(data), 1 << 16):
        before = unpacker.copy()
        try:
            parts.append(unpacker.decompress(data[at: at + (1 << 16)]))
        except zlib.error:
            parts.append(_up_to_error(before, data[at: at + (1 << 16)]))
            break
        if unpacker.eof:
            break
    return b"".join(parts), unpacker.eof


def _up_to_error(unpacker: Any, data: memoryview) -> bytes:
    """Decompresses byte by byte, because zlib returns nothing of a step with an error."""
    parts = []
    try:
        for at in range(len(data)):
            parts.append(unpacker.decompress(data[at: at + 1]))
    except zlib.error:
        pass
    return b"".join(parts)
