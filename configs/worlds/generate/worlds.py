# SPDX-License-Identifier: Apache-2.0
"""The worlds: where everything lies. Each function returns {path below configs/worlds: bytes}."""

import math

from boulders import boulder
from docking_station import rov_mesh, station_meshes, umbilical_mesh
from grid import HALF, grid_mesh
from manifold import FLOWLINE_RADIUS, cover_mesh, equipment_mesh
from manifold import HALF as COVER_HALF
from manifold import TIE_IN as FLOWLINE_TIE_IN
from mesh import Mesh, placed, yawed
from noise import smoothstep, uniform
from normal_map import CONCRETE_TILE_M, SAND_TILE_M, concrete_normal_map, sand_normal_map
from oil_and_gas import (HEADER, HEADER_OFFSETS, HEADER_RADIUS, HUBS, JACKET_FOOT, JUMPER_HUB, MANIFOLD, TREE, jacket_mesh, jumper_mesh,
                         manifold_mesh, riser_clamp_mesh, riser_mesh, tree_mesh)
from pipeline import Pipeline
from sdf import World
from seabed import Seabed
from ssiv import BASE, PIPE_RADIUS, TIE_IN, ssiv_meshes
from tank import DEPTH, TARGET_HEIGHT, tank_meshes

# Boulder shapes, reused at several places and scales.
BOULDER_SIZES = {"a": (1.9, 1.5, 1.2), "b": (1.2, 1.1, 0.9), "c": (0.9, 0.7, 0.6), "d": (2.6, 1.7, 1.3)}

# Coarse sand with shells. A sonar sees a shadow only on a bed that is this much brighter than fine sand.
SHELLY_SAND = ("sand", {"lambert_mu_db": -13})
# Concrete and stones that have lain on the bed for years. Soft growth absorbs: they glint less than bare ones.
GROWN_CONCRETE = ("concrete", {"pressure_reflection": 0.3})
GROWN_ROCK = ("rock", {"pressure_reflection": 0.5})

# Positions of the structures of oil_and_gas.
MANIFOLD_AT, TREE_AT, JACKET_AT = (0.0, 4.0), (7.5, -2.4), (0.0, -13.5)


def _boulder_files(folder):
    return {f"{folder}/boulder_{name}.ply": boulder(40 + k, size).ply()
            for k, (name, size) in enumerate(BOULDER_SIZES.items())}


def _pose(x, y, z, yaw):
    return f"{x:.3f} {y:.3f} {z:.3f} 0 0 {yaw:.3f}"


def _scour_boulders(seabed, boulders):
    for _, shape, x, y, scale, _ in boulders:
        seabed.scour((x, y), 0.55 * BOULDER_SIZES[shape][0] * scale, 0.10 * BOULDER_SIZES[shape][0] * scale)


def _add_boulders(world, seabed, boulders):
    for name, shape, x, y, scale, yaw in boulders:
        z = seabed.height(x, y) + 0.22 * BOULDER_SIZES[shape][2] * scale
        world.model(name, [("stone", f"meshes/boulders/boulder_{shape}.ply", GROWN_ROCK)], _pose(x, y, z, yaw), True,
                    None if scale == 1.0 else f"{scale} {scale} {scale}")


def _cobbles(seabed, seed, count, keep_out):
    """Stones of 10 to 25 cm, scattered in clusters and half sunk; one mesh."""
    stones = [boulder(70 + k, (1.0, 0.85, 0.7), levels=1) for k in range(3)]
    field = Mesh()
    placed_count, attempt = 0, 0
    while placed_count < count:
        attempt += 1
        cluster = attempt % 9
        reach = 1.0 + 2.5 * uniform(0.0, 1.0, seed, attempt, 1)
        angle = uniform(0.0, 2.0 * math.pi, seed, attempt, 2)
        x = uniform(-15.0, 15.0, seed, cluster, 3) + reach * math.cos(angle)
        y = uniform(-15.0, 15.0, seed, cluster, 4) + reach * math.sin(angle)
        if keep_out(x, y):
            continue
        size = 0.10 + 0.15 * uniform(0.0, 1.0, seed, attempt, 5) ** 2
        yaw = uniform(0.0, 2.0 * math.pi, seed, attempt, 6)
        turn = yawed(yaw)
        move = placed((x, y, seabed.height(x, y) + 0.10 * size), yaw)
        field.merge(stones[attempt % 3], lambda p, s=size, m=move: m((p[0] * s, p[1] * s, p[2] * s)), turn)
        placed_count += 1
    return field


