# SPDX-License-Identifier: Apache-2.0
"""How the readers of logs report damage."""

from __future__ import annotations

import warnings
from typing import Any


class DamagedLog(UserWarning):
    """Part of a log cannot be read, or its end is missing. The reader skips that part and continues with the next one."""


def warn(path: Any, what: str) -> None:
    warnings.warn(f"{path} is damaged: {what}", DamagedLog, stacklevel=2)


def warn_of_bytes(path: Any, offset: int, size: int, why: str, lost: str) -> None:
    place = f"{size} bytes at byte {offset}" if offset else f"the first {size} bytes"
    warn(path, f"{place} cannot be read ({why}); {lost}")


def warn_of_end(path: Any, tail_bytes: int) -> None:
    """Warns of a log without an end. `tail_bytes` is the size of the unfinished record at its end."""
    tail = f"; the last {tail_bytes} bytes are an incomplete record" if tail_bytes else ""
    warnings.warn(f"{path} is not closed: cut, still being written, or the writing program ended early{tail}", DamagedLog, stacklevel=2)
