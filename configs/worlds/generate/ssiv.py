# SPDX-License-Identifier: Apache-2.0
"""A subsea isolation valve (SSIV) in its protective frame, tied in to a pipeline at both ends.

Own coordinates: origin on the seabed under the valve, x along the pipeline, z up.
"""

import math

from docking_station import anode
from mesh import Mesh, add, lerp, scaled, sub, unit

BASE = (3.6, 2.5, 0.22)    # half length, half width and height of the base ring
ROOF = (2.3, 1.4, 3.10)    # of the roof ring
PIPE_RADIUS = 0.25
TIE_IN = 0.66              # height of the pipe's axis where it passes the frame
VALVE = 1.15               # height of the valve's axis


def corner(level, sx, sy):
    """A corner of the frame at `level`: 0 on the base ring, 1 on the roof ring."""
    return lerp((sx * BASE[0], sy * BASE[1], BASE[2]), (sx * ROOF[0], sy * ROOF[1], ROOF[2]), level)


def frame(mesh):
    """Base and roof rings, sloped legs, side members, diagonals."""
    for level, radius in ((0.0, 0.17), (0.48, 0.11), (1.0, 0.14)):
        for sy in (-1, 1):
            mesh.tube(corner(level, -1, sy), corner(level, 1, sy), radius, 16)
        for sx in (-1, 1):
            if level == 0.0:  # the pipe passes over the middle of the end members, which dip
                a, b = corner(level, sx, -1), corner(level, sx, 1)
                mesh.sweep([a, add(lerp(a, b, 0.3), (0, 0, -0.02)), add(lerp(a, b, 0.36), (0, 0, -0.1)),
                            add(lerp(a, b, 0.64), (0, 0, -0.1)), add(lerp(a, b, 0.7), (0, 0, -0.02)), b], radius, 16)
            elif level < 1.0:  # guard bars stop short of the pipe's opening
                mesh.tube(corner(level, sx, -1), corner(level, sx, 1), radius, 16)
            else:
                mesh.tube(corner(level, sx, -1), corner(level, sx, 1), radius, 16)
    for sx in (-1, 1):
        for sy in (-1, 1):
            mesh.tube(corner(-0.03, sx, sy), corner(1.02, sx, sy), 0.16, 16)
    for sy in (-1, 1):
        for t in (0.34, 0.66):
            low = lerp(corner(0.0, -1, sy), corner(0.0, 1, sy), t)
            high = lerp(corner(1.0, -1, sy), corner(1.0, 1, sy), t)
            mesh.tube(low, high, 0.11, 14)
        for sx in (-1, 1):
            low = lerp(corner(0.0, -1, sy), corner(0.0, 1, sy), 0.5 - 0.16 * sx)
            mesh.tube(low, corner(0.48, -sx, sy), 0.07, 10)
            mesh.tube(lerp(corner(0.48, -1, sy), corner(0.48, 1, sy), 0.5 - 0.16 * sx), corner(1.0, -sx, sy), 0.07, 10)
    for sx in (-1, 1):
        for sy in (-1, 1):
            mesh.tube(corner(0.48, sx, sy), lerp(corner(1.0, sx, -1), corner(1.0, sx, 1), 0.5), 0.07, 10)
            mesh.tube(lerp(corner(0.0, sx, -1), corner(0.0, sx, 1), 0.5 + 0.2 * sy), lerp(corner(0.48, sx, -1), corner(0.48, sx, 1), 0.5 + 0.22 * sy), 0.09, 12)
    for x in (-2.2, -0.8, 0.8, 2.2):
        mesh.tube((x, -BASE[1], BASE[2]), (x, BASE[1], BASE[2]), 0.11, 12)


