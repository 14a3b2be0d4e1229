# SPDX-License-Identifier: Apache-2.0
"""A host for a Tritech Micron behind a device server (TCP). Section numbers in comments refer to
protocol/micron/README.md."""

from __future__ import annotations

import math
import socket
import struct
import time
from typing import Iterator, Optional

import numpy as np

from .ping import Array, NoHead, NoPing, Ping, turn_of

_TURN = 6400  # units of bearing (4)
_AHEAD = 3200
_AD_INTERVAL_S = 640e-9
_HEAD, _HOST = 2, 0xFF
_SEND_VERSION, _SEND_USER_BLOCKS, _SEND_DATA, _HEAD_COMMAND = 23, 24, 25, 19
_HEAD_DATA, _ALIVE = 2, 4
_LINE_WAIT_S = 1.0
_FREQUENCY_HZ = 700e3  # 10
_BEAMWIDTH_RAD, _VERTICAL_BEAMWIDTH_RAD = math.radians(3), math.radians(35)
_MISSES = 5


def _frame(message_type: int, data: bytes = b"") -> bytes:
    """Encodes a frame (2.1)."""
    length = 8 + len(data)
    head = b"@%04X" % length + struct.pack("<HBB", length, _HOST, _HEAD)
    return head + struct.pack("<BBBB", (length - 5) & 0xFF, message_type, 0x80, _HEAD) + data + b"\n"


def _frames(buffer: bytearray) -> Iterator[bytes]:
    """Removes whole frames from the received bytes (2.3)."""
    while len(buffer) >= 7:
        (length,) = struct.unpack_from("<H", buffer, 5)
        try:
            agree = buffer[0] == 0x40 and int(buffer[1:5], 16) == length and 8 <= length <= 4090
        except ValueError:
            agree = False
        if agree and len(buffer) < length + 6:
            return
        if agree and buffer[length + 5] == 0x0A:
            yield bytes(buffer[: length + 6])
            del buffer[: length + 6]
        else:
            del buffer[:1]


def _units(bearing_rad: float) -> int:
    return round(_AHEAD - bearing_rad * _TURN / (2 * math.pi)) % _TURN


def _bearing_rad(units: int) -> float:
    """Positive to port, within half a turn of ahead."""
    return (_AHEAD - units) * 2 * math.pi / _TURN


