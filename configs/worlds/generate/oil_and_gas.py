# SPDX-License-Identifier: Apache-2.0
"""A jacket with risers, a manifold and a wellhead tree, and the spools between them.

Meshes with their own coordinates have their origin on the bed, z up; the others are in world coordinates.
"""

from docking_station import anode
from mesh import Mesh, add, lerp, sub, unit
from ssiv import bend, flange

MANIFOLD = (2.4, 1.6, 2.3)     # half length, half width and height of its frame
HEADER = 0.95                  # height of the headers and of the hubs at the ends
HEADER_RADIUS = 0.22
HEADER_OFFSETS = (-0.35, 0.75)  # y of the two headers
HUBS = (-0.9, 0.9)             # x of the riser spools' hubs on the manifold's south side
JUMPER_HUB = -1.05             # y of the jumper's hub on its east side
TREE = (1.1, 1.1, 3.0)         # of the tree's frame

JACKET_FOOT = (6.0, 6.0)       # half distances of the legs' axes at the bed
JACKET_BATTER = 1.0 / 12.0     # a leg leans in by this much for each metre of height
JACKET_LEVELS = (0.6, 10.0, 19.0, 27.0)  # heights of the horizontal braces


def _leg(height, sx, sy):
    """A point on the axis of a leg."""
    lean = JACKET_BATTER * height
    return (sx * (JACKET_FOOT[0] - lean), sy * (JACKET_FOOT[1] - lean), height)


def _faces():
    """The corners (sx, sy) of each of the four faces."""
    ring = [(-1, -1), (1, -1), (1, 1), (-1, 1)]
    return [(ring[k], ring[(k + 1) % 4]) for k in range(4)]


def jacket_mesh(top):
    """Four leaning legs on mudmats with piles beside them, rings of braces, an X in each face between two rings."""
    mesh = Mesh()
    for sx, sy in ((sx, sy) for sx in (-1, 1) for sy in (-1, 1)):
        mesh.tube(_leg(-0.6, sx, sy), _leg(top, sx, sy), 0.50, 28)
        x, y, _ = _leg(0.0, sx, sy)
        mesh.box((x, y, 0.05), (2.6, 2.6, 0.30))
        pile = (x + 0.85 * sx, y + 0.85 * sy)
        mesh.tube((*pile, -0.4), (*pile, 3.2), 0.38, 24)
        mesh.beam((x, y, 2.4), (*pile, 2.4), 0.25, 0.9)
    for level in JACKET_LEVELS:
        for a, b in _faces():
            mesh.tube(_leg(level, *a), _leg(level, *b), 0.28, 20)
        mesh.tube(_leg(level, -1, -1), _leg(level, 1, 1), 0.20, 18)
        mesh.tube(_leg(level, -1, 1), _leg(level, 1, -1), 0.20, 18)
    for low, high in zip(JACKET_LEVELS, JACKET_LEVELS[1:]):
        for a, b in _faces():
            mesh.tube(_leg(low, *a), _leg(high, *b), 0.24, 18)
            mesh.tube(_leg(low, *b), _leg(high, *a), 0.24, 18)
    for a, b in _faces():
        start, end = _leg(JACKET_LEVELS[0], *a), _leg(JACKET_LEVELS[0], *b)
        for t in (0.3, 0.7):
            anode(mesh, add(lerp(start, end, t), (0.0, 0.0, -0.27)), unit(sub(end, start)))
    return mesh


def riser_mesh(foot, hub, bed, top, radius):
    """Down the jacket's north face, a bend at the bed, and a spool north into a hub; foot and hub share their x.

    `foot` is (x, y) of the bend, `hub` (x, y, z), `bed` and `top` are heights; world coordinates.
    """
    lean = JACKET_BATTER * (top - bed)
    low = bed + 0.75
    path = bend([(foot[0], foot[1] - lean, top), (*foot, low), (hub[0], hub[1] - 1.3, low), hub], 0.7)
    mesh = Mesh()
    mesh.sweep(path, radius, 20)
    flange(mesh, (hub[0], hub[1] - 0.25, hub[2]), (0.0, 1.0, 0.0), radius + 0.12)
    for t in (0.3, 0.65):  # supports of the spool, down into the bed
        mesh.box((foot[0], foot[1] + (hub[1] - foot[1]) * t, bed + 0.2), (0.9, 0.5, 0.9))
    return mesh


def riser_clamp_mesh(foot, bed, radius):
    """Guides that hold a riser to the rings of the jacket."""
    mesh = Mesh()
    for level in JACKET_LEVELS[1:]:
        at = (foot[0], foot[1] - JACKET_BATTER * level, bed + level)
        mesh.tube(add(at, (0.0, 0.0, -0.25)), add(at, (0.0, 0.0, 0.25)), radius + 0.06, 20)
        mesh.beam(at, add(at, (0.0, -0.9, 0.0)), 0.16, 0.22)
    return mesh


