# SPDX-License-Identifier: Apache-2.0
"""A concrete-coated pipeline on the seabed: field joints, anodes, and concrete mattresses laid over it."""

import math

from mesh import Mesh, add, cross, scaled, unit
from noise import uniform
from seabed import Line


class Pipeline:
    """Runs along x. `sway(x)` is its y; the bed under it is the natural seabed, averaged as a stiff pipe does."""

    def __init__(self, seabed, sway, start_x, end_x, diameter_m, burial, trench_m=0.07):
        """`burial` is the share of the diameter below the bed: a function of x. Beside the pipe the bed is washed out
        to a depth of `trench_m`."""
        self.seabed, self.sway = seabed, sway
        self.start_x, self.end_x = start_x, end_x
        self.radius = 0.5 * diameter_m
        xs = [start_x - 4.0 + 0.5 * k for k in range(int((end_x - start_x + 8.0) / 0.5) + 1)]
        raw = [seabed.natural(x, sway(x)) for x in xs]
        window = 8
        smooth = [sum(raw[max(0, k - window):k + window + 1]) / len(raw[max(0, k - window):k + window + 1])
                  for k in range(len(xs))]
        self.bed = Line(xs, smooth)
        self.burial = burial
        seabed.trench(lambda x: (sway(x), self.bed(x)), 2.6 * self.radius, trench_m)

    def centre(self, x):
        return (x, self.sway(x), self.bed(x) + self.radius * (1.0 - 2.0 * self.burial(x)))

    def direction(self, x):
        a, b = self.centre(x - 0.05), self.centre(x + 0.05)
        return unit((b[0] - a[0], b[1] - a[1], b[2] - a[2]))

    def pipe_mesh(self, sides=22):
        """The coated pipe; every 12.2 m a field joint where the coating is thinner."""
        mesh = Mesh()
        path, radii = [], []
        x = self.start_x
        while x < self.end_x:
            joint = (x - self.start_x) % 12.2 < 0.5 and x + 1.0 < self.end_x
            for offset, radius in ((0.0, 1.0), (0.04, 0.88), (0.70, 0.88), (0.74, 1.0)) if joint else ((0.0, 1.0),):
                path.append(self.centre(x + offset))
                radii.append(self.radius * radius)
            x += 1.0 if joint else 0.6
        path.append(self.centre(self.end_x))
        radii.append(self.radius)
        mesh.sweep(path, radii, sides)
        return mesh

    def band(self, mesh, x, length_m, thickness_m, sides=22):
        """A ring around the pipe: anode bracelet or clamp."""
        axis = self.direction(x)
        centre = self.centre(x)
        mesh.tube(add(centre, scaled(axis, -0.5 * length_m)), add(centre, scaled(axis, 0.5 * length_m)),
                  self.radius + thickness_m, sides)

    def anode_mesh(self, at):
        mesh = Mesh()
        for x in at:
            self.band(mesh, x, 0.55, 0.045)
        return mesh

    def clamp_mesh(self, at):
        """Two-part clamps: a ring, bolted flanges at both sides and a lifting eye."""
        mesh = Mesh()
        for x in at:
            self.band(mesh, x, 0.40, 0.06)
            axis, centre = self.direction(x), self.centre(x)
            side = unit(cross((0.0, 0.0, 1.0), axis))
            for sign in (-1.0, 1.0):
                middle = add(centre, scaled(side, sign * (self.radius + 0.11)))
                mesh.beam(add(middle, scaled(axis, -0.2)), add(middle, scaled(axis, 0.2)), 0.16, 0.10)
            top = add(centre, (0.0, 0.0, self.radius + 0.05))
            mesh.beam(top, add(top, (0.0, 0.0, 0.22)), 0.16, 0.04)
        return mesh

    def mattress_mesh(self, x, seed, along=13, across=9, pitch_m=0.46, block_m=0.40, thickness_m=0.12):
        """Concrete blocks on ropes, hanging over the pipe and lying on the bed at both sides."""
        mesh = Mesh()
        axis = self.direction(x)
        for i in range(along):
            s = (i - 0.5 * (along - 1)) * pitch_m + uniform(-0.015, 0.015, seed, i, 1)
            for j in range(across):
                row = j - 0.5 * (across - 1)
                t = math.copysign(self._reach(x + axis[0] * s, abs(row) * pitch_m), row)
                px, py = x + axis[0] * s - axis[1] * t, self.sway(x) + axis[1] * s + axis[0] * t
                self._block(mesh, px, py, axis, block_m, thickness_m)
        return mesh

    def _reach(self, x, along_section):
        """How far from the pipe a rope of this length, laid over it from its crown, ends."""
        step, t, gone = 0.02, 0.0, 0.0
        while gone < along_section:
            rise = self._drape(x, self.sway(x) + t + step) - self._drape(x, self.sway(x) + t)
            gone += math.hypot(step, rise)
            t += step
        return t

    def _drape(self, x, y):
        """Height of a mattress's underside: over the pipe, down a slope, onto the bed."""
        d = abs(y - self.sway(x))
        crown = self.centre(x)[2] + self.radius
        over = crown - max(0.0, d - 0.5 * self.radius) * 0.85
        return max(self.seabed.height(x, y), over)

    def _block(self, mesh, x, y, axis, size, thickness):
        """One block, tilted as the surface under it, with bevelled upper edges."""
        side = (-axis[1], axis[0], 0.0)
        e = 0.5 * size

        def ground(u, v):
            px, py = x + axis[0] * u + side[0] * v, y + axis[1] * u + side[1] * v
            return (px, py, self._drape(px, py))

        rise_u = (ground(e, 0.0)[2] - ground(-e, 0.0)[2]) / size
        rise_v = (ground(0.0, e)[2] - ground(0.0, -e)[2]) / size
        along, across = unit((axis[0], axis[1], rise_u)), unit((side[0], side[1], rise_v))
        up = unit(cross(along, across))
        foot = ground(0.0, 0.0)

        def ring(height, half):
            return [add(foot, add(add(scaled(along, u * half), scaled(across, v * half)), scaled(up, height)))
                    for u, v in ((-1, -1), (1, -1), (1, 1), (-1, 1))]

        rings = [ring(-0.02, e), ring(0.6 * thickness, e), ring(thickness, e - 0.05)]
        for lower, upper in zip(rings, rings[1:]):
            for k in range(4):
                n = (k + 1) % 4
                mesh.polygon([lower[k], lower[n], upper[n], upper[k]])
        mesh.polygon(rings[-1])
