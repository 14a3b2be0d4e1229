# SPDX-License-Identifier: Apache-2.0
"""An Oculus."""

from contextlib import contextmanager

from sonard_client import Oculus

from ..parameter import Parameter

IS_SCANNING = False
PARAMETERS = (
    Parameter("oculus_host", "", "address of the Oculus; empty: the first whose status arrives"),
    Parameter("beams", 512, "number of beams; Oculus", choices=(256, 512)),
)


@contextmanager
def connected(options):
    with Oculus(options.oculus_host or None) as head:
        yield (f"Oculus at {head.host}",
               head.pings(options.interval_s, options.range_m, options.gain_percent, options.sound_speed_mps,
                          options.high_frequency, options.beams, options.bits))