def foundation(mesh):
    """Mudmats at the corners, with skirts."""
    for sx in (-1, 1):
        for sy in (-1, 1):
            x, y = sx * (BASE[0] - 0.5), sy * (BASE[1] + 0.15)
            mesh.box((x, y, 0.03), (1.9, 1.2, 0.06))
            for oy in (-0.58, 0.58):
                mesh.box((x, y + oy, -0.08), (1.9, 0.04, 0.28))
            for ox in (-0.93, 0.93):
                mesh.box((x + ox, y, -0.08), (0.04, 1.2, 0.28))
            for ox in (-0.5, 0.0, 0.5):
                mesh.beam((x + ox, y - 0.5, 0.10), (x + ox, y + 0.5, 0.10), 0.05, 0.10)


def roof(mesh):
    """Two hatches of grating, with hinges and lifting eyes; a gap between them over the actuator."""
    z = ROOF[2] + 0.12
    for sx in (-1, 1):
        x0, x1 = sx * 0.55, sx * (ROOF[0] - 0.1)
        for y in (-1.2, 1.2):
            mesh.beam((x0, y, z), (x1, y, z), 0.10, 0.12)
        for x in (x0, x1):
            mesh.beam((x, -1.2, z), (x, 1.2, z), 0.10, 0.12)
        for k in range(1, 14):
            x = x0 + (x1 - x0) * k / 14
            mesh.beam((x, -1.2, z), (x, 1.2, z), 0.04, 0.08)
        for y in (-0.7, 0.7):
            mesh.box((x1, y, z + 0.12), (0.16, 0.05, 0.20))


def side_covers(mesh):
    """Sloped impact covers over the upper half of the two long sides, with openings between them."""
    for sy in (-1, 1):
        for t0, t1 in ((0.04, 0.30), (0.70, 0.96)):
            lower = [lerp(corner(0.52, -1, sy), corner(0.52, 1, sy), t) for t in (t0, t1)]
            upper = [lerp(corner(0.94, -1, sy), corner(0.94, 1, sy), t) for t in (t1, t0)]
            outline = lower + upper
            out = (0.0, 0.09 * sy, 0.05)
            outline = [add(p, out) for p in outline]
            mesh.plate(outline if sy < 0 else outline[::-1], 0.04)


def flange(mesh, centre, axis, radius, thickness=0.12):
    """A bolted flange pair: two discs with a gap, and the bolts' circle as a ring between."""
    for sign in (-1.0, 1.0):
        middle = add(centre, scaled(axis, sign * 0.55 * thickness))
        mesh.tube(sub(middle, scaled(axis, 0.45 * thickness)), add(middle, scaled(axis, 0.45 * thickness)), radius, 20)
    mesh.tube(sub(centre, scaled(axis, thickness)), add(centre, scaled(axis, thickness)), 0.85 * radius, 16)


def bend(points, radius, steps=6):
    """A polyline with its corners rounded off."""
    path = [points[0]]
    for before, at, after in zip(points, points[1:], points[2:]):
        a = add(at, scaled(unit(sub(before, at)), radius))
        b = add(at, scaled(unit(sub(after, at)), radius))
        for k in range(steps + 1):
            t = k / steps
            path.append(lerp(lerp(a, at, t), lerp(at, b, t), t))
    path.append(points[-1])
    return path