def docking_station():
    folder = "meshes/docking_station"
    seabed = Seabed(seed=3, depth_m=29.979, undulation_m=0.30, ripple_height_m=0.05, ripple_length_m=1.35,
                    ripple_heading_rad=math.radians(68.0))

    def sway(x):
        return -3.7 + 0.7 * math.sin((x + 3.0) / 15.0) ** 2 - 0.30 * math.sin(x / 6.5)

    def burial(x):
        return 0.42 + 0.14 * math.sin(x / 4.3 + 0.8)

    pipe = Pipeline(seabed, sway, -29.0, 29.0, diameter_m=0.60, burial=burial)
    level = round(seabed.natural(0.0, 0.6), 3)
    seabed.flatten((0.0, 0.6), (2.3, 1.7), level, 2.4)
    station = placed((0.0, 0.6, level))
    for sx in (-1, 1):
        for sy in (-1, 1):
            seabed.scour((sx * 2.25, 0.6 + sy * 1.75), 0.60, 0.07)
    boulders = [  # name, shape, x, y, scale, yaw
        ("boulder_1", "d", 8.6, -0.6, 0.6, 0.4), ("boulder_2", "a", -9.5, 2.4, 0.6, 1.1), ("boulder_3", "b", -8.8, -7.6, 0.9, 3.0),
        ("boulder_4", "c", 1.6, 8.1, 1.0, 4.0), ("boulder_5", "b", 12.9, 9.4, 1.0, 0.7)]
    _scour_boulders(seabed, boulders)

    def keep_out(x, y):
        return abs(y - sway(x)) < 0.9 or (abs(x) < 3.2 and abs(y - 0.6) < 2.6)

    files = _boulder_files("meshes/boulders")
    parts = station_meshes()
    files |= {
        f"{folder}/seabed.ply": seabed.mesh(30.0, 13.5, 0.25, 1.09).ply(),
        f"{folder}/cobbles.ply": _cobbles(seabed, 5, 40, keep_out).ply(),
        f"{folder}/pipe.ply": pipe.pipe_mesh().ply(),
        f"{folder}/anodes.ply": pipe.anode_mesh((-21.0, -8.9, 3.4, 15.6)).ply(),
        f"{folder}/clamps.ply": pipe.clamp_mesh((-4.0, 8.6)).ply(),
        f"{folder}/mattress_west.ply": pipe.mattress_mesh(-12.6, 7).ply(),
        f"{folder}/mattress_east.ply": pipe.mattress_mesh(12.0, 8).ply(),
        f"{folder}/station_structure.ply": parts["structure"].ply(),
        f"{folder}/station_equipment.ply": parts["equipment"].ply(),
        f"{folder}/umbilical.ply": umbilical_mesh(seabed, station, ((-1.6, 3.6), (-4.2, 4.4), (-7.5, 9.0), (-12.0, 11.5), (-20.0, 19.0))).ply(),
        f"{folder}/rov.ply": rov_mesh().ply(),
    }
    world = World("docking_station", "A docking station beside a pipeline on a rippled seabed.")
    world.model("seabed", [("sand", f"{folder}/seabed.ply", SHELLY_SAND), ("cobbles", f"{folder}/cobbles.ply", GROWN_ROCK)])
    world.model("pipeline", [("pipe", f"{folder}/pipe.ply", GROWN_CONCRETE), ("anodes", f"{folder}/anodes.ply", "steel_fouled"),
                             ("clamps", f"{folder}/clamps.ply", "steel_fouled")])
    world.model("mattress_west", [("blocks", f"{folder}/mattress_west.ply", GROWN_CONCRETE)])
    world.model("mattress_east", [("blocks", f"{folder}/mattress_east.ply", GROWN_CONCRETE)])
    world.model("docking_station", [("structure", f"{folder}/station_structure.ply", "steel_fouled"),
                                    ("equipment", f"{folder}/station_equipment.ply", "steel_fouled")],
                pose=_pose(0.0, 0.6, level, 0.0), comment="4 x 3 x 2.5 m, entered from the west")
    world.model("umbilical", [("cable", f"{folder}/umbilical.ply", "rubber")])
    _add_boulders(world, seabed, boulders)
    world.model("rov", [("vehicle", f"{folder}/rov.ply", "aluminium")], _pose(-6.2, 1.4, seabed.height(-6.2, 1.4) + 1.5, -0.1),
                static=False, comment="Hovers before the station's entrance; moved by body poses")
    files["docking_station.sdf"] = world.text().encode("ascii")
    return files


