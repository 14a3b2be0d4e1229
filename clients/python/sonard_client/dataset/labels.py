# SPDX-License-Identifier: Apache-2.0
"""Classes of bodies."""

from __future__ import annotations

from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Iterable, Iterator, Optional

import numpy as np

from .folders import Frame

Instance = tuple[str, int, Any]  # body, index of its class, its mask


class Labels:
    def __init__(self, patterns: Iterable[tuple[str, Optional[str]]]) -> None:
        """Pattern of bodies' names (* ? [...]) and class; None: background. The first pattern that matches counts."""
        self._patterns = list(patterns)
        self.classes = list(dict.fromkeys(name for _, name in self._patterns if name is not None))

    def index_of(self, body: str) -> Optional[int]:
        """Index in `classes`; None: background."""
        name = next((name for pattern, name in self._patterns if fnmatchcase(body, pattern)), None)
        return None if name is None else self.classes.index(name)

    def without_body(self, bodies: Iterable[str]) -> list[str]:
        """Patterns that match none of these bodies."""
        names = list(bodies)
        return [pattern for pattern, _ in self._patterns if not any(fnmatchcase(body, pattern) for body in names)]

    def instances(self, frame: Frame, mask: Any, least_pixels: int = 1) -> Iterator[Instance]:
        """The bodies with a class in a mask of the frame."""
        bodies = frame.bodies()
        pixels = np.bincount(mask.ravel())
        for number in np.flatnonzero(pixels >= least_pixels):
            if number == 0:
                continue
            if number not in bodies:
                raise ValueError(f"{frame.path}: {frame.name} has no body {number}")
            index = self.index_of(bodies[number])
            if index is not None:
                yield bodies[number], index, mask == number


def labels_of_bodies(bodies: Iterable[str]) -> Labels:
    """A class for each body."""
    return Labels((name.replace("[", "[[]").replace("*", "[*]").replace("?", "[?]"), name) for name in bodies)


def read_labels(path: Path) -> Labels:
    """A YAML mapping from pattern to class. Needs PyYAML; raises ValueError or OSError."""
    import yaml

    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except yaml.YAMLError as error:
        raise ValueError(f"{path}: {error}") from None
    if not isinstance(content, dict) or not all(isinstance(pattern, str) and (name is None or isinstance(name, str) and name)
                                                for pattern, name in content.items()):
        raise ValueError(f"{path}: expected lines of PATTERN: CLASS, with quotes around a pattern that begins with *")
    return Labels(content.items())
