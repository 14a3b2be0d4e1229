# SPDX-License-Identifier: Apache-2.0
"""Reads the results that sonard_bench writes."""

import collections
import json


class Results:
    """Values by (scene, engine, preset) and metric; `time` is the metric of curves against time."""

    def __init__(self, path, time="ping_ms"):
        self.time = time
        with open(path, encoding="utf-8") as file:
            rows = json.load(file)
        self.points = collections.defaultdict(dict)
        for row in rows:
            self.points[row["scene"], row["engine"], row["preset"]][row["metric"]] = row["value"]

    def scenes(self):
        return list(dict.fromkeys(scene for scene, _, _ in self.points))

    def engines(self):
        return sorted({engine for _, engine, _ in self.points})

    def of(self, scene, engine):
        """{preset: {metric: value}} in the order of measurement."""
        return {p: values for (s, b, p), values in self.points.items() if (s, b) == (scene, engine)}

    def curve(self, scene, engine, start, x=None, y="bin_rms"):
        """[(x, y, preset)] of the presets whose names start with `start`, sorted by x; x=None is the time."""
        x = x or self.time
        return sorted((values[x], values[y], preset) for preset, values in self.of(scene, engine).items()
                      if preset.startswith(start) and values.get(x, 0) > 0 and values.get(y, 0) > 0)


def pareto(points):
    """The points [(x, y, ...)] that no other point beats in both x and y, sorted by x."""
    front = []
    for point in sorted(points):
        if not front or point[1] < front[-1][1]:
            front.append(point)
    return front
