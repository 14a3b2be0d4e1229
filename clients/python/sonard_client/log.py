# SPDX-License-Identifier: Apache-2.0
"""Reads pings of recorded logs in any format."""

from __future__ import annotations

import mmap
import re
from datetime import timezone, tzinfo
from os import PathLike
from typing import Iterator, Optional, Union

from . import glf_log, mcap_log
from .ping import LoggedPing


def read_log(path: Union[str, PathLike[str]], glf_zone: Optional[tzinfo] = timezone.utc) -> Iterator[LoggedPing]:
    """The pings of an .mcap, .glf or .dat file in the order of recording, also of an .mcap or .dat that is still being
    written.

    glf_zone: time zone of the clock of a .glf or .dat, which the file does not state. sonard writes UTC by default; None is
    the zone of this machine. Checksums are checked. The pings of a damaged part are lost. A damaged part, or a missing end, is
    reported as a DamagedLog warning (`warnings.simplefilter("error", DamagedLog)` makes it an exception). Raises ValueError if
    the file is no log.
    """
    with open(path, "rb") as file:
        begins = file.read(8)
        data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) if begins else b""
        form = _form(begins, str(path))
        if form == ".mcap":
            yield from mcap_log.pings(data, path)
        elif form == ".glf":
            yield from glf_log.pings_of_glf(data, path, glf_zone)
        elif form == ".dat":
            yield from glf_log.pings_of_dat(data, path, glf_zone)
        else:
            raise ValueError(f"{path} is not a .mcap, .glf or .dat log")


_FORMS = {".mcap": mcap_log.MAGIC, ".glf": glf_log.MAGIC_OF_GLF, ".dat": glf_log.MAGIC_OF_DAT}


def _form(begins: bytes, name: str) -> Optional[str]:
    """The format by the first bytes. If one of them is damaged, or a .dat is empty, the name decides. It also decides for an
    .mcap with any damage there, whose reader searches for the first readable record."""
    name = re.sub(r"\.damaged(-\d+)?$", "", name)  # as a recorder names a damaged log
    for form, magic in _FORMS.items():
        if begins.startswith(magic):
            return form
    for form, magic in _FORMS.items():
        if name.endswith(form) and sum(a != b for a, b in zip(begins, magic)) == 1:
            return form
    if begins.startswith(glf_log.TERMINATOR):
        return ".dat"  # closed without records
    if begins and name.endswith(".mcap"):
        return ".mcap"
    return ".dat" if not begins and name.endswith(".dat") else None
