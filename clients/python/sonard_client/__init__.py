# SPDX-License-Identifier: Apache-2.0
"""Pings of an imaging sonar as NumPy arrays.

    from sonard_client import Gemini

    with Gemini() as sonar:                # the head of configs/demo.yaml
        ping = sonar.ping(range_m=20)
    print(ping.samples.shape, ping.ranges_m[-1], ping.bearings_rad[[0, -1]])
"""

from .gemini import Gemini, NoHead, NoPing
from .ping import Ping

__all__ = ["Gemini", "NoHead", "NoPing", "Ping"]
