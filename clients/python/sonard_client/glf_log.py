# SPDX-License-Identifier: Apache-2.0
"""Reads pings of .glf logs, and of the .dat logs in them, as sonard and Tritech's programs write them
(docs/logs.md)."""

from __future__ import annotations

import math
import struct
import zlib
from datetime import datetime, timedelta, tzinfo
from typing import Any, Iterator, Optional

import numpy as np

from . import glf_archive
from .damage import warn, warn_of_bytes, warn_of_end
from .glf_archive import Pieces
from .ping import LoggedPing, is_plausible_time

MAGIC_OF_GLF, MAGIC_OF_DAT = glf_archive.LOCAL_SIGNATURE, glf_archive.START_OF_RECORD
TERMINATOR = glf_archive.TERMINATOR
_HEADER_BYTES = 21
_IMAGE, _STATUS = 0, 3
_STATUS_BYTES = 218
_ZLIB = 0
_MOST_BYTES = 1 << 26  # of one image; images of heads are far smaller


def pings_of_glf(data: Any, path: Any, zone: Optional[tzinfo]) -> Iterator[LoggedPing]:
    """`data` is the file as bytes or as a memory map; `path` is for messages."""
    entry = glf_archive.find_dat(data)
    dat = entry.candidates[0] if entry.damage is None else _with_records(entry.candidates)
    if dat is None:
        raise ValueError(f"{path} has no .dat log")
    if entry.damage is not None:
        warn(path, entry.damage)
    yield from _pings(_records(dat, path, in_cut_archive=entry.damage is not None), path, zone)
    if entry.crc is not None and dat.crc() != entry.crc:
        warn(path, "the checksum of its .dat does not match; bytes of images without a checksum of their own may be wrong")


def _with_records(candidates: list[Pieces]) -> Optional[Pieces]:
    """The candidate that begins with a whole record, or else one that contains one, or else the first one. None if there is
    only the whole file, and no record in it."""
    for at_start in (True, False):
        for dat in candidates:
            if _is_record(dat, 0) if at_start else _next_record(dat, 0) is not None:
                return dat
    return candidates[0] if len(candidates) > 1 else None


def pings_of_dat(data: Any, path: Any, zone: Optional[tzinfo]) -> Iterator[LoggedPing]:
    yield from _pings(_records(Pieces([data]), path), path, zone)


def _pings(records: Iterator[tuple[int, bytes]], path: Any, zone: Optional[tzinfo]) -> Iterator[LoggedPing]:
    for at, record in records:
        try:
            ping = _ping(record, zone)
        except (ValueError, OverflowError, struct.error, zlib.error) as error:
            warn_of_bytes(path, at, len(record), str(error), "the image is lost")
        else:
            yield ping


def _records(dat: Pieces, path: Any, in_cut_archive: bool = False) -> Iterator[tuple[int, bytes]]:
    """Whole images with their offsets, up to the end or an unfinished last record."""
    at = 0
    while at < dat.size:
        if dat.size - at == 2 and dat.read(at, 2) == TERMINATOR:
            return
        try:
            end = _end(dat, at)
        except (EOFError, ValueError) as error:
            following = _next_record(dat, at)
            if following is None:
                closed = dat.size - at > 2 and dat.read(dat.size - 2, 2) == TERMINATOR
                if closed or not isinstance(error, EOFError):
                    warn_of_bytes(path, at, dat.size - at, str(error), "the rest is lost")
                elif in_cut_archive:
                    warn(path, f"the last {dat.size - at} bytes of its .dat are an incomplete record")
                else:
                    warn_of_end(path, dat.size - at)
                return
            warn_of_bytes(path, at, following - at, str(error), "the images in them are lost")
            at = following
            continue
        kind = dat.read(at + 14, 1)[0]
        if kind == _IMAGE:
            yield at, dat.read(at, end - at)
        elif kind != _STATUS and (end_of_image := _end_if_image(dat, at)) is not None:
            warn_of_bytes(path, at, end_of_image - at, f"an image of type {kind}", "the image is lost")
            end = end_of_image
        at = end
    if not in_cut_archive:
        warn_of_end(path, 0)


def _end(dat: Pieces, at: int) -> int:
    """Offset of the end of the record at `at`. Raises EOFError beyond the data, ValueError if there is no record."""
    head = dat.read(at, _HEADER_BYTES)
    if head[:1] != b"*":
        raise ValueError(f"a record begins with the bytes {head[:2].hex(' ')}")
    (length,) = struct.unpack_from("<I", head, 2)
    if head[14] == _IMAGE:
        return _end_of_image(dat, at)
    size = _HEADER_BYTES + _STATUS_BYTES if head[14] == _STATUS else length
    if size < _HEADER_BYTES:
        raise ValueError(f"a record of {size} bytes")
    if at + size > dat.size:
        raise EOFError("a record beyond the end")
    return at + size


