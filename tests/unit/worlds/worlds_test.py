"""The committed worlds: remade byte for byte, sound as geometry, and seen from their trajectories."""

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

SOURCE = pathlib.Path(sys.argv.pop(1) if len(sys.argv) > 1 else pathlib.Path(__file__).parents[3])
CONFIGS = SOURCE / "configs"
GENERATOR = CONFIGS / "worlds" / "generate" / "generate.py"
WORLDS = ("docking_station", "ssiv")


def generate(*arguments):
    return subprocess.run([sys.executable, "-B", GENERATOR, *arguments], capture_output=True, text=True, timeout=60)


@functools.cache
def read_ply(path):
    """(positions, normals, triangles) of a file as the generator writes it."""
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
            # A smoothed normal may lean over a needle of a triangle; turned-over surfaces would be all against.
            self.assertLessEqual(against, 0.002 * 3 * len(triangles), path.name)

    def test_every_file_an_sdf_names_is_there(self):
        for world in WORLDS:
            tree = ElementTree.parse(CONFIGS / "worlds" / f"{world}.sdf")
            uris = [element.text for tag in ("uri", "normal_map") for element in tree.iter(tag)]
            self.assertGreater(len(uris), 5)
            for uri in uris:
                self.assertTrue((CONFIGS / "worlds" / uri).is_file(), uri)

    def test_worlds_hold_tens_of_thousands_of_triangles_in_small_files(self):
        for world in WORLDS:
            tree = ElementTree.parse(CONFIGS / "worlds" / f"{world}.sdf")
            total = sum(len(read_ply(CONFIGS / "worlds" / element.text)[2]) for element in tree.iter("uri"))
            self.assertTrue(40_000 < total < 120_000, f"{world}: {total} triangles")
        size = sum(p.stat().st_size for p in (CONFIGS / "worlds").rglob("*") if p.is_file())
        self.assertLess(size, 6_000_000)


class Trajectories(unittest.TestCase):
    """The sonar is mounted 20 degrees down; its fan is 120 x 20 degrees and 20 m long."""

    def rows(self, name):
        with open(CONFIGS / "trajectories" / name, newline="") as file:
            return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]

    def in_fan(self, row, point):
        orientation = tuple(row[k] for k in ("qx", "qy", "qz", "qw"))
        inverse = (-orientation[0], -orientation[1], -orientation[2], orientation[3])
        x, y, z = rotated(inverse, tuple(p - row[k] for p, k in zip(point, "xyz")))
        tilt = math.radians(20.0)  # Ry(20 degrees) maps sonar to vehicle
        x, z = x * math.cos(tilt) - z * math.sin(tilt), x * math.sin(tilt) + z * math.cos(tilt)
        distance = math.hypot(x, y, z)
        return distance < 20.0 and abs(math.atan2(y, x)) < math.radians(60.0) and abs(math.asin(z / distance)) < math.radians(10.0)

    def test_poses_are_smooth_and_close_the_loop(self):
        for name in ("docking_demo.csv", "ssiv_demo.csv"):
            rows = self.rows(name)
            self.assertTrue(60.0 <= rows[-1]["t"] - rows[0]["t"] <= 90.0)
            for before, after in zip(rows, rows[1:]):
                step = after["t"] - before["t"]
                self.assertGreater(step, 0.0)
                speed = math.dist([before[k] for k in "xyz"], [after[k] for k in "xyz"]) / step
                self.assertLess(speed, 1.5, f"{name} at t = {after['t']}")
                self.assertAlmostEqual(math.hypot(*(after[k] for k in ("qx", "qy", "qz", "qw"))), 1.0, delta=1e-5)
            for key in ("x", "y", "z", "qx", "qy", "qz", "qw"):
                self.assertAlmostEqual(rows[0][key], rows[-1][key], delta=1e-3)

    def test_the_target_is_in_the_fan_all_the_way(self):
        # The middle of the base of each structure, at its pose in the SDF.
        for name, point in (("docking_demo.csv", (0.0, 0.6, -29.6)), ("ssiv_demo.csv", (0.0, 0.0, -41.5))):
            for row in self.rows(name):
                self.assertTrue(self.in_fan(row, point), f"{name} at t = {row['t']}")

    def test_the_demo_starts_with_the_pipeline_before_the_station(self):
        positions, _, _ = read_ply(CONFIGS / "worlds/meshes/docking_station/pipe.ply")
        start = self.rows("docking_demo.csv")[0]
        seen = [p for p in positions if self.in_fan(start, p)]
        self.assertGreater(max(p[0] for p in seen) - min(p[0] for p in seen), 12.0, "too little of the pipe is in the fan")

    def test_the_tum_file_holds_the_same_poses(self):
        rows = self.rows("ssiv_demo.csv")
        lines = (CONFIGS / "trajectories/ssiv_demo.tum").read_text().splitlines()
        poses = [[float(v) for v in line.split()] for line in lines if not line.startswith("#")]
        self.assertEqual(poses, [[row[k] for k in ("t", "x", "y", "z", "qx", "qy", "qz", "qw")] for row in rows])


if __name__ == "__main__":
    unittest.main()
