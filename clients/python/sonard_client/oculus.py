# SPDX-License-Identifier: Apache-2.0
"""A client for a Blueprint Subsea Oculus. Section numbers in comments refer to protocol/oculus/README.md."""

from __future__ import annotations

import math
import socket
import struct
import time
from typing import Iterator, Optional

import numpy as np

from .ping import NoHead, NoPing, Ping

COMMAND_PORT, STATUS_PORT = 52100, 52102
_MAGIC = b"\x53\x4f"
_FIRE, _PING = 0x15, 0x23
_HEADER_BYTES, _STATUS_BYTES = 16, 142
_MOST_BYTES = 1 << 23  # of one message
_IN_METRES, _SIXTEEN_BIT, _SIMPLE, _BEAMS_512 = 0x01, 0x02, 0x08, 0x40  # 3.2
_RATES = ((2.0, 4), (5.0, 3), (10.0, 0), (15.0, 1), (40.0, 2))  # Hz and pingRate (3.3)
# By part numbers (1): horizontal and vertical beam of the low and the high frequency, in degrees (8).
_M750D_BEAMS_DEG = ((1.0, 20.0), (0.6, 12.0))  # also of other part numbers
_BEAMS_DEG = {
    (1042, 2420, 1435, 2086, 1219, 1228, 2203, 2599, 2659, 2658): ((0.6, 20.0), (0.4, 12.0)),  # M1200d, M3000d
    (1041, 2418, 1433, 2294, 1217, 1229): ((2.0, 20.0), (2.0, 20.0)),  # M370s
    (4713,): ((1.4, 20.0), (0.9, 20.0)),  # C550d
}
# Offsets of frequency, sound speed, data size, ranges, image offset and bearings by version (4.1). The format of the
# start time and the place of the data size behind it differ.
_LAYOUTS = {1: (61, 85, 97, 122), 2: (97, 145, 161, 202)}


def _fire(range_m: float, gain_percent: float, sound_speed_mps: float, high_frequency: bool, beams: int, bits: int,
          rate: int) -> bytes:
    """A SimpleFire of version 2 (3)."""
    flags = _IN_METRES | _SIMPLE | (_SIXTEEN_BIT if bits == 16 else 0) | (_BEAMS_512 if beams == 512 else 0)
    body = struct.pack("<BBBBBdddd", 2 if high_frequency else 1, rate, 0xFF, 0xFF, flags, range_m, gain_percent,
                       sound_speed_mps, 0.0) + bytes(36)
    return struct.pack("<2sHHHHIH", _MAGIC, 0, 0, _FIRE, 2, len(body), 0) + body


def _ping(message: bytes) -> Ping:
    """Decodes a SimplePingResult (4). Raises ValueError if its sizes disagree."""
    version, _, part = struct.unpack_from("<HIH", message, 8)
    version = 2 if version == 2 else 1
    frequency_at, sound_speed_at, size_at, bearings_at = _LAYOUTS[version]
    if len(message) < bearings_at:
        raise ValueError(f"a ping of {len(message)} bytes")
    data_size, row_m, rows, beams = struct.unpack_from("<BdHH", message, size_at)
    image_at, image_bytes, _ = struct.unpack_from("<III", message, bearings_at - 12)
    mode, flags = message[16], message[20]
    gain_bytes = 4 if flags & 0x04 else 0
    width = data_size + 1
    if width not in (1, 2) or image_bytes != rows * (beams * width + gain_bytes) or \
            image_at + image_bytes > len(message) or bearings_at + 2 * beams > image_at:
        raise ValueError(f"an image of {rows} rows of {beams} beams of {width} bytes has {image_bytes} bytes")
    image = np.frombuffer(message, np.uint8, image_bytes, image_at).reshape(rows, -1)[:, gain_bytes:]
    beams_deg = next((of_parts for parts, of_parts in _BEAMS_DEG.items() if part in parts), _M750D_BEAMS_DEG)
    horizontal_deg, vertical_deg = beams_deg[mode != 1]
    return Ping(
        samples=np.ascontiguousarray(image).view("<u2" if width == 2 else np.uint8),
        ranges_m=(np.arange(rows) + 0.5) * row_m,
        bearings_rad=-np.radians(np.frombuffer(message, "<i2", beams, bearings_at) / 100),  # 4.5: to starboard
        transmit_us=_start_us(message, version),
        sound_speed_mps=struct.unpack_from("<d", message, sound_speed_at)[0],
        frequency_hz=struct.unpack_from("<d", message, frequency_at)[0],
        beamwidth_rad=math.radians(horizontal_deg), vertical_beamwidth_rad=math.radians(vertical_deg))