def ssiv():
    folder = "meshes/ssiv"
    seabed = Seabed(seed=29, depth_m=41.998, undulation_m=0.30, ripple_height_m=0.04, ripple_length_m=1.6,
                    ripple_heading_rad=math.radians(20.0))

    def sway(x):
        out = max(0.0, abs(x) - 6.0)
        return 0.004 * out * out * (1.0 if x > 0.0 else -0.6)

    def burial(x):
        # Negative: the pipe is carried above the bed from the frame to its touch-down point.
        at_frame = 0.5 * (1.0 - TIE_IN / PIPE_RADIUS)
        t = smoothstep(BASE[0] + 0.3, 10.0, abs(x))
        return at_frame * (1.0 - t) + (0.42 + 0.10 * math.sin(x / 5.0)) * t

    level = round(seabed.natural(0.0, 0.0), 3)
    seabed.flatten((0.0, 0.0), (4.2, 3.2), level, 3.0)
    natural = seabed.natural

    def natural_at_frame(x, y):
        keep = smoothstep(4.2, 7.2, math.hypot(x, y))
        return level * (1.0 - keep) + natural(x, y) * keep

    seabed.natural = natural_at_frame
    reach = BASE[0] + 0.3
    west = Pipeline(seabed, sway, -29.0, -reach, 2.0 * PIPE_RADIUS, burial)
    east = Pipeline(seabed, sway, reach, 29.0, 2.0 * PIPE_RADIUS, burial)
    for sx in (-1, 1):
        for sy in (-1, 1):
            seabed.scour((sx * 3.9, sy * 3.1), 0.7, 0.07)
    boulders = [("boulder_1", "b", -8.5, 5.2, 1.0, 0.3), ("boulder_2", "a", 9.5, 9.5, 0.9, 1.9), ("boulder_3", "c", 6.0, -6.2, 0.8, 4.4),
                ("boulder_4", "c", -6.6, -7.1, 0.8, 2.7), ("boulder_5", "d", 2.5, 10.5, 0.8, 0.8)]
    _scour_boulders(seabed, boulders)

    def keep_out(x, y):
        return abs(y - sway(x)) < 0.9 or (abs(x) < 5.0 and abs(y) < 4.0)

    pipes, anodes = Mesh(), Mesh()
    for part in (west, east):
        pipes.merge(part.pipe_mesh())
    anodes.merge(west.anode_mesh((-18.0, -8.0)))
    anodes.merge(east.anode_mesh((8.0, 18.0)))
    parts = ssiv_meshes()
    files = _boulder_files("meshes/boulders")
    files |= {f"{folder}/ssiv_{name}.ply": mesh.ply() for name, mesh in parts.items()}
    files |= {
        "textures/sand_normal.png": sand_normal_map(3),
        f"{folder}/seabed.ply": seabed.mesh(30.0, 13.0, 0.28, 1.1).ply(SAND_TILE_M),
        f"{folder}/cobbles.ply": _cobbles(seabed, 9, 30, keep_out).ply(),
        f"{folder}/pipe.ply": pipes.ply(),
        f"{folder}/anodes.ply": anodes.ply(),
        f"{folder}/mattress_west.ply": west.mattress_mesh(-12.5, 17, along=11, across=7).ply(),
        f"{folder}/mattress_east.ply": east.mattress_mesh(12.5, 18, along=11, across=7).ply(),
    }
    world = World("ssiv", "A subsea isolation valve in its protective frame, tied in to a pipeline.")
    world.model("seabed", [("sand", f"{folder}/seabed.ply", SHELLY_SAND, "textures/sand_normal.png"), ("cobbles", f"{folder}/cobbles.ply", GROWN_ROCK)])
    world.model("pipeline", [("pipe", f"{folder}/pipe.ply", GROWN_CONCRETE), ("anodes", f"{folder}/anodes.ply", "steel_fouled")])
    world.model("mattress_west", [("blocks", f"{folder}/mattress_west.ply", GROWN_CONCRETE)])
    world.model("mattress_east", [("blocks", f"{folder}/mattress_east.ply", GROWN_CONCRETE)])
    world.model("ssiv", [("structure", f"{folder}/ssiv_structure.ply", "steel_fouled"), ("piping", f"{folder}/ssiv_piping.ply", "steel_fouled"),
                         ("equipment", f"{folder}/ssiv_equipment.ply", "steel_fouled"), ("covers", f"{folder}/ssiv_covers.ply", "pvc")],
                pose=_pose(0.0, 0.0, level, 0.0), comment="7.2 x 5 m at the base, 3.2 m high; covers are glass-fibre plastic")
    _add_boulders(world, seabed, boulders)
    files["ssiv.sdf"] = world.text().encode("ascii")
    return files


