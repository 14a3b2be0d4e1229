# SPDX-License-Identifier: Apache-2.0
"""Pings of recorded logs, whatever the format."""

from __future__ import annotations

from datetime import timezone, tzinfo
from os import PathLike
from typing import Iterator, Optional, Union

from . import glf_log, mcap_log
from .ping import LoggedPing


def read_log(path: Union[str, PathLike[str]], glf_zone: Optional[tzinfo] = timezone.utc) -> Iterator[LoggedPing]:
    """The pings of an .mcap, .glf or .dat file in the order in which they were recorded, also of an .mcap or .dat that is
    still being written.

    glf_zone: of the clock of a .glf or .dat, which does not say it. sonard writes UTC unless it is told otherwise; None is
    the zone of this machine. Raises ValueError where it is no such file, or is damaged.
    """
    with open(path, "rb") as file:
        begins = file.read(8)
        file.seek(0)
        if begins == mcap_log.MAGIC:
            yield from mcap_log.pings(file, path)
        elif begins.startswith(glf_log.MAGIC_OF_GLF):
            yield from glf_log.pings_of_glf(file, path, glf_zone)
        elif begins.startswith(glf_log.MAGIC_OF_DAT):
            yield from glf_log.pings_of_dat(file, path, glf_zone)
        else:
            raise ValueError(f"{path} is no .mcap, .glf or .dat log")
