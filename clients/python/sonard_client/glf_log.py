# SPDX-License-Identifier: Apache-2.0
"""Pings of .glf logs and of the .dat logs in them, as sonard and Tritech's programs write them: docs/logs.md says
more of them."""

from __future__ import annotations

import struct
import zipfile
import zlib
from datetime import datetime, timedelta, tzinfo
from typing import Any, Iterator, Optional

import numpy as np

from .ping import LoggedPing

MAGIC_OF_GLF, MAGIC_OF_DAT = b"PK\x03\x04", b"*\x02"
_IMAGE, _STATUS = 0, 3
_STATUS_BYTES = 218
_ZLIB = 0
_MOST_BYTES = 1 << 26  # of one image: far beyond any head's


def pings_of_glf(file: Any, path: Any, zone: Optional[tzinfo]) -> Iterator[LoggedPing]:
    """`path` is for messages."""
    try:
        with zipfile.ZipFile(file) as archive:
            logs = [name for name in archive.namelist() if name.endswith(".dat")]
            if len(logs) != 1:
                raise ValueError(f"{path} holds {len(logs)} .dat logs (expected 1)")
            with archive.open(logs[0]) as log:
                yield from pings_of_dat(log, path, zone)
    except (zipfile.BadZipFile, RuntimeError, OSError) as error:  # all three for bytes that make no sense
        raise ValueError(f"{path} is damaged: {error}") from error


def pings_of_dat(file: Any, path: Any, zone: Optional[tzinfo]) -> Iterator[LoggedPing]:
    try:
        while len(head := file.read(21)) == 21:
            if head[:1] != b"*":
                raise ValueError(f"a record begins with the bytes {head[:2].hex(' ')}")
            seconds, kind, device = struct.unpack_from("<dBH", head, 6)
            if kind == _IMAGE:
                yield _ping(file, device, seconds, zone)
            else:
                _exactly(file, _STATUS_BYTES if kind == _STATUS else struct.unpack_from("<I", head, 2)[0] - 21)
    except EOFError:
        return  # the record that is being written
    except (ValueError, OverflowError, zlib.error) as error:
        raise ValueError(f"{path} is damaged: {error}") from error


def _exactly(file: Any, size: int) -> bytes:
    if not 0 <= size <= _MOST_BYTES:
        raise ValueError(f"a record of {size} bytes")
    data: bytes = file.read(size)
    if len(data) < size:
        raise EOFError
    return data


def _ping(file: Any, device: int, seconds: float, zone: Optional[tzinfo]) -> LoggedPing:
    """An image record, behind its first 21 bytes."""
    _, tag, version, first_row, end_row, _, first_beam, end_beam = struct.unpack("<HHHIIHII", _exactly(file, 24))
    if tag != 0xEFEF or end_row < first_row or end_beam <= first_beam:
        raise ValueError(f"an image with rows {first_row} to {end_row}, beams {first_beam} to {end_beam}")
    rows, beams = end_row - first_row, end_beam - first_beam
    compression = struct.unpack("<H", _exactly(file, 2))[0] if version == 3 else None
    samples = _exactly(file, *struct.unpack("<I", _exactly(file, 4)))
    if len(samples) != rows * beams and compression in (_ZLIB, None):
        samples = zlib.decompressobj().decompress(samples, _MOST_BYTES)
    if len(samples) != rows * beams:
        raise ValueError(f"an image of {rows} x {beams} has {len(samples)} samples (compression {compression})")
    bearings_rad = np.frombuffer(_exactly(file, 8 * beams), "<f8")
    _, rows_hz, _, _, _, sound_speed_mps, *_ = struct.unpack("<IIfdHfhBBBBH", _exactly(file, 34))
    if not rows_hz:
        raise ValueError("an image without a rate of its rows")
    row_m = sound_speed_mps / 2 / rows_hz
    return LoggedPing(samples=np.frombuffer(samples, np.uint8).reshape(rows, beams),
                      ranges_m=(first_row + np.arange(rows) + 0.5) * row_m, bearings_rad=bearings_rad, transmit_us=None,
                      head=str(device), time_ns=_unix_ns(seconds, zone))


def _unix_ns(seconds: float, zone: Optional[tzinfo]) -> int:
    return round((datetime(1980, 1, 1) + timedelta(seconds=seconds)).replace(tzinfo=zone).timestamp() * 1e6) * 1000