def manifold():
    folder = "meshes/manifold"
    seabed = Seabed(seed=61, depth_m=25.147, undulation_m=0.20, ripple_height_m=0.03, ripple_length_m=2.1,
                    ripple_heading_rad=math.radians(115.0))

    def sway(x):
        return 0.35 * math.sin(max(0.0, abs(x) - 8.0) / 7.0) * (1.0 if x > 0.0 else -1.0)

    def burial(x):
        # Negative: the flowlines come down from the ends of the cover.
        at_end = 0.5 * (1.0 - FLOWLINE_TIE_IN / FLOWLINE_RADIUS)
        t = smoothstep(COVER_HALF[0] + 0.5, 8.5, abs(x))
        return at_end * (1.0 - t) + (0.65 + 0.06 * math.sin(x / 4.0)) * t

    level = round(seabed.natural(0.0, 0.0), 3)
    natural = seabed.natural

    def natural_at_cover(x, y):
        keep = smoothstep(3.5, 7.5, math.hypot(x, y))
        return level * (1.0 - keep) + natural(x, y) * keep

    seabed.natural = natural_at_cover
    reach = COVER_HALF[0] + 0.5
    west = Pipeline(seabed, sway, -27.0, -reach, 2.0 * FLOWLINE_RADIUS, burial, 0.03)
    east = Pipeline(seabed, sway, reach, 27.0, 2.0 * FLOWLINE_RADIUS, burial, 0.03)
    # The corridor of the installation: level under the cover and as far as its shadow reaches in the demo.
    seabed.flatten((0.0, 3.9), (3.6, 6.9), level, 3.0)
    for sx in (-1, 1):
        seabed.scour((sx * 3.4, -1.8), 0.7, 0.08)
    boulders = [("boulder_1", "d", -11.5, 8.2, 0.6, 0.6), ("boulder_2", "a", 10.5, 9.0, 0.6, 2.2), ("boulder_3", "b", 13.0, 4.5, 0.8, 4.0)]
    _scour_boulders(seabed, boulders)
    pipes, anodes = Mesh(), Mesh()
    for line, places in ((west, (-16.0, -8.2)), (east, (9.3, 17.0))):
        pipes.merge(line.pipe_mesh())
        anodes.merge(line.anode_mesh(places))
    files = _boulder_files("meshes/boulders")
    files |= {
        "textures/sand_normal.png": sand_normal_map(3),
        f"{folder}/seabed.ply": seabed.mesh(28.0, 12.0, 0.36, 1.12).ply(SAND_TILE_M),
        f"{folder}/flowlines.ply": pipes.ply(),
        f"{folder}/anodes.ply": anodes.ply(),
        f"{folder}/cover.ply": cover_mesh().ply(),
        f"{folder}/equipment.ply": equipment_mesh().ply(),
    }
    world = World("manifold", "A manifold under its cover, with a flowline at each end, on an uneven seabed.")
    world.model("seabed", [("sand", f"{folder}/seabed.ply", SHELLY_SAND, "textures/sand_normal.png")])
    world.model("flowlines", [("pipes", f"{folder}/flowlines.ply", GROWN_CONCRETE), ("anodes", f"{folder}/anodes.ply", "steel_fouled")])
    world.model("manifold", [("cover", f"{folder}/cover.ply", "steel_fouled"), ("equipment", f"{folder}/equipment.ply", "steel_fouled")],
                pose=_pose(0.0, 0.0, level, 0.0), comment="6 x 2.8 m, 1.8 m high, open towards the south")
    _add_boulders(world, seabed, boulders)
    files["manifold.sdf"] = world.text().encode("ascii")
    return files


