# SPDX-License-Identifier: Apache-2.0
"""A docking station for a torpedo-shaped vehicle: 4 x 3 x 2.5 m, entered from -x through a funnel.

Own coordinates: origin on the seabed under the middle of the base frame, x along the docking tunnel, z up.
Returns one mesh for each material.
"""

import math

from mesh import Mesh, add, cross, lerp, scaled, sub, unit

HALF_LENGTH = 1.9    # of the posts' rectangle
HALF_WIDTH = 1.35
TOP = 2.45
TUNNEL = 1.35        # height of the docking axis
TUNNEL_RADIUS = 0.52


def ring(mesh, centre, radius, bar_radius, points=20, sides=8):
    """A round bar bent to a ring in the plane x = const."""
    path = [add(centre, (0.0, radius * math.cos(2.0 * math.pi * k / points), radius * math.sin(2.0 * math.pi * k / points)))
            for k in range(points + 1)]
    mesh.sweep(path, bar_radius, sides, caps=False)


def anode(mesh, middle, along):
    """A trapezoid sacrificial anode on two stand-offs, hanging under `middle`."""
    half = scaled(along, 0.35)
    block = add(middle, (0.0, 0.0, -0.14))
    mesh.beam(sub(block, half), add(block, half), 0.12, 0.11)
    for sign in (-0.7, 0.7):
        foot = add(block, scaled(half, sign))
        mesh.tube(foot, add(foot, (0.0, 0.0, 0.16)), 0.02, 6)


def foundation(mesh):
    """Mudmats with skirts, base beams, levelling columns."""
    for sx in (-1, 1):
        for sy in (-1, 1):
            x, y = sx * (HALF_LENGTH - 0.05), sy * (HALF_WIDTH + 0.05)
            mesh.box((x, y, 0.05), (1.15, 1.0, 0.05))
            for ox, oy, lx, ly in ((0.56, 0.0, 0.03, 1.0), (-0.56, 0.0, 0.03, 1.0), (0.0, 0.485, 1.15, 0.03), (0.0, -0.485, 1.15, 0.03)):
                mesh.box((x + ox, y + oy, -0.06), (lx, ly, 0.24))
            # Stiffeners on top of the mat, running to the column.
            for ox, oy in ((0.5, 0.0), (-0.5, 0.0), (0.0, 0.42), (0.0, -0.42)):
                mesh.beam((x, y, 0.12), (x + ox, y + oy, 0.10), 0.04, 0.09)
    for sy in (-1, 1):
        y = sy * HALF_WIDTH
        mesh.beam((-HALF_LENGTH - 0.15, y, 0.32), (HALF_LENGTH + 0.15, y, 0.32), 0.20, 0.22)
    for x in (-HALF_LENGTH, -0.63, 0.63, HALF_LENGTH):
        mesh.beam((x, -HALF_WIDTH + 0.1, 0.32), (x, HALF_WIDTH - 0.1, 0.32), 0.16, 0.18)


def frame(mesh):
    """Posts, top frame, braces, padeyes."""
    for sx in (-1, 0, 1):
        for sy in (-1, 1):
            x, y = sx * HALF_LENGTH, sy * HALF_WIDTH
            mesh.tube((x, y, 0.05 if sx else 0.32), (x, y, TOP), 0.084 if sx else 0.06, 14)
    for sy in (-1, 1):
        y = sy * HALF_WIDTH
        mesh.tube((-HALF_LENGTH - 0.05, y, TOP), (HALF_LENGTH + 0.05, y, TOP), 0.08, 14)
        mesh.tube((-HALF_LENGTH, y, 0.43), (0.0, y, TOP - 0.08), 0.045, 10)
        mesh.tube((HALF_LENGTH, y, 0.43), (0.0, y, TOP - 0.08), 0.045, 10)
    for x in (-HALF_LENGTH, 0.0, HALF_LENGTH):
        mesh.tube((x, -HALF_WIDTH, TOP), (x, HALF_WIDTH, TOP), 0.07, 14)
    for a, b in ((-1, 1), (1, -1)):  # the roof and the back are cross-braced; the front stays open
        mesh.tube((-HALF_LENGTH, a * HALF_WIDTH, TOP), (0.0, b * HALF_WIDTH, TOP), 0.04, 8)
        mesh.tube((0.0, a * HALF_WIDTH, TOP), (HALF_LENGTH, b * HALF_WIDTH, TOP), 0.04, 8)
        mesh.tube((HALF_LENGTH, a * HALF_WIDTH, 0.45), (HALF_LENGTH, b * HALF_WIDTH, TOP - 0.05), 0.045, 10)
    for sx in (-1, 1):
        for sy in (-1, 1):
            x, y = sx * (HALF_LENGTH - 0.18), sy * HALF_WIDTH
            mesh.box((x, y, TOP + 0.14), (0.18, 0.03, 0.22))


