# SPDX-License-Identifier: Apache-2.0
"""The worlds: the generator makes the committed bytes, their geometry is sound, and trajectories see their targets."""

import csv
import functools
import math
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as ElementTree
import zlib

SOURCE = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[4])
CONFIGS = SOURCE / "configs"
GENERATOR = CONFIGS / "worlds" / "generate" / "generate.py"
# The least number of triangles in each: a tank has flat walls, and a cage straight bars.
WORLDS = {"docking_station": 40_000, "ssiv": 40_000, "manifold": 20_000, "tank": 3_000, "grid": 3_000, "oil_and_gas": 30_000}


def generate(*arguments):
    return subprocess.run([sys.executable, "-B", GENERATOR, *arguments], capture_output=True, text=True, timeout=300)


@functools.cache
def read_ply(path):
    """(positions, normals, triangles) of a file in the generator's format."""
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    header = data[:end].decode("ascii")
    vertex_count = int(re.search(r"element vertex (\d+)", header).group(1))
    face_count = int(re.search(r"element face (\d+)", header).group(1))
    floats = header.count("property float")
    faces_at = end + 4 * floats * vertex_count
    vertices = list(struct.iter_unpack(f"<{floats}f", data[end:faces_at]))
    faces = list(struct.iter_unpack("<B3i", data[faces_at:]))
    assert len(faces) == face_count and all(face[0] == 3 for face in faces)
    return [v[:3] for v in vertices], [v[3:6] for v in vertices], [face[1:] for face in faces]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def rotated(quaternion, v):
    """v turned by a unit quaternion (x, y, z, w)."""
    axis, w = quaternion[:3], quaternion[3]
    t = tuple(2.0 * c for c in cross(axis, v))
    return tuple(p + w * q + r for p, q, r in zip(v, t, cross(axis, t)))


def rows(name):
    """The poses of a trajectory, each as a dictionary by column."""
    with open(CONFIGS / "trajectories" / name, newline="") as file:
        return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def position(row):
    return (row["x"], row["y"], row["z"])


def moved(points, offset):
    return [tuple(p + o for p, o in zip(point, offset)) for point in points]


def first_hit(origin, direction, triangles):
    """Distance along a unit direction to the nearest triangle (three corners each); infinity if it hits none."""
    nearest = math.inf
    for a, b, c in triangles:
        edge1, edge2, offset = ([q - p for p, q in zip(a, other)] for other in (b, c, origin))
        normal = cross(direction, edge2)
        determinant = dot(edge1, normal)
        if determinant == 0.0:
            continue
        across = cross(offset, edge1)
        u, v = dot(offset, normal) / determinant, dot(direction, across) / determinant
        distance = dot(edge2, across) / determinant
        if u >= 0.0 and v >= 0.0 and u + v <= 1.0 and distance > 0.0:
            nearest = min(nearest, distance)
    return nearest


def direction(bearing_deg, elevation_deg=0.0):
    """A unit vector; bearings from east to north, elevations upwards."""
    bearing, elevation = math.radians(bearing_deg), math.radians(elevation_deg)
    return (math.cos(elevation) * math.cos(bearing), math.cos(elevation) * math.sin(bearing), math.sin(elevation))


def corners(path, offset=(0.0, 0.0, 0.0)):
    positions, _, triangles = read_ply(CONFIGS / "worlds/meshes" / path)
    positions = moved(positions, offset)
    return [tuple(positions[k] for k in triangle) for triangle in triangles]


