# SPDX-License-Identifier: Apache-2.0
"""What the user of to_dataset chose, and what a data set holds."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Iterable, Optional

from .folders import Folder
from .labels import Instance, Labels


@dataclass(frozen=True)
class Choices:
    labels: Labels
    formats: tuple[str, ...]
    picture: str = "grey"  # or "fan"
    floor_db: Optional[float] = None
    least_pixels: int = 1
    title: str = ""
    licence: str = ""


@dataclass
class Split:
    name: str
    folders: list[Folder]
    frames: Counter[str] = field(default_factory=Counter)  # by folder
    instances: Counter[int] = field(default_factory=Counter)  # by class

    def count(self, folder: str, instances: Iterable[Instance]) -> None:
        self.frames[folder] += 1
        self.instances.update(index for _, index, _ in instances)