def _end_of_image(dat: Pieces, at: int) -> int:
    """End of an image by its own sizes, because other programs write other values into the header of the record."""
    _, tag, version, first_row, end_row, _, first_beam, end_beam = struct.unpack("<HHHIIHII", dat.read(at + 21, 24))
    if tag != 0xEFEF or end_row < first_row or end_beam < first_beam:
        raise ValueError(f"an image with rows {first_row} to {end_row}, beams {first_beam} to {end_beam}")
    size_at = at + 45 + (2 if version == 3 else 0)
    end: int = size_at + 4 + struct.unpack("<I", dat.read(size_at, 4))[0] + 8 * (end_beam - first_beam) + 34
    if end > dat.size:
        raise EOFError("an image beyond the end")
    if dat.read(end - 3, 3) != b"\0" + TERMINATOR:
        raise ValueError("an image without its end")
    return end


def _end_if_image(dat: Pieces, at: int) -> Optional[int]:
    """The end of a record whose content is an image, whatever its type; None if it is not an image."""
    try:
        return _end_of_image(dat, at)
    except (EOFError, ValueError):
        return None


def _next_record(dat: Pieces, at: int) -> Optional[int]:
    """Offset of the next whole record after `at`."""
    while (at := dat.find(MAGIC_OF_DAT, at + 1)) >= 0:
        if _is_record(dat, at):
            return at
    return None


def _is_record(dat: Pieces, at: int) -> bool:
    """Whether there is a whole image, or a whole status with a record or the end behind it."""
    try:
        head = dat.read(at, _HEADER_BYTES)
        end = _end(dat, at)
        return head[:2] == MAGIC_OF_DAT and head[19:21] == b"\0\0" and (head[14] == _IMAGE or (
            head[14] == _STATUS and (end == dat.size or dat.read(end, 1) in b"*\xde")))
    except (EOFError, ValueError):
        return False


def _ping(record: bytes, zone: Optional[tzinfo]) -> LoggedPing:
    """Decodes an image record."""
    (device,) = struct.unpack_from("<H", record, 15)
    _, _, version, first_row, end_row, _, first_beam, end_beam = struct.unpack_from("<HHHIIHII", record, 21)
    rows, beams = end_row - first_row, end_beam - first_beam
    if rows * beams > _MOST_BYTES or not rows or not beams:
        raise ValueError(f"an image of {rows} x {beams}")
    at = 45
    compression = None
    if version == 3:
        (compression,) = struct.unpack_from("<H", record, at)
        at += 2
    (size,) = struct.unpack_from("<I", record, at)
    samples = record[at + 4: at + 4 + size]
    at += 4 + size
    if len(samples) != rows * beams and compression in (_ZLIB, None):
        unpacker = zlib.decompressobj()
        samples = unpacker.decompress(samples, rows * beams + 1)
        if not unpacker.eof and len(samples) == rows * beams:
            unpacker.decompress(unpacker.unconsumed_tail, 1)  # reads the checksum of the stream
            if not unpacker.eof:
                raise ValueError("samples without their checksum")
    if len(samples) != rows * beams:
        raise ValueError(f"an image of {rows} x {beams} has {len(samples)} samples (compression {compression})")
    bearings_rad = np.frombuffer(record[at: at + 8 * beams], "<f8")
    _, rows_hz, _, transmit_s, _, sound_speed_mps, *_ = struct.unpack_from("<IIfdHfhBBBBH", record, at + 8 * beams)
    if not rows_hz:
        raise ValueError("an image without a rate of its rows")
    if not 0 < sound_speed_mps < math.inf:
        raise ValueError(f"an image with a sound speed of {sound_speed_mps} m/s")
    row_m = sound_speed_mps / 2 / rows_hz
    return LoggedPing(samples=np.frombuffer(samples, np.uint8).reshape(rows, beams),
                      ranges_m=(first_row + np.arange(rows) + 0.5) * row_m, bearings_rad=bearings_rad, transmit_us=None,
                      sound_speed_mps=sound_speed_mps, head=str(device), time_ns=_unix_ns(transmit_s, zone))


def _unix_ns(seconds: float, zone: Optional[tzinfo]) -> int:
    time_ns = round((datetime(1980, 1, 1) + timedelta(seconds=seconds)).replace(tzinfo=zone).timestamp() * 1e6) * 1000
    if not is_plausible_time(time_ns):
        raise ValueError(f"an image {seconds} s after 1980")
    return time_ns