def deck(mesh):
    """Grating of flat bars on bearers."""
    for x in (-1.75, -0.9, 0.0, 0.9, 1.75):
        mesh.beam((x, -1.25, 0.52), (x, 1.25, 0.52), 0.08, 0.12)
    for k in range(17):
        y = -1.2 + 2.4 * k / 16
        mesh.beam((-1.8, y, 0.61), (1.8, y, 0.61), 0.045, 0.06)
    for k in range(9):
        x = -1.7 + 3.4 * k / 8
        mesh.beam((x, -1.2, 0.655), (x, 1.2, 0.655), 0.03, 0.03)


def tunnel(mesh):
    """Entry funnel, guide rings and rods, latch block."""
    mouth, throat = (-2.75, 0.0, TUNNEL), (-1.85, 0.0, TUNNEL)
    mesh.shell([mouth, throat], [0.98, TUNNEL_RADIUS], 0.025, 28)
    ring(mesh, mouth, 1.0, 0.045, 28)
    for k in range(4):
        angle = math.pi * (0.25 + 0.5 * k)
        rim = add(mouth, (0.25, 0.86 * math.cos(angle), 0.86 * math.sin(angle)))
        post = (-HALF_LENGTH, HALF_WIDTH * (1 if math.cos(angle) > 0 else -1), 2.1 if math.sin(angle) > 0 else 0.6)
        mesh.tube(rim, post, 0.04, 8)
    for x in (-1.85, -1.1, -0.35, 0.4, 1.15):
        ring(mesh, (x, 0.0, TUNNEL), TUNNEL_RADIUS, 0.035)
        for sy in (-1, 1):
            mesh.tube((x, sy * TUNNEL_RADIUS, TUNNEL), (x, sy * HALF_WIDTH, 1.35), 0.03, 8)
        mesh.beam((x, 0.0, 0.66), (x, 0.0, TUNNEL - TUNNEL_RADIUS), 0.10, 0.08)
    for k in range(8):
        angle = 2.0 * math.pi * (k + 0.5) / 8
        offset = (TUNNEL_RADIUS * math.cos(angle), TUNNEL_RADIUS * math.sin(angle))
        mesh.tube((-1.85, offset[0], TUNNEL + offset[1]), (1.15, offset[0], TUNNEL + offset[1]), 0.022, 8)
    mesh.box((1.42, 0.0, TUNNEL), (0.34, 0.46, 0.46))
    mesh.tube((1.15, 0.0, TUNNEL), (1.3, 0.0, TUNNEL), 0.16, 14, end_radius=0.22)
    # A rail at each side keeps a vehicle that misses off the equipment behind.
    for sy in (-1, 1):
        y = sy * HALF_WIDTH
        for z in (0.85, 1.35, 1.85):
            mesh.beam((-HALF_LENGTH, y, z), (HALF_LENGTH, y, z), 0.03, 0.15)


