# SPDX-License-Identifier: Apache-2.0
"""Collects the lines of a scanning head that turns without end."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Optional

import numpy as np

from .ping import Array, Ping


class TurnCollector:
    """A picture of all round, with the last line at each bearing. Columns are evenly spaced, port first, and have straight
    ahead in the middle; a bearing between two columns belongs to the nearer one. A column that no line has reached is 0."""

    def __init__(self, step_rad: float) -> None:
        self._columns = max(1, round(2 * math.pi / step_rad))
        step_rad = 2 * math.pi / self._columns
        self._bearings_rad: Array = (self._columns // 2 - np.arange(self._columns)) * step_rad
        self._step_rad = step_rad
        self._samples: Optional[Array] = None
        self._lines = 0

    def add(self, line: Ping) -> Optional[Ping]:
        """Returns a turn each time when as many lines as it has columns have come."""
        if self._samples is None or self._samples.shape[0] != len(line.samples) or self._samples.dtype != line.samples.dtype:
            self._samples = np.zeros((len(line.samples), self._columns), line.samples.dtype)
            self._lines = 0
        column = self._columns // 2 - round(float(line.bearings_rad[0]) / self._step_rad)
        self._samples[:, column % self._columns] = line.samples[:, 0]
        self._lines += 1
        if self._lines % self._columns:
            return None
        return replace(line, samples=self._samples.copy(), bearings_rad=self._bearings_rad)
