# SPDX-License-Identifier: Apache-2.0
"""Pings of an imaging sonar as NumPy arrays, and poses for sonard.

    from sonard_client import Gemini

    with Gemini() as sonar:                # the head of configs/demo.yaml
        ping = sonar.ping(range_m=20)
    print(ping.samples.shape, ping.ranges_m[-1], ping.bearings_rad[[0, -1]])

PosePublisher, MovingBody and encode_pose() need no NumPy. All other names do, when they are first used.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .poses import MovingBody, PosePublisher, encode_pose

if TYPE_CHECKING:
    from .damage import DamagedLog
    from .gemini import Gemini
    from .log import read_log
    from .micron import Micron
    from .oculus import Oculus
    from .ping import LoggedPing, NoHead, NoPing, Ping
    from .ping1d import Ping1D, Sounding
    from .ping360 import Ping360
    from .sonar3d15 import Shot, Sonar3D15, read_sonar_file

__all__ = ["DamagedLog", "Gemini", "LoggedPing", "Micron", "MovingBody", "NoHead", "NoPing", "Oculus", "Ping", "Ping1D",
           "Ping360", "PosePublisher", "Shot", "Sonar3D15", "Sounding", "encode_pose", "read_log", "read_sonar_file"]

_MODULES = {"DamagedLog": "damage", "Gemini": "gemini", "LoggedPing": "ping", "Micron": "micron", "NoHead": "ping",
            "NoPing": "ping", "Oculus": "oculus", "Ping": "ping", "Ping1D": "ping1d", "Ping360": "ping360", "Shot": "sonar3d15",
            "Sonar3D15": "sonar3d15", "Sounding": "ping1d", "read_log": "log", "read_sonar_file": "sonar3d15"}


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module("." + _MODULES[name], __name__), name)
