# SPDX-License-Identifier: Apache-2.0
"""A client for a Blue Robotics Ping360 by UDP. Section numbers in comments refer to protocol/ping360/README.md."""

from __future__ import annotations

import math
import struct
from typing import Iterator

import numpy as np

from .ping import Array, NoPing, Ping, turn_of
from .ping_head import ATTEMPTS, PingHead

_TURN = 400  # gradians, clockwise from above
_TICK_S = 25e-9  # unit of the sample period
_SHORTEST_PERIOD, _LONGEST_PERIOD = 80, 40000  # 2.3
_DEVICE_DATA, _TRANSDUCER = 2300, 2601
_FREQUENCY_KHZ = 750
_BEAMWIDTH_RAD, _VERTICAL_BEAMWIDTH_RAD = math.radians(2), math.radians(25)


def _pulse_us(range_m: float, period: int, sound_speed_mps: float) -> int:
    """Length of the pulse as public clients choose it: longer for a longer range, and at least 2.5 samples."""
    sample_us = 1e6 * period * _TICK_S
    wanted_us = max(round(8000 * range_m / sound_speed_mps), 2.5 * sample_us)
    return int(min(max(wanted_us, 5), 500, 64 * sample_us))


class Ping360(PingHead):
    """A client of one head at HOST:PORT, which it commands ping by ping. Use it from one thread at a time."""

    def __init__(self, host: str = "127.0.0.1", port: int = 12345, patience_s: float = 5.0) -> None:
        super().__init__(host, port, patience_s)

    def turn(self, range_m: float = 20.0, bins: int = 1000, step_deg: float = 1.8, gain_percent: float = 50.0,
             sound_speed_mps: float = 1500.0) -> Ping:
        """The lines of one full turn, clockwise from straight ahead. `bearings_rad` has the bearing of each."""
        return turn_of(self.lines(range_m, bins, step_deg, gain_percent, sound_speed_mps))

    def lines(self, range_m: float = 20.0, bins: int = 1000, step_deg: float = 1.8, gain_percent: float = 50.0,
              sound_speed_mps: float = 1500.0) -> Iterator[Ping]:
        """Yields line after line, each as a ping of one beam, until the iterator is closed. The head turns in steps of 0.9
        degrees, has at most 1200 bins, of at least 2 us, and three gains: 0, 50, 100 %.

        Raises NoPing if no lines arrive, ValueError if the head refuses a setting.
        """
        period = min(max(round(2 * range_m / sound_speed_mps / bins / _TICK_S), _SHORTEST_PERIOD), _LONGEST_PERIOD)
        step = min(max(round(step_deg * _TURN / 360), 1), _TURN)
        front = struct.pack("<BB", 1, round(gain_percent / 50))
        settings = struct.pack("<HHHHBB", _pulse_us(range_m, period, sound_speed_mps), period, _FREQUENCY_KHZ,
                               min(bins, 1200), 1, 0)
        ranges_m = (np.arange(min(bins, 1200)) + 0.5) * (period * _TICK_S * sound_speed_mps / 2)
        angle = 0
        while True:
            yield Ping(samples=self._samples(front + struct.pack("<H", angle) + settings)[:, None], ranges_m=ranges_m,
                       bearings_rad=np.array([_bearing_rad(angle)]), transmit_us=None, sound_speed_mps=sound_speed_mps,
                       frequency_hz=1e3 * _FREQUENCY_KHZ, beamwidth_rad=_BEAMWIDTH_RAD,
                       vertical_beamwidth_rad=_VERTICAL_BEAMWIDTH_RAD)
            angle = (angle + step) % _TURN

    def _samples(self, command: bytes) -> Array:
        """Samples of the answer to a transducer command, which is sent again until an answer with its settings comes."""
        _, gain, angle, *settings = struct.unpack("<BBHHHHHBB", command)
        wanted = (gain, angle, *settings[:4])
        for _ in range(ATTEMPTS):
            payload = self._ask(_TRANSDUCER, command, _DEVICE_DATA, 2.0, lambda answer: _answers(answer, wanted))
            if payload is not None:
                return np.frombuffer(payload[14:], np.uint8)
        raise NoPing("no ping arrived: check that the head has a pose and is in the water")


def _answers(payload: bytes, settings: tuple[int, ...]) -> bool:
    """Whether device_data (2.2) has these settings, and a byte for each sample."""
    return len(payload) >= 14 and struct.unpack_from("<BHHHHH", payload, 1) == settings and \
        len(payload) == 14 + settings[-1] == 14 + struct.unpack_from("<H", payload, 12)[0]


def _bearing_rad(angle: int) -> float:
    """Positive to port, within half a turn of ahead."""
    return -((angle + _TURN // 2) % _TURN - _TURN // 2) * 2 * math.pi / _TURN