def process_piping(mesh):
    """Main line over a double bend up to the valve and down again, and a bypass with two small valves."""
    for sx in (-1, 1):
        line = [(sx * (BASE[0] + 0.35), 0.0, TIE_IN), (sx * 2.45, 0.0, TIE_IN), (sx * 1.75, 0.0, VALVE), (sx * 0.7, 0.0, VALVE)]
        mesh.sweep(bend(line, 0.32), PIPE_RADIUS, 20)
        for x, z in ((BASE[0] + 0.25, TIE_IN), (2.95, TIE_IN), (1.15, VALVE)):
            flange(mesh, (sx * x, 0.0, z), (1.0, 0.0, 0.0), PIPE_RADIUS + 0.15)
        mesh.box((sx * 2.7, 0.0, 0.32), (0.25, 0.7, 0.3))
    bypass = [(-1.5, 0.0, VALVE + 0.1), (-1.5, 0.0, VALVE + 0.75), (-1.5, 1.0, VALVE + 0.75), (1.5, 1.0, VALVE + 0.75),
              (1.5, 0.0, VALVE + 0.75), (1.5, 0.0, VALVE + 0.1)]
    mesh.sweep(bend(bypass, 0.2), 0.085, 12)
    for x in (-0.6, 0.6):
        mesh.box((x, 1.0, VALVE + 0.75), (0.34, 0.28, 0.30))
        mesh.tube((x, 1.0, VALVE + 0.85), (x, 1.0, VALVE + 1.25), 0.07, 10)
        mesh.tube((x, 1.0, VALVE + 1.25), (x, 1.0, VALVE + 1.31), 0.16, 14)


def valve(mesh):
    """Ball valve: body, end flanges, bonnet, hydraulic actuator with its spring can."""
    mesh.sphere((0.0, 0.0, VALVE), 0.60, 14, 22)
    for sx in (-1, 1):
        mesh.tube((sx * 0.42, 0.0, VALVE), (sx * 0.78, 0.0, VALVE), 0.45, 22)
        flange(mesh, (sx * 0.80, 0.0, VALVE), (1.0, 0.0, 0.0), 0.48)
    mesh.tube((0.0, 0.0, 0.35), (0.0, 0.0, VALVE - 0.45), 0.36, 18)
    mesh.tube((0.0, 0.0, VALVE + 0.4), (0.0, 0.0, VALVE + 0.95), 0.27, 18)
    flange(mesh, (0.0, 0.0, VALVE + 0.92), (0.0, 0.0, 1.0), 0.38)
    mesh.tube((-1.05, 0.0, VALVE + 1.32), (1.05, 0.0, VALVE + 1.32), 0.26, 20)
    mesh.box((0.0, 0.0, VALVE + 1.32), (0.62, 0.66, 0.62))
    for x in (-1.05, -0.45, 0.45, 1.05):
        mesh.tube((x - 0.04, 0.0, VALVE + 1.32), (x + 0.04, 0.0, VALVE + 1.32), 0.31, 20)


def controls(mesh):
    """Control module, accumulators, operating panel with its handles."""
    mesh.box((1.75, -1.15, 0.95), (0.9, 0.8, 1.2))
    mesh.box((1.75, -1.15, 1.62), (0.7, 0.6, 0.16))
    for k in range(4):
        x = -2.2 + 0.36 * k
        mesh.tube((x, -1.25, 0.40), (x, -1.25, 1.45), 0.14, 14)
        mesh.sphere((x, -1.25, 1.45), 0.14, 8, 14)
    mesh.box((0.0, -1.62, 1.15), (1.5, 0.10, 1.25))
    for i in range(3):
        for j in range(2):
            centre = (-0.5 + 0.5 * i, -1.67, 0.85 + 0.55 * j)
            mesh.tube(centre, add(centre, (0.0, -0.14, 0.0)), 0.13, 14)
    for x in (-0.72, 0.72):
        mesh.tube((x, -1.72, 0.6), (x, -1.72, 1.7), 0.03, 8)


def anodes(mesh):
    for sy in (-1, 1):
        for x in (-1.5, 0.0, 1.5):
            anode(mesh, (x, sy * (BASE[1] - 0.3), 0.42), (1.0, 0.0, 0.0))


def ssiv_meshes():
    """{part name: mesh}."""
    structure, piping, gear, covers = Mesh(), Mesh(), Mesh(), Mesh()
    for build in (foundation, frame, roof):
        build(structure)
    process_piping(piping)
    valve(piping)
    controls(gear)
    anodes(gear)
    side_covers(covers)
    return {"structure": structure, "piping": piping, "equipment": gear, "covers": covers}
