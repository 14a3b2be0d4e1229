# SPDX-License-Identifier: Apache-2.0
"""Triangle meshes built from a few solid shapes, and their PLY files.

Every shape is closed or meant to be seen from outside only; triangles run counter-clockwise seen from outside.
Coordinates are rounded to millimetres and normals to a thousandth before anything is derived from them, so that the
files do not depend on the last digit of a maths library.
"""

import math
import struct


def add(a, b):
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def scaled(a, s):
    return (a[0] * s, a[1] * s, a[2] * s)


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def length(a):
    return math.sqrt(dot(a, a))


def unit(a):
    return scaled(a, 1.0 / length(a))


def lerp(a, b, t):
    return add(scaled(a, 1.0 - t), scaled(b, t))


def any_perpendicular(axis):
    """A unit vector at right angles to `axis`, horizontal where that is possible."""
    helper = (0.0, 0.0, 1.0) if abs(axis[2]) < 0.9 * length(axis) else (0.0, 1.0, 0.0)
    return unit(cross(helper, axis))


def _rounded(point):
    return tuple(round(c, 3) + 0.0 for c in point)


def _texture(position, normal, tile_m):
    """(u, v), 1 for each tile: east and north on a bed or floor, along and up on a wall."""
    facing = max((2, 1, 0), key=lambda axis: abs(normal[axis]))
    return [position[axis] / tile_m for axis in range(3) if axis != facing]


