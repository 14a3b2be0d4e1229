# SPDX-License-Identifier: Apache-2.0
"""A client for a Blue Robotics Ping1D or Ping2 by UDP. Section numbers in comments refer to protocol/ping1d/README.md."""

from __future__ import annotations

import math
import struct
import time
from dataclasses import dataclass
from typing import Iterator, Optional

import numpy as np

from .ping import NoPing, Ping
from .ping_head import ATTEMPTS, GENERAL_REQUEST, PingHead

_ACK, _INFORMATION, _PROFILE, _START, _STOP = 1, 4, 1300, 1400, 1401
_SET_RANGE, _SET_SPEED, _SET_AUTO, _SET_INTERVAL, _SET_GAIN, _SET_ENABLE = 1001, 1002, 1003, 1004, 1005, 1006
_MEASUREMENT = struct.Struct("<IHHIIIIH")  # 2.3, with the count of the points
_FREQUENCY_HZ = 115e3
_BEAMWIDTH_RAD = {1: math.radians(30), 2: math.radians(25)}  # by revision (3.4)
_PING_WAIT_S = 2.0
_MOST_LATE = 16  # pings


@dataclass(frozen=True)
class Sounding(Ping):
    """A ping of an echo sounder: its profile, and the distance that the head has found in it.

    samples             (points, 1): amplitude, nearest first. `ranges_m` is their middle
    distance_m          distance of the strongest echo; without an echo, that of the last one
    confidence_percent  0: there is no echo
    number              of the ping since the start of the head
    """

    distance_m: float = math.nan
    confidence_percent: int = 0
    number: int = 0


class Ping1D(PingHead):
    """A client of one head at HOST:PORT, which streams pings. Use it from one thread at a time."""

    def __init__(self, host: str = "127.0.0.1", port: int = 9090, patience_s: float = 5.0) -> None:
        super().__init__(host, port, patience_s)
        information = self._ask(GENERAL_REQUEST, struct.pack("<H", _INFORMATION), _INFORMATION, patience_s)
        self.revision = information[1] if information else 1  # 1 Ping1D, 2 Ping2

    def close(self) -> None:
        """Ends the stream, too."""
        try:
            self._send(_STOP, struct.pack("<H", _PROFILE))
        except OSError:
            pass  # the socket is closed, or the head is gone
        super().close()

    def ping(self, **settings: float) -> Sounding:
        """The next ping with these settings of pings()."""
        return next(self.pings(**settings))

    def pings(self, range_m: float = 0.0, start_m: float = 0.0, gain: int = 3, interval_s: float = 0.1,
              sound_speed_mps: float = 1500.0) -> Iterator[Sounding]:
        """Yields ping after ping, until the iterator is closed.

        range_m  length of the scan from start_m, 1 to 100; 0: the head chooses range and gain, and start_m and gain do not
                 count

        Raises NoPing if no pings arrive, ValueError if the head refuses a setting.
        """
        self._set(_SET_ENABLE, struct.pack("<B", 1))
        self._set(_SET_INTERVAL, struct.pack("<H", round(1e3 * interval_s)))
        self._set(_SET_SPEED, struct.pack("<I", round(1e3 * sound_speed_mps)))
        self._set(_SET_AUTO, struct.pack("<B", range_m == 0))
        scan: Optional[tuple[int, int]] = None
        if range_m > 0:
            scan = round(1e3 * start_m), round(1e3 * range_m)
            self._set(_SET_RANGE, struct.pack("<II", *scan))
            self._set(_SET_GAIN, struct.pack("<B", gain))
        last = -1
        asked_s = -math.inf
        while True:
            if time.monotonic() > asked_s + 1.0:  # as ArduPilot: the command may be lost, and a head forgets silent clients
                self._send(_START, struct.pack("<H", _PROFILE))
                asked_s = time.monotonic()
            payload = self._receive(_PROFILE, _PING_WAIT_S)
            sounding = None if payload is None else self._sounding(payload, scan, sound_speed_mps)
            if payload is None:
                raise NoPing("no ping arrived: check that the head has a pose and is in the water")
            # A link may deliver a ping twice or late. Much smaller numbers are those of a head that has restarted.
            if sounding is not None and not last - _MOST_LATE < sounding.number <= last:
                last = sounding.number
                yield sounding

    def _set(self, message: int, payload: bytes) -> None:
        """Sends a setting until it is acknowledged. Some firmware sends no ack, so that time alone is no error (3.2)."""
        for _ in range(ATTEMPTS):
            if self._ask(message, payload, _ACK, 0.2, lambda ack: ack == struct.pack("<H", message)) is not None:
                return

    def _sounding(self, payload: bytes, scan: Optional[tuple[int, int]], sound_speed_mps: float) -> Optional[Sounding]:
        """The ping in a profile; None if it is broken, or was under way when the scan was set."""
        if len(payload) < _MEASUREMENT.size:
            return None
        distance, confidence, _, number, start, length, _, count = _MEASUREMENT.unpack_from(payload)
        points = np.frombuffer(payload[_MEASUREMENT.size:], np.uint8)
        if points.size != count or (scan is not None and (start, length) != scan):
            return None
        beam_rad = _BEAMWIDTH_RAD.get(self.revision, _BEAMWIDTH_RAD[1])
        ranges_m = 1e-3 * (start + (np.arange(count) + 0.5) * (length / max(count, 1)))
        return Sounding(samples=points[:, None], ranges_m=ranges_m, bearings_rad=np.zeros(1), transmit_us=None,
                        sound_speed_mps=sound_speed_mps, frequency_hz=_FREQUENCY_HZ, beamwidth_rad=beam_rad,
                        vertical_beamwidth_rad=beam_rad, distance_m=1e-3 * distance, confidence_percent=confidence,
                        number=number)