def equipment(mesh):
    """Canisters, battery boxes, junction box, transponder, mast with a corner reflector."""
    for y in (-0.95, -0.55):
        mesh.box((1.1, y, 0.98), (0.95, 0.34, 0.58))
        mesh.box((1.1, y, 1.30), (0.80, 0.24, 0.06))
    for x in (0.55, 1.05):
        mesh.tube((x, 0.95, 0.68), (x, 0.95, 1.75), 0.19, 18)
        mesh.tube((x, 0.95, 0.68), (x, 0.95, 0.75), 0.23, 18)
        mesh.tube((x, 0.95, 1.75), (x, 0.95, 1.81), 0.23, 18)
        mesh.tube((x, 0.95, 1.81), (x, 0.95, 1.95), 0.05, 10)
    mesh.box((-0.9, 1.12, 1.05), (0.6, 0.3, 0.75))
    mesh.tube((-HALF_LENGTH, -HALF_WIDTH, TOP), (-HALF_LENGTH, -HALF_WIDTH, TOP + 0.55), 0.07, 12)
    mesh.sphere((-HALF_LENGTH, -HALF_WIDTH, TOP + 0.6), 0.09, 8, 12)
    foot, head = (HALF_LENGTH, HALF_WIDTH, TOP), (HALF_LENGTH, HALF_WIDTH, 4.25)
    mesh.tube(foot, head, 0.055, 12)
    for other in ((HALF_LENGTH - 0.9, HALF_WIDTH, TOP), (HALF_LENGTH, HALF_WIDTH - 0.9, TOP)):
        mesh.tube(other, add(foot, (0.0, 0.0, 0.95)), 0.03, 8)
    corner = add(head, (0.0, 0.0, 0.2))
    axes = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    for u, v in ((0, 1), (1, 2), (2, 0)):
        a, b = scaled(axes[u], 0.34), scaled(axes[v], 0.34)
        normal = unit(cross(a, b))
        rhombus = [add(add(corner, p), scaled(normal, 0.006)) for p in (a, b, scaled(a, -1.0), scaled(b, -1.0))]
        mesh.plate(rhombus, 0.012)


def anodes(mesh):
    for sy in (-1, 1):
        for x in (-1.2, 1.2):
            anode(mesh, (x, sy * (HALF_WIDTH - 0.25), 0.50), (1.0, 0.0, 0.0))
    for sx in (-1, 1):
        anode(mesh, (sx * (HALF_LENGTH - 0.25), 0.6, 0.50), (0.0, 1.0, 0.0))


def station_meshes():
    """{part name: mesh}; the frame is clean steel work, the equipment carries growth."""
    structure, gear = Mesh(), Mesh()
    for build in (foundation, frame, deck, tunnel):
        build(structure)
    equipment(gear)
    anodes(gear)
    return {"structure": structure, "equipment": gear}


def umbilical_mesh(seabed, place, points):
    """A cable from the junction box down to the bed and away over `points` (x, y)."""
    start = place((-0.9, 1.30, 0.95))
    path = [start, place((-0.9, 1.45, 0.85)), place((-0.95, 1.62, 0.45)), place((-1.0, 1.75, 0.10))]
    previous = path[-1][:2]
    for point in points:
        steps = max(2, int(math.dist(previous, point) / 0.25))
        for k in range(1, steps + 1):
            x, y, _ = lerp((*previous, 0.0), (*point, 0.0), k / steps)
            path.append((x, y, seabed.height(x, y) + 0.04))
        previous = point
    cable = Mesh()
    cable.sweep(path, 0.05, 8)
    return cable


def rov_mesh():
    """A small work vehicle: foam block, open frame, thrusters, skids. Origin at its middle, x forward."""
    mesh = Mesh()
    mesh.box((0.0, 0.0, 0.30), (1.15, 0.75, 0.26))
    for sx in (-1, 1):
        for sy in (-1, 1):
            mesh.beam((sx * 0.52, sy * 0.35, -0.42), (sx * 0.52, sy * 0.35, 0.18), 0.05, 0.05)
    for sy in (-1, 1):
        mesh.beam((-0.60, sy * 0.35, -0.44), (0.60, sy * 0.35, -0.44), 0.07, 0.05)
        mesh.beam((-0.55, sy * 0.35, -0.10), (0.55, sy * 0.35, -0.10), 0.04, 0.04)
        mesh.tube((-0.50, sy * 0.16, 0.02), (-0.22, sy * 0.22, 0.02), 0.10, 14)
        mesh.tube((0.22, sy * 0.22, 0.02), (0.50, sy * 0.16, 0.02), 0.10, 14)
    for sx in (-1, 1):
        mesh.beam((sx * 0.52, -0.35, -0.10), (sx * 0.52, 0.35, -0.10), 0.04, 0.04)
    mesh.tube((-0.35, 0.0, -0.22), (0.40, 0.0, -0.22), 0.13, 16)
    mesh.sphere((0.42, 0.0, -0.22), 0.13, 8, 16)
    return mesh