def _start_us(message: bytes, version: int) -> int:
    """pingStartTime: nanoseconds modulo 2^32 in version 1, seconds in version 2."""
    if version == 1:
        return int(struct.unpack_from("<I", message, 93)[0]) // 1000
    return round(1e6 * struct.unpack_from("<d", message, 153)[0])


class Oculus:
    """A client of one head. Use it from one thread at a time.

    host  address of the head; None: that of the first status, which needs UDP port 52102 of this machine
    """

    def __init__(self, host: Optional[str] = None, patience_s: float = 5.0) -> None:
        self.host = host or self._first_status(patience_s)
        try:
            self._socket = socket.create_connection((self.host, COMMAND_PORT), patience_s)
        except OSError as error:
            raise NoHead(f"cannot connect to {self.host}:{COMMAND_PORT}: {error}") from error
        self._buffer = bytearray()

    def __enter__(self) -> Oculus:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._socket.close()

    def ping(self, range_m: float = 20.0, gain_percent: float = 50.0, sound_speed_mps: float = 1500.0,
             high_frequency: bool = False, beams: int = 512, bits: int = 8) -> Ping:
        """The next ping with these settings. The head then continues to ping. Raises NoPing."""
        return next(self.pings(0.1, range_m, gain_percent, sound_speed_mps, high_frequency, beams, bits))

    def pings(self, interval_s: float, range_m: float = 20.0, gain_percent: float = 50.0,
              sound_speed_mps: float = 1500.0, high_frequency: bool = False, beams: int = 512,
              bits: int = 8) -> Iterator[Ping]:
        """Pings that the head sends on its own, until the iterator is closed.

        interval_s  the head has five rates, of 2, 5, 10, 15 and 40 Hz: the slowest that is fast enough is used

        Raises NoPing if no ping arrives.
        """
        rate = next((rate for hertz, rate in _RATES if hertz * interval_s >= 1 - 1e-9), 2)
        fire = _fire(range_m, gain_percent, sound_speed_mps, high_frequency, beams, bits, rate)
        self._socket.sendall(fire)
        while True:
            yield _ping(self._next_ping(fire, 4.0 + 4 * range_m / sound_speed_mps))

    @staticmethod
    def _first_status(patience_s: float) -> str:
        until_s = time.monotonic() + patience_s
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as statuses:
            try:
                statuses.bind(("", STATUS_PORT))
            except OSError as error:
                raise OSError(f"UDP port {STATUS_PORT} of this machine cannot be opened: {error}") from error
            while (left_s := until_s - time.monotonic()) > 0:
                statuses.settimeout(left_s)
                try:
                    status = statuses.recv(2048)
                except (TimeoutError, socket.timeout):
                    break
                if len(status) == _STATUS_BYTES and status[:2] == _MAGIC:
                    return socket.inet_ntoa(status[52:56])  # 6
        raise NoHead(f"no status on UDP port {STATUS_PORT} within {patience_s} s: check that the head is on and sends its "
                     "status here")

    def _next_ping(self, fire: bytes, wait_s: float) -> bytes:
        """The next ping with the settings of `fire`; other messages are dropped. A ping of an earlier fire may still be
        on its way (4.4)."""
        until_s = time.monotonic() + wait_s
        while True:
            message = self._next(until_s)
            if message is None:
                raise NoPing("no ping arrived: check that the head has a pose and is in the water")
            if struct.unpack_from("<H", message, 6)[0] == _PING and len(message) >= 53 and \
                    message[16] == fire[16] and message[20:29] == fire[20:29]:
                return message

    def _next(self, until_s: float) -> Optional[bytes]:
        """The next message; None if the time is over. Bytes that begin no message are skipped (1)."""
        while True:
            start = self._buffer.find(_MAGIC)
            del self._buffer[: start if start >= 0 else max(0, len(self._buffer) - 1)]
            if len(self._buffer) >= _HEADER_BYTES:
                size = _HEADER_BYTES + int(struct.unpack_from("<I", self._buffer, 10)[0])
                if size > _MOST_BYTES:
                    del self._buffer[:1]
                    continue
                if len(self._buffer) >= size:
                    message = bytes(self._buffer[:size])
                    del self._buffer[:size]
                    return message
            left_s = until_s - time.monotonic()
            if left_s <= 0:
                return None
            self._socket.settimeout(left_s)
            try:
                data = self._socket.recv(1 << 20)
            except (TimeoutError, socket.timeout):
                return None
            if not data:
                raise NoHead("the connection was closed")
            self._buffer += data
