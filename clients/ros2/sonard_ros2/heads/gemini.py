# SPDX-License-Identifier: Apache-2.0
"""A Gemini 720i."""

from contextlib import contextmanager

from sonard_client import Gemini

from ..parameter import Parameter

IS_SCANNING = False
PARAMETERS = (
    Parameter("compression", 1, "2^n range lines are averaged into one; Gemini", 0, 4),
    Parameter("sonar_id", 0, "ID of the head; 0: the first whose status arrives; Gemini", 0, 65535),
)


@contextmanager
def connected(options):
    with Gemini(options.sonar_id or None, options.local or None) as head:
        yield (f"Gemini {head.status.sonar_id} at {head.status.address}",
               head.pings(options.interval_s, options.range_m, options.gain_percent, options.sound_speed_mps,
                          options.compression, options.bits))