def tank():
    folder = "meshes/tank"
    tiles = {"lining": CONCRETE_TILE_M}
    files = {f"{folder}/{name}.ply": mesh.ply(tiles.get(name)) for name, mesh in tank_meshes().items()}
    files["textures/concrete_normal.png"] = concrete_normal_map(17)
    world = World("tank", "A concrete test tank, 14 x 10 m and 8 m deep, with a few things in it.")
    world.model("tank", [("lining", f"{folder}/lining.ply", "concrete", "textures/concrete_normal.png")],
                comment="Inner faces at x = -7 and 7, y = -5 and 5, z = -8")
    world.model("water_surface", [("surface", f"{folder}/surface.ply", "air")])
    world.model("ladder", [("ladder", f"{folder}/ladder.ply", "steel")])
    world.model("pillar", [("pillar", f"{folder}/pillar.ply", "concrete")])
    world.model("inlet", [("pipe", f"{folder}/inlet.ply", "steel")])
    world.model("target", [("sphere", f"{folder}/target.ply", "steel")], _pose(0.5, -3.1, TARGET_HEIGHT - DEPTH, 0.0),
                static=False, comment="A sphere of radius 0.25 m, moored; its origin is its centre")
    files["tank.sdf"] = world.text().encode("ascii")
    return files


def grid():
    folder = "meshes/grid"
    seabed = Seabed(seed=7, depth_m=12.0, undulation_m=0.08, ripple_height_m=0.05, ripple_length_m=1.9, ripple_heading_rad=0.5)
    seabed.flatten((0.0, 0.0), (HALF + 0.4, HALF + 0.4), -12.0, 3.0)
    files = {
        "textures/sand_normal.png": sand_normal_map(3),
        f"{folder}/seabed.ply": seabed.mesh(25.0, 6.0, 0.5, 1.15).ply(SAND_TILE_M),
        f"{folder}/grid.ply": grid_mesh().ply(),
    }
    world = World("grid", "A cage of bars on a sandy bed, 8 x 8 x 8 m, a bar every metre.")
    world.model("seabed", [("sand", f"{folder}/seabed.ply", "sand", "textures/sand_normal.png")])
    world.model("grid", [("bars", f"{folder}/grid.ply", "steel_fouled")], _pose(0.0, 0.0, -8.0, 0.0),
                comment="Upright bars at whole metres on x = -4 and 4 and on y = -4 and 4; the gate is in the middle of x = 4")
    files["grid.sdf"] = world.text().encode("ascii")
    return files


def _flowlines(seabed):
    """Two pipes from each end of the manifold's headers down to the bed and away."""

    def burial(x):
        # Negative: the headers are higher than a pipe on the bed.
        at_header = 0.5 * (1.0 - HEADER / HEADER_RADIUS)
        keep = smoothstep(2.9, 9.0, abs(x))
        return at_header * (1.0 - keep) + 0.2 * keep

    lines = [Pipeline(seabed, lambda x, y=MANIFOLD_AT[1] + offset: y, start, end, 2.0 * HEADER_RADIUS, burial)
             for offset in HEADER_OFFSETS for start, end in ((-24.0, -2.9), (2.9, 24.0))]
    mesh = Mesh()
    for line in lines:
        mesh.merge(line.pipe_mesh())
    return mesh


