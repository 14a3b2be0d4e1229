# SPDX-License-Identifier: Apache-2.0
"""One ping of any sonar."""

import math
from dataclasses import dataclass, field
from typing import Any, Iterable, Optional

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]


class NoHead(TimeoutError):
    """No head was found, or it does not answer."""


class NoPing(TimeoutError):
    """A ping did not arrive, or not completely."""


@dataclass(frozen=True)
class Ping:
    """The data of one ping.

    samples       (bins, beams), uint8 or uint16: row after row from near to far. Beams of a multibeam head are ordered
                  from port to starboard. A scanning head has one for each line, in the order of arrival
    ranges_m      (bins,): the middle of each row, for the requested speed of sound
    bearings_rad  (beams,): 0 ahead, positive to port as in REP-103
    transmit_us   transmit time by the clock of the head since its start; None if the head does not send it
    missing       number of rows that never arrived; their samples are 0
    sound_speed_mps, frequency_hz  speed of sound behind `ranges_m`, and frequency of the sound; 0: unknown
    beamwidth_rad, vertical_beamwidth_rad  -3 dB widths of each beam; 0: unknown
    """

    samples: Array
    ranges_m: Array
    bearings_rad: Array
    transmit_us: Optional[int]
    missing: int = 0
    sound_speed_mps: float = 0.0
    frequency_hz: float = 0.0
    beamwidth_rad: float = 0.0
    vertical_beamwidth_rad: float = 0.0


def turn_of(lines: Iterable[Ping]) -> Ping:
    """Joins the lines of one clockwise turn, a column for each."""
    joined: list[Ping] = []
    turned = 0.0
    for line in lines:
        if joined:
            turned += (joined[-1].bearings_rad[0] - line.bearings_rad[0]) % (2 * math.pi)
        if turned > 2 * math.pi - 1e-6:
            break
        joined.append(line)
    first = joined[0]
    return Ping(np.hstack([line.samples for line in joined]), first.ranges_m,
                np.concatenate([line.bearings_rad for line in joined]), None, sound_speed_mps=first.sound_speed_mps,
                frequency_hz=first.frequency_hz, beamwidth_rad=first.beamwidth_rad,
                vertical_beamwidth_rad=first.vertical_beamwidth_rad)


def is_plausible_time(time_ns: int) -> bool:
    """Whether a time of a log is within 146 years of 1970. `sonard info` has the same limit."""
    return abs(time_ns) < 1 << 62


def _unknown(size: int) -> Array:
    return np.full(size, np.nan)


@dataclass(frozen=True)
class LoggedPing(Ping):
    """A recorded ping, or a line of a scanning head.

    head                   its name in the configuration; in a .glf the number of the sonar
    time_ns                transmit time since the Unix epoch
    sonar_position_m       position of the sonar in the world, (3,); NaN in a .glf, which has no poses
    sonar_quaternion_xyzw  orientation of the sonar in the world, (4,), real part last; NaN in a .glf
    """

    head: str = ""
    time_ns: int = 0
    sonar_position_m: Array = field(default_factory=lambda: _unknown(3))
    sonar_quaternion_xyzw: Array = field(default_factory=lambda: _unknown(4))