class Micron:
    """A client of one head at HOST:PORT. Use it from one thread at a time."""

    def __init__(self, host: str = "127.0.0.1", port: int = 4001, patience_s: float = 5.0) -> None:
        try:
            self._socket = socket.create_connection((host, port), patience_s)
        except OSError as error:
            raise NoHead(f"cannot connect to {host}:{port}: {error}") from error
        self._buffer = bytearray()
        self._ready: list[bytes] = []
        try:
            self._greet(patience_s)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Micron:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._socket.close()

    def turn(self, range_m: float = 20.0, bins: int = 400, step_deg: float = 1.8, gain_percent: float = 50.0,
             sound_speed_mps: float = 1500.0) -> Ping:
        """The lines of one full turn, clockwise from the head's present bearing. `bearings_rad` has the bearing of each."""
        return turn_of(self.lines(range_m, bins, step_deg, gain_percent, sound_speed_mps))

    def lines(self, range_m: float = 20.0, bins: int = 400, step_deg: float = 1.8, gain_percent: float = 50.0,
              sound_speed_mps: float = 1500.0, sector_rad: Optional[tuple[float, float]] = None) -> Iterator[Ping]:
        """Yields line after line, each as a ping of one beam, until the iterator is closed.

        sector_rad  two bearings, the port one first; the head scans to and fro between them. None: full turns.

        Raises NoPing if no lines arrive.
        """
        interval = min(max(round(2 * range_m / sound_speed_mps / bins / _AD_INTERVAL_S), 1), 0xFFFF)
        parameters = self._parameters(interval, bins, step_deg, gain_percent, range_m, sector_rad)
        ranges_m = (np.arange(bins) + 0.5) * (interval * _AD_INTERVAL_S * sound_speed_mps / 2)
        self._set(parameters)
        misses = 0
        while True:
            # One request after each line. In half duplex, a request returns one line; in full duplex, it returns two,
            # and the head owes at most four (8.1, 8.2).
            self._socket.sendall(_frame(_SEND_DATA, struct.pack("<I", 0)))
            frame = self._next(_HEAD_DATA, _LINE_WAIT_S)
            if frame is None:
                misses += 1
                if misses == _MISSES:
                    raise NoPing("no line arrived: check that the head has a pose and is in the water")
                continue
            misses = 0
            if struct.unpack_from("<H", frame, 33)[0] == interval and self._bins(frame).size == bins:
                (units,) = struct.unpack_from("<H", frame, 40)
                yield Ping(samples=self._bins(frame)[:, None], ranges_m=ranges_m,
                           bearings_rad=np.array([_bearing_rad(units)]), transmit_us=None,
                           sound_speed_mps=sound_speed_mps, frequency_hz=_FREQUENCY_HZ, beamwidth_rad=_BEAMWIDTH_RAD,
                           vertical_beamwidth_rad=_VERTICAL_BEAMWIDTH_RAD)

    @staticmethod
    def _bins(frame: bytes) -> Array:
        (count,) = struct.unpack_from("<H", frame, 42)
        return np.frombuffer(frame[44: 44 + count], np.uint8)

    @staticmethod
    def _parameters(interval: int, bins: int, step_deg: float, gain_percent: float, range_m: float,
                    sector_rad: Optional[tuple[float, float]]) -> bytes:
        """The head command (5.3), for 8-bit bins."""
        left, right = (0, _TURN - 1) if sector_rad is None else (_units(sector_rad[0]), _units(sector_rad[1]))
        control = 0x2305 | (2 if sector_rad is None else 0)  # 5.4
        gain = round(2.1 * gain_percent)
        return b"\x01" + struct.pack("<HB4I", control, 2, 0, 0, 0, 0) + struct.pack(
            "<HHHHBBBBHHBBHHHHBBBH", 25, round(10 * range_m) & 0x3FFF, left, right, 81, 8, gain, gain, 125, 125, 25,
            round(step_deg * _TURN / 360), interval, bins, 1000, 100, 0, 1, 0, 0) + b"\0"

    # ---- The stream

    def _greet(self, patience_s: float) -> None:
        """The start-up that the device expects: an alive, version, user blocks (9)."""
        if self._next(_ALIVE, patience_s) is None:
            raise NoHead(f"no alive within {patience_s} s: check that the head is a Micron and is on")
        self._socket.sendall(_frame(_SEND_VERSION))
        self._socket.sendall(_frame(_SEND_USER_BLOCKS))

    def _set(self, parameters: bytes) -> None:
        """Sends the parameters until an alive confirms them (7.2)."""
        for _ in range(_MISSES):
            self._socket.sendall(_frame(_HEAD_COMMAND, parameters))
            until_s = time.monotonic() + _LINE_WAIT_S
            while (alive := self._next(_ALIVE, until_s - time.monotonic())) is not None:
                if not alive[20] & 0x40:
                    return
        raise NoHead("the head did not accept its parameters")

    def _next(self, message_type: int, wait_s: float) -> Optional[bytes]:
        """The next message of this type; others are dropped. None if the time is over."""
        until_s = time.monotonic() + wait_s
        while True:
            while self._ready:
                frame = self._ready.pop(0)
                if frame[10] == message_type:
                    return frame
            left_s = until_s - time.monotonic()
            if left_s <= 0:
                return None
            self._socket.settimeout(left_s)
            try:
                data = self._socket.recv(65536)
            except (TimeoutError, socket.timeout):
                return None
            if not data:
                raise NoHead("the connection was closed")
            self._buffer += data
            self._ready += _frames(self._buffer)