def _framework(mesh, half_x, half_y, height, bar):
    """Mudmats, posts, two rings and a diagonal in each side of a frame."""
    corners = [(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)]
    for k, a in enumerate(corners):
        b = corners[(k + 1) % 4]
        mesh.box((*a, 0.02), (1.1, 1.1, 0.20))
        mesh.tube((*a, 0.0), (*a, height), bar, 16)
        for z in (0.35, height):
            mesh.tube((*a, z), (*b, z), bar, 16)
        mesh.tube((*a, 0.35), (*b, height), 0.6 * bar, 12)


def manifold_mesh():
    """Two headers along x with valves, branches down to hubs on the south side, a control module, a grated roof."""
    mesh = Mesh()
    half_x, half_y, height = MANIFOLD
    _framework(mesh, half_x, half_y, height, 0.12)
    for y in HEADER_OFFSETS:
        mesh.tube((-half_x - 0.5, y, HEADER), (half_x + 0.5, y, HEADER), HEADER_RADIUS, 24)
        for x in (-half_x - 0.45, -0.6, 0.6, half_x + 0.45):
            flange(mesh, (x, y, HEADER), (1.0, 0.0, 0.0), 0.36)
        for x in (-half_x + 0.5, half_x - 0.5):
            mesh.box((x, y, 0.45), (0.25, 0.5, 0.70))
    for x in HUBS:
        mesh.tube((x, -half_y - 0.25, HEADER), (x, HEADER_OFFSETS[1], HEADER), 0.16, 20)
        flange(mesh, (x, -half_y - 0.15, HEADER), (0.0, 1.0, 0.0), 0.28)
        mesh.tube((x, -0.95, HEADER), (x, -0.95, HEADER + 0.9), 0.20, 20)
        mesh.tube((x, -0.95, HEADER + 0.9), (x, -0.95, HEADER + 1.05), 0.28, 20)
    mesh.tube((HUBS[1], JUMPER_HUB, HEADER), (half_x + 0.25, JUMPER_HUB, HEADER), 0.13, 18)
    flange(mesh, (half_x + 0.15, JUMPER_HUB, HEADER), (1.0, 0.0, 0.0), 0.25)
    mesh.box((0.0, 0.3, 1.65), (0.9, 0.9, 1.0))
    for x in (-0.7, 0.7):
        mesh.beam((x, -half_y, height + 0.04), (x, half_y, height + 0.04), 0.10, 0.12)
    for k in range(13):
        y = -half_y + 0.2 + (2.0 * half_y - 0.4) * k / 12
        mesh.beam((-half_x, y, height + 0.14), (-0.7, y, height + 0.14), 0.05, 0.08)
        mesh.beam((0.7, y, height + 0.14), (half_x, y, height + 0.14), 0.05, 0.08)
    return mesh


def tree_mesh():
    """A wellhead on its conductor, valve block, cap, guide posts, and a hub on the north side."""
    mesh = Mesh()
    half_x, half_y, height = TREE
    _framework(mesh, half_x, half_y, height, 0.09)
    mesh.tube((0.0, 0.0, -0.3), (0.0, 0.0, 0.9), 0.38, 28)
    flange(mesh, (0.0, 0.0, 0.95), (0.0, 0.0, 1.0), 0.50)
    mesh.box((0.0, 0.0, 1.65), (0.85, 0.85, 1.20))
    mesh.tube((0.0, 0.0, 2.25), (0.0, 0.0, 3.2), 0.30, 24)
    mesh.tube((0.0, 0.0, 3.2), (0.0, 0.0, 3.4), 0.42, 24)
    for x in (-0.75, 0.75):
        mesh.tube((x, -0.1, 1.5), (x, -0.1, 2.3), 0.14, 18)
    for sx, sy in ((-1, -1), (-1, 1), (1, -1), (1, 1)):
        mesh.tube((sx * half_x, sy * half_y, height), (sx * half_x, sy * half_y, height + 1.0), 0.06, 14)
    mesh.tube((0.0, 0.3, HEADER), (0.0, half_y + 0.25, HEADER), 0.15, 20)
    flange(mesh, (0.0, half_y + 0.15, HEADER), (0.0, 1.0, 0.0), 0.27)
    return mesh


def jumper_mesh(start, end, crown, radius):
    """A rigid jumper between two hubs: up, across at height `crown`, down; world coordinates."""
    mesh = Mesh()
    out, back = add(start, (0.0, 0.6, 0.0)), add(end, (0.6, 0.0, 0.0))
    mesh.sweep(bend([start, out, (out[0], out[1], crown), (back[0], back[1], crown), back, end], 0.28), radius, 18)
    return mesh
