# SPDX-License-Identifier: Apache-2.0
"""A manifold under a protective cover: open towards the front, closed at the roof, the back and the ends.

Own coordinates: origin on the seabed under its middle, x along the flowlines, front at -y, z up.
"""

from docking_station import anode
from mesh import Mesh
from ssiv import flange

HALF = (3.0, 1.4)       # half length, half width of the cover
HEIGHT = 1.8            # of the roof's upper side
FLOWLINE_RADIUS = 0.25
TIE_IN = 0.62           # height of the flowlines' axis where they leave the ends
PLATE = 0.06


def _box_between(mesh, low, high):
    mesh.box(tuple(0.5 * (a + b) for a, b in zip(low, high)), tuple(b - a for a, b in zip(low, high)))


def cover_mesh():
    """Roof, back and ends of plate, and the columns, sill and lintel of the front. Nothing stands out above the roof's back edge."""
    mesh = Mesh()
    x, y = HALF
    foot = -0.25  # the skirts are in the bed
    _box_between(mesh, (-x, -y, HEIGHT - PLATE), (x, y, HEIGHT))
    _box_between(mesh, (-x, y - PLATE, foot), (x, y, HEIGHT - PLATE))
    for sx in (-1, 1):
        a, b = sorted((sx * x, sx * (x - PLATE)))
        _box_between(mesh, (a, -y, foot), (b, y - PLATE, HEIGHT - PLATE))
    _box_between(mesh, (-x + PLATE, -y, foot), (x - PLATE, -y + 0.20, 0.30))          # sill
    _box_between(mesh, (-x + PLATE, -y, 1.40), (x - PLATE, -y + 0.20, HEIGHT - PLATE))  # lintel
    for middle in (-2.75, -0.95, 0.95, 2.75):
        _box_between(mesh, (middle - 0.16, -y, 0.30), (middle + 0.16, -y + 0.20, 1.40))
    for sx in (-1, 1):
        for middle in (-0.6, 0.6):
            mesh.box((sx * (x + 0.45), middle, 0.04), (0.9, 0.9, 0.20))  # mudmats
    return mesh


def equipment_mesh():
    """Two headers with valves in the open bays, receptacles on the lintel, anodes on the sill."""
    mesh = Mesh()
    x, y = HALF
    for at, z, radius in ((-0.75, 0.70, 0.20), (-0.20, 1.05, 0.22)):
        mesh.tube((-x + 0.2, at, z), (x - 0.2, at, z), radius, 22)
        for along in (-1.9, -0.95, 0.95, 1.9):
            flange(mesh, (along, at, z), (1.0, 0.0, 0.0), radius + 0.12)
    for along in (-1.75, 0.0, 1.75):
        mesh.box((along, -0.85, 0.75), (0.55, 0.50, 0.55))
        mesh.tube((along, -1.05, 0.75), (along, -1.45, 0.75), 0.12, 18)
        mesh.tube((along, -0.85, 1.0), (along, -0.85, 1.35), 0.16, 18)
    for along in (-2.2, -1.3, 1.3, 2.2):
        mesh.tube((along, -y - 0.18, 1.57), (along, -y, 1.57), 0.09, 16)
    for along in (-1.8, 1.8):
        anode(mesh, (along, -y - 0.12, 0.28), (1.0, 0.0, 0.0))
    for sx in (-1, 1):  # stubs out of the ends
        mesh.tube((sx * 2.4, 0.0, TIE_IN), (sx * (x + 0.5), 0.0, TIE_IN), FLOWLINE_RADIUS, 20)
        flange(mesh, (sx * (x + 0.3), 0.0, TIE_IN), (1.0, 0.0, 0.0), FLOWLINE_RADIUS + 0.15)
    return mesh
