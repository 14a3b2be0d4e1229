# SPDX-License-Identifier: Apache-2.0
"""A cage of bars that stands on the bed around the vehicle: an upright bar and a rail every metre, and a gate.

Own coordinates: origin at the middle of the cage, x towards the gate, z up.
"""

from mesh import Mesh

HALF = 4              # the axes of the outer bars lie at x = +-HALF and y = +-HALF, the roof at z = HALF
FOOT = -4.3           # the bars end in the bed
BAR_RADIUS, POST_RADIUS, RAIL_RADIUS = 0.04, 0.10, 0.03
GATE_HALF_WIDTH, GATE_HALF_HEIGHT = 1, 2


def _uprights(mesh):
    steps = range(-HALF, HALF + 1)
    for x, y in [(x, y) for x in steps for y in steps if HALF in (abs(x), abs(y)) and (x, y) != (HALF, 0)]:
        radius = POST_RADIUS if abs(x) == abs(y) else BAR_RADIUS
        mesh.tube((x, y, FOOT), (x, y, HALF), radius, 16)
    mesh.tube((HALF, 0, FOOT), (HALF, 0, -GATE_HALF_HEIGHT), BAR_RADIUS, 16)
    mesh.tube((HALF, 0, GATE_HALF_HEIGHT), (HALF, 0, HALF), BAR_RADIUS, 16)


def _rails(mesh):
    for z in range(-HALF + 1, HALF + 1):
        for side in (-HALF, HALF):
            mesh.tube((-HALF, side, z), (HALF, side, z), RAIL_RADIUS, 10)
        mesh.tube((-HALF, -HALF, z), (-HALF, HALF, z), RAIL_RADIUS, 10)
        if abs(z) < GATE_HALF_HEIGHT:
            for sign in (-1, 1):
                mesh.tube((HALF, sign * GATE_HALF_WIDTH, z), (HALF, sign * HALF, z), RAIL_RADIUS, 10)
        else:
            mesh.tube((HALF, -HALF, z), (HALF, HALF, z), RAIL_RADIUS, 10)


def _roof(mesh):
    for k in range(-HALF + 1, HALF):
        mesh.tube((k, -HALF, HALF), (k, HALF, HALF), RAIL_RADIUS, 10)
        mesh.tube((-HALF, k, HALF), (HALF, k, HALF), RAIL_RADIUS, 10)


def grid_mesh():
    mesh = Mesh()
    for build in (_uprights, _rails, _roof):
        build(mesh)
    return mesh