class Regeneration(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.made = pathlib.Path(self.folder.name)
        made = generate("--out", self.made)
        self.assertEqual(made.returncode, 0, made.stderr)

    def test_committed_files_are_what_the_generator_makes(self):
        files = sorted(p.relative_to(self.made) for p in self.made.rglob("*") if p.is_file())
        self.assertGreater(len(files), 20)
        for path in files:
            self.assertEqual((self.made / path).read_bytes(), (CONFIGS / path).read_bytes(), path)
        for mesh in (CONFIGS / "worlds").rglob("*.ply"):
            self.assertIn(mesh.relative_to(CONFIGS), files, "no tool makes this mesh")

    def test_check_names_a_file_that_differs_and_no_other(self):
        mesh = self.made / "worlds/meshes/docking_station/pipe.ply"
        data = bytearray(mesh.read_bytes())
        data[-1] ^= 1
        mesh.write_bytes(data)
        checked = generate("--out", self.made, "--check")
        self.assertEqual(checked.returncode, 1)
        self.assertEqual(checked.stderr.count("\n"), 1)
        self.assertIn("docking_station/pipe.ply", checked.stderr)


class Geometry(unittest.TestCase):
    def test_triangles_have_area_and_face_the_way_their_normals_say(self):
        for path in sorted((CONFIGS / "worlds" / "meshes").rglob("*.ply")):
            positions, normals, triangles = read_ply(path)
            for normal in normals:
                self.assertAlmostEqual(dot(normal, normal), 1.0, delta=5e-3, msg=path.name)
            against = 0
            for a, b, c in triangles:
                p, q, r = positions[a], positions[b], positions[c]
                face = cross([y - x for x, y in zip(p, q)], [y - x for x, y in zip(p, r)])
                self.assertGreater(dot(face, face), 0.0, f"{path.name}: triangle without area")
                against += sum(dot(face, normals[k]) < 0.0 for k in (a, b, c))
            # A smoothed normal may point away from a thin triangle; on an inverted surface all normals would.
            self.assertLessEqual(against, 0.002 * 3 * len(triangles), path.name)

    def test_every_file_an_sdf_names_is_there(self):
        for world in WORLDS:
            tree = ElementTree.parse(CONFIGS / "worlds" / f"{world}.sdf")
            uris = [element.text for tag in ("uri", "normal_map") for element in tree.iter(tag)]
            self.assertGreater(len(uris), 2)
            for uri in uris:
                self.assertTrue((CONFIGS / "worlds" / uri).is_file(), uri)

    def test_worlds_hold_thousands_of_triangles_in_small_files(self):
        for world, least in WORLDS.items():
            tree = ElementTree.parse(CONFIGS / "worlds" / f"{world}.sdf")
            total = sum(len(read_ply(CONFIGS / "worlds" / element.text)[2]) for element in tree.iter("uri"))
            self.assertTrue(least < total < 120_000, f"{world}: {total} triangles")
        size = sum(p.stat().st_size for p in (CONFIGS / "worlds").rglob("*") if p.is_file())
        self.assertLess(size, 7_000_000)


class Trajectories(unittest.TestCase):
    def test_poses_are_smooth_and_close_the_loop(self):
        for name in ("docking_demo.csv", "ssiv_demo.csv", "manifold_demo.csv", "tank.csv", "grid.csv", "oil_and_gas.csv"):
            poses = rows(name)
            self.assertTrue(40.0 <= poses[-1]["t"] - poses[0]["t"] <= 90.0)
            for before, after in zip(poses, poses[1:]):
                step = after["t"] - before["t"]
                self.assertGreater(step, 0.0)
                self.assertLess(math.dist(position(before), position(after)) / step, 1.5, f"{name} at t = {after['t']}")
                self.assertAlmostEqual(math.hypot(*(after[k] for k in ("qx", "qy", "qz", "qw"))), 1.0, delta=1e-5)
            for key in ("x", "y", "z", "qx", "qy", "qz", "qw"):
                self.assertAlmostEqual(poses[0][key], poses[-1][key], delta=1e-3)


class Surveys(unittest.TestCase):
    """The sonar is mounted 20 degrees down; its fan is 120 x 20 degrees and 20 m long."""

    def in_fan(self, row, point):
        orientation = tuple(row[k] for k in ("qx", "qy", "qz", "qw"))
        inverse = (-orientation[0], -orientation[1], -orientation[2], orientation[3])
        x, y, z = rotated(inverse, tuple(p - row[k] for p, k in zip(point, "xyz")))
        tilt = math.radians(20.0)  # Ry(20 degrees) maps sonar to vehicle
        x, z = x * math.cos(tilt) - z * math.sin(tilt), x * math.sin(tilt) + z * math.cos(tilt)
        distance = math.hypot(x, y, z)
        return distance < 20.0 and abs(math.atan2(y, x)) < math.radians(60.0) and abs(math.asin(z / distance)) < math.radians(10.0)

    def test_the_target_is_in_the_fan_all_the_way(self):
        # The middle of the base of each structure, at its pose in the SDF.
        for name, point in (("docking_demo.csv", (0.0, 0.6, -29.6)), ("ssiv_demo.csv", (0.0, 0.0, -41.5)),
                            ("manifold_demo.csv", (0.0, 0.0, -24.8))):
            for row in rows(name):
                self.assertTrue(self.in_fan(row, point), f"{name} at t = {row['t']}")

    def test_the_demo_starts_with_the_pipeline_before_the_station(self):
        positions, _, _ = read_ply(CONFIGS / "worlds/meshes/docking_station/pipe.ply")
        start = rows("docking_demo.csv")[0]
        seen = [p for p in positions if self.in_fan(start, p)]
        self.assertGreater(max(p[0] for p in seen) - min(p[0] for p in seen), 12.0, "too little of the pipe is in the fan")


class Manifold(unittest.TestCase):
    """The numbers of docs/worlds.md that tests of its image use."""

    LEVEL = -25.16

    def test_it_stands_on_the_level_that_the_sdf_says(self):
        pose = ElementTree.parse(CONFIGS / "worlds/manifold.sdf").find(".//model[@name='manifold']/pose").text
        self.assertEqual([float(v) for v in pose.split()], [0.0, 0.0, self.LEVEL, 0.0, 0.0, 0.0])
        self.assertEqual(position(rows("manifold_demo.csv")[0]), (0.0, -11.9, self.LEVEL + 5.5))

    def test_roof_is_flat_and_the_highest(self):
        cover, _, _ = read_ply(CONFIGS / "worlds/meshes/manifold/cover.ply")
        equipment, _, _ = read_ply(CONFIGS / "worlds/meshes/manifold/equipment.ply")
        roof = [p for p in cover if abs(p[2] - 1.8) < 1e-6]
        for axis, half in ((0, 3.0), (1, 1.4)):
            self.assertAlmostEqual(min(p[axis] for p in roof), -half, delta=1e-6)
            self.assertAlmostEqual(max(p[axis] for p in roof), half, delta=1e-6)
        self.assertLessEqual(max(p[2] for p in cover + equipment), 1.8 + 1e-6)

    def test_nothing_is_heard_through_the_back(self):
        cover = corners("manifold/cover.ply")
        for x in (-2.9, -1.3, 0.0, 1.7, 2.9):
            for z in (0.1, 0.7, 1.3, 1.79):
                self.assertAlmostEqual(first_hit((x, 5.0, z), (0.0, -1.0, 0.0), cover), 3.6, delta=1e-6)

    def test_the_bed_is_level_where_the_shadow_ends(self):
        bed, _, _ = read_ply(CONFIGS / "worlds/meshes/manifold/seabed.ply")
        corridor = [p for p in bed if abs(p[0]) <= 3.6 and 1.4 < p[1] <= 10.8]
        self.assertGreater(len(corridor), 300)
        for point in corridor:
            self.assertAlmostEqual(point[2], self.LEVEL, delta=0.002)


class Tank(unittest.TestCase):
    """A head that sweeps the horizon from the start of tank.csv, with a beam 35 degrees high."""

    # The objects in the tank, in degrees from the bow to port: docs/worlds.md.
    SECTORS = {"ladder": (67, 73), "pillar": (11, 18), "inlet": (155, 165), "target": (-66, -54)}

    def test_walls_are_heard_where_four_planes_say_and_nothing_else_in_the_beam(self):
        start = position(rows("tank.csv")[0])
        walls = corners("tank/lining.ply") + corners("tank/surface.ply")
        for elevation in (-22.0, -17.5, 0.0, 10.0, 22.0):
            for step in range(400):
                ray = direction(0.9 * step, elevation)
                to_x = ((7.0 if ray[0] > 0.0 else -7.0) - start[0]) / ray[0] if abs(ray[0]) > 1e-9 else math.inf
                to_y = ((5.0 if ray[1] > 0.0 else -5.0) - start[1]) / ray[1] if abs(ray[1]) > 1e-9 else math.inf
                self.assertAlmostEqual(first_hit(start, ray, walls), min(to_x, to_y), delta=1e-5, msg=f"{0.9 * step} degrees")

    def test_walls_face_the_water(self):
        positions, normals, _ = read_ply(CONFIGS / "worlds/meshes/tank/lining.ply")
        for point, normal in zip(positions, normals):
            self.assertGreater(dot([c - p for p, c in zip(point, (0.0, 0.0, -4.0))], normal), 0.0)

    def test_things_in_the_tank_keep_to_their_sectors(self):
        start = position(rows("tank.csv")[0])
        world = ElementTree.parse(CONFIGS / "worlds/tank.sdf")
        for name, (low, high) in self.SECTORS.items():
            pose = [float(v) for v in world.find(f".//model[@name='{name}']/pose").text.split()]
            self.assertEqual(pose[3:], [0.0, 0.0, 0.0])
            positions, _, _ = read_ply(CONFIGS / f"worlds/meshes/tank/{name}.ply")
            for x, y, _ in moved(positions, [p - s for p, s in zip(pose, start)]):
                self.assertTrue(low < math.degrees(math.atan2(y, x)) < high, f"{name}: {x}, {y}")

    def test_the_concrete_is_rough_and_flat_on_average(self):
        data = (CONFIGS / "worlds/textures/concrete_normal.png").read_bytes()
        at = data.index(b"IDAT")
        length = int.from_bytes(data[at - 4:at], "big")
        size = int.from_bytes(data[16:20], "big")
        pixels = zlib.decompress(data[at + 4:at + 4 + length])
        self.assertEqual(len(pixels), size * (1 + 3 * size))
        slopes = [[], []]
        for row in range(size):
            texels = pixels[row * (1 + 3 * size) + 1:(row + 1) * (1 + 3 * size)]
            for red, green, blue in struct.iter_unpack("3B", texels):
                self.assertGreater(blue, 200)
                for axis, value in enumerate((red, green)):
                    slopes[axis].append((value - 127.5) / (blue - 127.5))
        for axis in slopes:
            self.assertAlmostEqual(sum(axis) / len(axis), 0.0, delta=0.005)
            self.assertTrue(0.05 < math.sqrt(sum(v * v for v in axis) / len(axis)) < 0.3)


class Grid(unittest.TestCase):
    """A head that sweeps the horizon from the middle of the cage."""

    HERE = (0.0, 0.0, -8.0)

    def test_an_upright_bar_stands_at_every_metre_but_in_the_gate(self):
        cage = corners("grid/grid.ply", self.HERE)
        between_rails = (0.0, 0.0, -7.5)
        ring = [(x, y) for x in range(-4, 5) for y in range(-4, 5) if 4 in (abs(x), abs(y))]
        self.assertEqual(len(ring), 32)
        for x, y in ring:
            bearing = math.degrees(math.atan2(y, x))
            seen = first_hit(between_rails, direction(bearing), cage)
            radius = 0.10 if abs(x) == abs(y) else 0.04
            # The bars have 16 flat sides.
            self.assertAlmostEqual(seen, math.inf if (x, y) == (4, 0) else math.hypot(x, y) - radius, delta=0.003, msg=f"bar {x}, {y}")
            self.assertEqual(first_hit(between_rails, direction(bearing + 3.5), cage), math.inf)

    def test_the_cage_stands_in_the_bed_and_the_bed_is_out_of_the_beam(self):
        bed, _, _ = read_ply(CONFIGS / "worlds/meshes/grid/seabed.ply")
        lowest = min(p[2] for p in read_ply(CONFIGS / "worlds/meshes/grid/grid.ply")[0]) + self.HERE[2]
        for point in bed:
            if max(abs(point[0]), abs(point[1])) <= 4.2:
                self.assertTrue(lowest < point[2] < lowest + 0.5)
            distance = math.dist(point, self.HERE)
            self.assertTrue(distance > 10.0 or point[2] - self.HERE[2] < -distance * math.sin(math.radians(17.5)))

    def test_the_vehicle_turns_20_degrees_to_port_at_2_degrees_a_second(self):
        poses = rows("grid.csv")
        for before, after in zip(poses, poses[1:]):
            self.assertLessEqual(after["t"] - before["t"], 0.0201)
        for row in poses:
            self.assertEqual(position(row), self.HERE)
            self.assertEqual((row["qx"], row["qy"]), (0.0, 0.0))
            t = row["t"]
            expected = 0.0 if t < 10 else 2.0 * (t - 10.0) if t < 20 else 20.0 if t < 30 else 20.0 - 2.0 * (t - 30.0)
            self.assertAlmostEqual(math.degrees(2.0 * math.atan2(row["qz"], row["qw"])), expected, delta=2e-4)


class OilAndGas(unittest.TestCase):
    """A head that sweeps the plane across the vehicle, with a beam 35 degrees wide along the vehicle."""

    FOLDER = CONFIGS / "worlds/meshes/oil_and_gas"

    def placed(self, name):
        """Vertices of a mesh in the world."""
        models = ElementTree.parse(CONFIGS / "worlds/oil_and_gas.sdf").iter("model")
        model = next(m for m in models if any(uri.text.endswith(f"oil_and_gas/{name}.ply") for uri in m.iter("uri")))
        pose = [float(v) for v in model.find("pose").text.split()]
        self.assertEqual(pose[3:], [0.0, 0.0, 0.0])
        return moved(read_ply(self.FOLDER / f"{name}.ply")[0], pose)

    def sides_in_slice(self, name, start):
        """The sides of the vehicle, port 1 and starboard -1, with vertices in the beam within 10 m."""
        beam = math.tan(math.radians(17.5))
        relative = moved(self.placed(name), [-c for c in start])
        return {math.copysign(1, y) for x, y, z in relative if abs(x) < beam * math.hypot(y, z) and math.hypot(x, y, z) < 10.0}

    def test_both_stations_have_structures_at_both_sides(self):
        poses = rows("oil_and_gas.csv")
        first, second = position(poses[0]), position(poses[len(poses) // 2])
        self.assertEqual(position(poses[200]), first)    # 20 s of rest
        self.assertEqual(position(poses[600]), second)
        for start, name, side in ((first, "manifold", 1), (first, "jacket", -1), (second, "flowlines", 1), (second, "tree", -1),
                                  (second, "jacket", -1)):
            self.assertEqual(self.sides_in_slice(name, start), {side}, name)
        self.assertIn(-1, self.sides_in_slice("risers", first))

    def test_the_vehicle_passes_clear_of_everything(self):
        obstacles = [p for path in self.FOLDER.glob("*.ply") for p in self.placed(path.stem)]
        for row in rows("oil_and_gas.csv")[200:400:20]:
            self.assertGreater(min(math.dist(position(row), p) for p in obstacles), 1.5)

    def test_structures_reach_into_the_bed(self):
        bed = self.placed("seabed")
        for name in ("jacket", "manifold", "tree", "risers", "flowlines"):
            points = self.placed(name)
            x, y, z = min(points, key=lambda p: p[2])
            nearest = min(bed, key=lambda p: math.dist(p[:2], (x, y)))
            self.assertLess(z, nearest[2], f"{name} stands above the bed")


if __name__ == "__main__":
    unittest.main()
