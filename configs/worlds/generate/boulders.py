# SPDX-License-Identifier: Apache-2.0
"""Boulders: a sphere of triangles, dented by noise and flattened a little."""

import math

from mesh import Mesh, add, cross, length, lerp, scaled, sub, unit
from noise import layered_noise


def _icosahedron():
    g = (1.0 + math.sqrt(5.0)) / 2.0
    corners = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g),
               (0, -1, -g), (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
             (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
             (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return [unit(c) for c in corners], faces


def _sphere(levels):
    corners, faces = _icosahedron()
    for _ in range(levels):
        middles = {}

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(corners)
                corners.append(unit(lerp(corners[a], corners[b], 0.5)))
            return middles[key]

        split = []
        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            split += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = split
    return corners, faces


def boulder(seed, size, levels=3):
    """One boulder about `size` (x, y, z) across, centred on the origin."""
    directions, faces = _sphere(levels)
    points = []
    for d in directions:
        lumps = layered_noise(seed, 1.3 * d[0] + 7.0, 1.3 * d[1] + 3.0, 3, 1.3 * d[2] + 5.0)
        # Broken faces: clip against a few planes.
        radius = 1.0 + 0.28 * lumps
        for k, normal in enumerate(((0.8, 0.5, 0.3), (-0.6, 0.7, 0.4), (-0.3, -0.8, 0.5), (0.2, -0.1, 1.0))):
            cosine = (d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2]) / length(normal)
            if cosine > 0.1:
                radius = min(radius, (0.80 + 0.05 * k) / cosine)
        points.append(tuple(round(0.5 * s * radius * c, 3) + 0.0 for s, c in zip(size, d)))
    normals = [(0.0, 0.0, 0.0)] * len(points)
    mesh = Mesh()
    for face in faces:
        a, b, c = (points[k] for k in face)
        weighted = cross(sub(b, a), sub(c, a))
        if length(weighted) < 1e-9:
            continue
        for k in face:
            normals[k] = add(normals[k], weighted)
        mesh.triangles.append(face)
    mesh.positions = points
    mesh.normals = [tuple(round(c, 3) + 0.0 for c in scaled(n, 1.0 / length(n))) for n in normals]
    return mesh