class Mesh:
    """Positions, one unit normal each, and triangles."""

    def __init__(self):
        self.positions = []
        self.normals = []
        self.triangles = []

    # -- the two ways geometry gets in ------------------------------------------------------------------------

    def grid(self, rows, wrap=False):
        """A smooth patch through rows of points. Outside is where (next column) x (next row) points.

        `wrap` joins the last column to the first.
        """
        columns = len(rows[0])
        base = len(self.positions)
        points = [_rounded(p) for row in rows for p in row]
        faces = []
        for i in range(len(rows) - 1):
            for j in range(columns if wrap else columns - 1):
                a, b = i * columns + j, i * columns + (j + 1) % columns
                c, d = a + columns, b + columns
                # Cut along the shorter diagonal: ridges then stay ridges.
                if length(sub(points[a], points[d])) <= length(sub(points[b], points[c])):
                    faces += [(a, b, d), (a, d, c)]
                else:
                    faces += [(a, b, c), (b, d, c)]
        sums = [(0.0, 0.0, 0.0)] * len(points)
        for face in faces:
            a, b, c = (points[k] for k in face)
            weighted = cross(sub(b, a), sub(c, a))
            if length(weighted) < 1e-9:
                continue
            for k in face:
                sums[k] = add(sums[k], weighted)
            self.triangles.append(tuple(base + k for k in face))
        self.positions += points
        self.normals += [_rounded(unit(n)) if length(n) > 0.0 else (0.0, 0.0, 1.0) for n in sums]

    def polygon(self, points):
        """A flat convex polygon, counter-clockwise seen from outside."""
        points = [_rounded(p) for p in points]
        newell = (0.0, 0.0, 0.0)
        for k, p in enumerate(points):
            newell = add(newell, cross(p, points[(k + 1) % len(points)]))
        base = len(self.positions)
        self.positions += points
        self.normals += [_rounded(unit(newell))] * len(points)
        for k in range(1, len(points) - 1):
            self.triangles.append((base, base + k, base + k + 1))

    # -- solids -----------------------------------------------------------------------------------------------

    def box(self, centre, size):
        """An upright box."""
        self.beam(add(centre, (-0.5 * size[0], 0.0, 0.0)), add(centre, (0.5 * size[0], 0.0, 0.0)), size[1], size[2])

    def beam(self, start, end, width, height, up=(0.0, 0.0, 1.0)):
        """A rectangular bar from start to end; `height` is measured along `up` as far as the axis allows."""
        axis = unit(sub(end, start))
        side = cross(up, axis)
        side = unit(side) if length(side) > 1e-6 else any_perpendicular(axis)
        top = cross(axis, side)

        def corner(at, s, t):
            return add(at, add(scaled(side, 0.5 * s * width), scaled(top, 0.5 * t * height)))

        ring = [(-1, -1), (1, -1), (1, 1), (-1, 1)]  # clockwise seen along the axis
        near = [corner(start, s, t) for s, t in ring]
        far = [corner(end, s, t) for s, t in ring]
        self.polygon(near[::-1])
        self.polygon(far)
        for k in range(4):
            n = (k + 1) % 4
            self.polygon([near[k], near[n], far[n], far[k]])

    def tube(self, start, end, radius, sides=14, end_radius=None, caps=True):
        """A round bar or, with `end_radius`, a cone frustum."""
        self.sweep([start, end], [radius, radius if end_radius is None else end_radius], sides, caps)

    def sweep(self, path, radii, sides=14, caps=True):
        """A round bar along a polyline; `radii` is one number or one for each point."""
        if isinstance(radii, (int, float)):
            radii = [radii] * len(path)
        rows = []
        e1 = None
        for k, centre in enumerate(path):
            before, after = path[max(k - 1, 0)], path[min(k + 1, len(path) - 1)]
            axis = unit(sub(after, before))
            e1 = any_perpendicular(axis) if e1 is None else unit(sub(e1, scaled(axis, dot(e1, axis))))
            e2 = cross(axis, e1)
            row = []
            for j in range(sides):
                angle = 2.0 * math.pi * j / sides
                spoke = add(scaled(e1, math.cos(angle)), scaled(e2, math.sin(angle)))
                row.append(add(centre, scaled(spoke, radii[k])))
            rows.append(row)
        self.grid(rows, wrap=True)
        if caps:
            self.polygon(rows[0][::-1])
            self.polygon(rows[-1])

    def sphere(self, centre, radius, rings=10, sides=16):
        rows = []
        for i in range(rings + 1):
            polar = math.pi * i / rings
            # The poles are tiny circles, so that every row has the same number of points.
            r, z = max(math.sin(polar), 2e-3 / radius) * radius, -math.cos(polar) * radius
            rows.append([add(centre, (r * math.cos(2.0 * math.pi * j / sides), r * math.sin(2.0 * math.pi * j / sides), z))
                         for j in range(sides)])
        self.grid(rows, wrap=True)

    def plate(self, outline, thickness):
        """A sheet: `outline` is its convex upper face, counter-clockwise seen from outside."""
        normal = unit(cross(sub(outline[1], outline[0]), sub(outline[2], outline[1])))
        lower = [sub(p, scaled(normal, thickness)) for p in outline]
        self.polygon(outline)
        self.polygon(lower[::-1])
        for k, p in enumerate(outline):
            n = (k + 1) % len(outline)
            self.polygon([lower[k], lower[n], outline[n], p])

    def shell(self, path, inner_radii, thickness, sides=24):
        """A pipe with a wall along a straight polyline: outside, inside and both rims."""
        axis = unit(sub(path[-1], path[0]))
        e1 = any_perpendicular(axis)
        e2 = cross(axis, e1)

        def ring(centre, radius):
            spokes = [2.0 * math.pi * j / sides for j in range(sides)]
            return [add(centre, add(scaled(e1, radius * math.cos(a)), scaled(e2, radius * math.sin(a)))) for a in spokes]

        outside = [ring(c, r + thickness) for c, r in zip(path, inner_radii)]
        inside = [ring(c, r) for c, r in zip(path, inner_radii)]
        self.grid(outside, wrap=True)
        self.grid(inside[::-1], wrap=True)
        self.grid([inside[0], outside[0]], wrap=True)
        self.grid([outside[-1], inside[-1]], wrap=True)

    # -- whole meshes -----------------------------------------------------------------------------------------

    def merge(self, other, place=lambda p: p, turn=lambda n: n):
        """Adds a copy of `other`; `place` moves points and `turn` turns directions."""
        base = len(self.positions)
        self.positions += [_rounded(place(p)) for p in other.positions]
        self.normals += [_rounded(unit(turn(n))) for n in other.normals]
        self.triangles += [tuple(base + k for k in t) for t in other.triangles]

    def ply(self, texture_tile_m=None):
        """The mesh as a binary little-endian PLY file; with texture coordinates where a tile's size is given."""
        uv = ("texture_u", "texture_v") if texture_tile_m else ()
        header = "\n".join([
            "ply", "format binary_little_endian 1.0",
            "comment metres, z up; made by configs/worlds/generate",
            f"element vertex {len(self.positions)}",
            *(f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz", *uv)),
            f"element face {len(self.triangles)}", "property list uchar int vertex_indices", "end_header", ""])
        body = bytearray(header.encode("ascii"))
        for position, normal in zip(self.positions, self.normals):
            body += struct.pack("<6f", *position, *normal)
            if texture_tile_m:
                body += struct.pack("<2f", *_texture(position, normal, texture_tile_m))
        for triangle in self.triangles:
            body += struct.pack("<B3i", 3, *triangle)
        return bytes(body)


def yawed(angle_rad):
    """A function that turns a vector about z."""
    c, s = math.cos(angle_rad), math.sin(angle_rad)
    return lambda v: (c * v[0] - s * v[1], s * v[0] + c * v[1], v[2])


def placed(offset, angle_rad=0.0):
    """A function that turns a point about z and then moves it."""
    turn = yawed(angle_rad)
    return lambda p: add(turn(p), offset)