def _risers_and_jumper(level):
    """{part name: mesh} of what joins jacket, manifold and tree; in world coordinates."""
    risers, clamps = Mesh(), Mesh()
    for x, radius in zip(HUBS, (0.20, 0.14)):
        foot = (x, JACKET_AT[1] + JACKET_FOOT[1] + 0.75)
        hub = (MANIFOLD_AT[0] + x, MANIFOLD_AT[1] - MANIFOLD[1] - 0.25, level + HEADER)
        risers.merge(riser_mesh(foot, hub, level, 1.0, radius))
        clamps.merge(riser_clamp_mesh(foot, level, radius))
    at_tree = (TREE_AT[0], TREE_AT[1] + TREE[1] + 0.25, level + HEADER)
    at_manifold = (MANIFOLD_AT[0] + MANIFOLD[0] + 0.25, MANIFOLD_AT[1] + JUMPER_HUB, level + HEADER)
    return {"risers": risers, "riser_clamps": clamps, "jumper": jumper_mesh(at_tree, at_manifold, level + 2.9, 0.13)}


def oil_and_gas():
    folder = "meshes/oil_and_gas"
    seabed = Seabed(seed=53, depth_m=29.994, undulation_m=0.30, ripple_height_m=0.05, ripple_length_m=1.7,
                    ripple_heading_rad=math.radians(35.0))
    level = round(seabed.natural(*MANIFOLD_AT), 3)
    for place, half_size in ((MANIFOLD_AT, (2.6, 1.9)), (TREE_AT, (1.3, 1.3)), (JACKET_AT, (7.0, 7.0))):
        seabed.flatten(place, half_size, level, 3.0)
    natural = seabed.natural

    def natural_at_manifold(x, y):
        keep = smoothstep(3.5, 8.0, math.dist((x, y), MANIFOLD_AT))
        return level * (1.0 - keep) + natural(x, y) * keep

    seabed.natural = natural_at_manifold

    flowlines = _flowlines(seabed)
    lines = _risers_and_jumper(level)
    boulders = [("boulder_1", "a", 12.5, 0.6, 1.0, 0.5), ("boulder_2", "c", 4.2, -3.9, 1.0, 2.2), ("boulder_3", "b", -5.6, -1.5, 1.0, 4.1),
                ("boulder_4", "d", -11.0, -4.2, 0.9, 1.0)]
    _scour_boulders(seabed, boulders)
    files = _boulder_files("meshes/boulders")
    files |= {
        "textures/sand_normal.png": sand_normal_map(3),
        f"{folder}/seabed.ply": seabed.mesh(26.0, 10.4, 0.4, 1.12).ply(SAND_TILE_M),
        f"{folder}/flowlines.ply": flowlines.ply(),
        f"{folder}/jacket.ply": jacket_mesh(31.0).ply(),
        f"{folder}/manifold.ply": manifold_mesh().ply(),
        f"{folder}/tree.ply": tree_mesh().ply(),
    }
    files |= {f"{folder}/{name}.ply": mesh.ply() for name, mesh in lines.items()}
    world = World("oil_and_gas", "A jacket with two risers, a manifold with flowlines, and a wellhead tree.")
    world.model("seabed", [("sand", f"{folder}/seabed.ply", "sand", "textures/sand_normal.png")])
    world.model("flowlines", [("pipes", f"{folder}/flowlines.ply", "concrete")])
    world.model("jacket", [("structure", f"{folder}/jacket.ply", "steel_fouled")], _pose(*JACKET_AT, level, 0.0))
    world.model("risers", [("pipes", f"{folder}/risers.ply", "steel"), ("clamps", f"{folder}/riser_clamps.ply", "steel_fouled")])
    world.model("manifold", [("structure", f"{folder}/manifold.ply", "steel_fouled")], _pose(*MANIFOLD_AT, level, 0.0))
    world.model("tree", [("structure", f"{folder}/tree.ply", "steel_fouled")], _pose(*TREE_AT, level, 0.0))
    world.model("jumper", [("pipe", f"{folder}/jumper.ply", "steel")])
    _add_boulders(world, seabed, boulders)
    files["oil_and_gas.sdf"] = world.text().encode("ascii")
    return files
