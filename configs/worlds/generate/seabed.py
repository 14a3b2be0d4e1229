# SPDX-License-Identifier: Apache-2.0
"""A sandy seabed: long undulation, ripples in patches, and what objects do to it (flats, scour, berms)."""

import bisect
import math

from mesh import Mesh
from noise import layered_noise, smoothstep, value_noise


class Seabed:
    """Height of the bed as a function of x and y, in metres; z = 0 is the water surface."""

    def __init__(self, seed, depth_m, undulation_m, ripple_height_m, ripple_length_m, ripple_heading_rad):
        self.seed = seed
        self.depth_m = depth_m
        self.undulation_m = undulation_m
        self.ripple_height_m = ripple_height_m
        self.ripple_wavenumber = 2.0 * math.pi / ripple_length_m
        self.ripple_axis = (math.cos(ripple_heading_rad), math.sin(ripple_heading_rad))
        self._changes = []  # functions (x, y, height) -> height, in the order they were made

    def natural(self, x, y):
        """The bed without ripples and before anything was put on it: long, low swells.

        Shorter ones would shade and brighten patches of a few metres, which recorded beds hardly show.
        """
        slope = 0.012 * x - 0.008 * y
        return -self.depth_m + slope + self.undulation_m * layered_noise(self.seed, x / 13.0, y / 13.0, 2)

    def ripples(self, x, y):
        """Sharp crests, flat troughs, wandering direction, and patches where they fade out."""
        along = x * self.ripple_axis[0] + y * self.ripple_axis[1]
        wander = 2.2 * value_noise(self.seed + 11, x / 5.0, y / 5.0) + 0.6 * value_noise(self.seed + 12, x / 1.7, y / 1.7)
        phase = self.ripple_wavenumber * along + wander
        shape = math.cos(phase) + 0.3 * math.cos(2.0 * phase + 0.5)
        patch = smoothstep(-0.75, 0.15, value_noise(self.seed + 13, x / 7.0, y / 7.0))
        # The mesh is too coarse for ripples far from the centre.
        near = 1.0 - smoothstep(15.0, 22.0, max(abs(x), abs(y)))
        return 0.5 * self.ripple_height_m * shape * patch * near

    def height(self, x, y):
        z = self.natural(x, y) + self.ripples(x, y)
        for change in self._changes:
            z = change(x, y, z)
        return z

    def flatten(self, centre, half_size, level_m, margin_m):
        """Levels a rectangle, as settled structures and their installation do; eases out over `margin_m`."""

        def change(x, y, z):
            out = math.hypot(max(0.0, abs(x - centre[0]) - half_size[0]), max(0.0, abs(y - centre[1]) - half_size[1]))
            keep = smoothstep(0.0, margin_m, out)
            return level_m * (1.0 - keep) + z * keep

        self._changes.append(change)

    def scour(self, centre, radius_m, depth_m):
        """A pit washed out around an object, with a low ring of what came out of it."""

        def change(x, y, z):
            d = math.hypot(x - centre[0], y - centre[1]) / radius_m
            if d > 3.0:
                return z
            return z - depth_m * math.exp(-d * d) + 0.45 * depth_m * math.exp(-((d - 1.55) / 0.4) ** 2)

        self._changes.append(change)

    def trench(self, line, width_m, depth_m):
        """Pulls the bed to the level of a pipeline's own bed along `line`: (y, bed z) = line(x)."""

        def change(x, y, z):
            centre, bed = line(x)
            d = abs(y - centre) / width_m
            if d > 4.0:
                return z
            pull = math.exp(-d * d)
            z = z * (1.0 - pull) + bed * pull
            return z - depth_m * math.exp(-((d - 0.55) / 0.28) ** 2) + 0.6 * depth_m * math.exp(-((d - 1.5) / 0.45) ** 2)

        self._changes.append(change)

    def mesh(self, half_size_m, fine_half_size_m, spacing_m, growth):
        """Fine near the centre, each step `growth` times wider than the last outside of `fine_half_size_m`."""
        lines = [spacing_m * k for k in range(int(fine_half_size_m / spacing_m) + 1)]
        step = spacing_m
        while lines[-1] < half_size_m:
            step *= growth
            lines.append(min(lines[-1] + step, half_size_m))
        if lines[-1] - lines[-2] < 0.5 * step:
            del lines[-2]
        axis = [-v for v in reversed(lines[1:])] + lines
        bed = Mesh()
        bed.grid([[(x, y, self.height(x, y)) for x in axis] for y in axis])
        return bed


class Line:
    """A quantity sampled along x, read by linear interpolation."""

    def __init__(self, xs, values):
        self.xs, self.values = xs, values

    def __call__(self, x):
        x = min(max(x, self.xs[0]), self.xs[-1])
        k = min(max(bisect.bisect_right(self.xs, x) - 1, 0), len(self.xs) - 2)
        t = (x - self.xs[k]) / (self.xs[k + 1] - self.xs[k])
        return self.values[k] * (1.0 - t) + self.values[k + 1] * t
