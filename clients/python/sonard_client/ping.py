# SPDX-License-Identifier: Apache-2.0
"""One ping, whichever sonar it is of."""

from dataclasses import dataclass, field
from typing import Any, Optional

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]


class NoHead(TimeoutError):
    """No head is there, or it does not answer."""


class NoPing(TimeoutError):
    """A ping did not come, or not whole."""


@dataclass(frozen=True)
class Ping:
    """What a sonar has sent of one ping.

    samples       (bins, beams), uint8 or uint16: row after row from near to far; of a multibeam head beams from port to
                  starboard, of a scanning head one for each line, in the order in which they came
    ranges_m      (bins,): the middle of each row, from the speed of sound that was asked for
    bearings_rad  (beams,): of each beam: 0 ahead, positive to port as in REP-103
    transmit_us   when it was sent, by the clock of the head since its start; None of a head that does not say it
    missing       rows that never came, which are 0
    """

    samples: Array
    ranges_m: Array
    bearings_rad: Array
    transmit_us: Optional[int]
    missing: int = 0


def _unknown(size: int) -> Array:
    return np.full(size, np.nan)


@dataclass(frozen=True)
class LoggedPing(Ping):
    """A ping, or a line of a scanning head, as it was recorded.

    head                   its name in the configuration; in a .glf the number of the sonar
    time_ns                when it was sent, since the Unix epoch
    sonar_position_m       of the sonar in the world, (3,); not a number in a .glf, which has none
    sonar_quaternion_xyzw  likewise; the real part last
    """

    head: str = ""
    time_ns: int = 0
    sonar_position_m: Array = field(default_factory=lambda: _unknown(3))
    sonar_quaternion_xyzw: Array = field(default_factory=lambda: _unknown(4))
