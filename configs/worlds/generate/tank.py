# SPDX-License-Identifier: Apache-2.0
"""A concrete test tank filled to the brim of its working depth, and what stands in it.

World coordinates: x east, y north, z up from the water surface; the tank's middle is at x = y = 0.
"""

from mesh import Mesh, add

EAST, NORTH, DEPTH = 7.0, 5.0, 8.0   # the inner faces: x = +-EAST, y = +-NORTH, z = -DEPTH
FREEBOARD = 0.6                      # of the walls above the water
LADDER = (1.0, 0.45, 0.16)           # x of its middle, width, distance of its rails from the north wall
PILLAR = (4.0, 0.8, 0.3)             # x, y, radius
INLET = (1.5, -4.0, 0.20, 0.9)       # y, z, inner radius, length out of the west wall
TARGET_RADIUS = 0.25
TARGET_HEIGHT = 4.0                  # of the sphere's centre above the floor


def _lining():
    """Floor and walls, facing the water."""
    mesh = Mesh()
    corners = [(-EAST, -NORTH), (EAST, -NORTH), (EAST, NORTH), (-EAST, NORTH)]
    mesh.polygon([(x, y, -DEPTH) for x, y in corners])
    for k, a in enumerate(corners):
        b = corners[(k + 1) % 4]
        mesh.polygon([(*b, -DEPTH), (*a, -DEPTH), (*a, FREEBOARD), (*b, FREEBOARD)])
    return mesh


def _surface():
    """The water surface, facing down."""
    mesh = Mesh()
    mesh.polygon([(-EAST, -NORTH, 0.0), (-EAST, NORTH, 0.0), (EAST, NORTH, 0.0), (EAST, -NORTH, 0.0)])
    return mesh


def _ladder():
    """Two rails on brackets before the north wall, rungs every 0.3 m, from the floor to the brim."""
    mesh = Mesh()
    middle, width, off = LADDER
    y = NORTH - off
    for x in (middle - 0.5 * width, middle + 0.5 * width):
        mesh.tube((x, y, -DEPTH), (x, y, FREEBOARD), 0.03, 16)
        for k in range(5):
            z = -DEPTH + 0.25 + 1.9 * k
            mesh.tube((x, y, z), (x, NORTH, z), 0.015, 10)
    for k in range(28):
        z = -DEPTH + 0.3 * (k + 1)
        mesh.tube((middle - 0.5 * width, y, z), (middle + 0.5 * width, y, z), 0.016, 10)
    return mesh


def _pillar():
    mesh = Mesh()
    x, y, radius = PILLAR
    mesh.tube((x, y, -DEPTH), (x, y, FREEBOARD), radius, 48)
    return mesh


def _inlet():
    """A pipe out of the west wall, with a flange at the wall and one at its open end."""
    mesh = Mesh()
    y, z, radius, length = INLET
    wall, end = (-EAST, y, z), (-EAST + length, y, z)
    mesh.shell([wall, end], [radius, radius], 0.02, 32)
    mesh.shell([wall, add(wall, (0.04, 0.0, 0.0))], [radius + 0.02] * 2, 0.10, 32)
    mesh.shell([add(end, (-0.05, 0.0, 0.0)), end], [radius + 0.02] * 2, 0.07, 32)
    return mesh


def _target():
    """A steel sphere, its origin at its centre, moored to a block on the floor by a thin rope."""
    mesh = Mesh()
    mesh.sphere((0.0, 0.0, 0.0), TARGET_RADIUS, 24, 36)
    mesh.tube((0.0, 0.0, -TARGET_RADIUS), (0.0, 0.0, -TARGET_HEIGHT + 0.24), 0.01, 8)
    mesh.box((0.0, 0.0, -TARGET_HEIGHT + 0.12), (0.4, 0.4, 0.24))
    return mesh


def tank_meshes():
    """{part name: mesh}."""
    return {"lining": _lining(), "surface": _surface(), "ladder": _ladder(), "pillar": _pillar(), "inlet": _inlet(), "target": _target()}
