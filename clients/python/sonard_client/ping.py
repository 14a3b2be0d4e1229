# SPDX-License-Identifier: Apache-2.0
"""One ping, whichever sonar it is of."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Ping:
    """What a sonar has sent of one ping.

    samples       (bins, beams), uint8 or uint16: row after row from near to far, beams from port to starboard
    ranges_m      (bins,): the middle of each row, from the speed of sound that was asked for
    bearings_rad  (beams,): 0 ahead, positive to port as in REP-103, so from positive to negative
    transmit_us   when it was sent, by the clock of the head since its start
    missing       rows that never came, which are 0
    """

    samples: np.ndarray
    ranges_m: np.ndarray
    bearings_rad: np.ndarray
    transmit_us: int
    missing: int = 0
