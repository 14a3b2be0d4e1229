# SPDX-License-Identifier: Apache-2.0
"""Pings of an imaging sonar as NumPy arrays, and poses for sonard.

    from sonard_client import Gemini

    with Gemini() as sonar:                # the head of configs/demo.yaml
        ping = sonar.ping(range_m=20)
    print(ping.samples.shape, ping.ranges_m[-1], ping.bearings_rad[[0, -1]])
"""

from .damage import DamagedLog
from .gemini import Gemini
from .log import read_log
from .micron import Micron
from .ping import LoggedPing, NoHead, NoPing, Ping
from .poses import PosePublisher, encode_pose

__all__ = ["DamagedLog", "Gemini", "LoggedPing", "Micron", "NoHead", "NoPing", "Ping", "PosePublisher", "encode_pose",
           "read_log"]
