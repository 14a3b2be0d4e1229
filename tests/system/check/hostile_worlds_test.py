#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Worlds that were written to do harm: `sonard check` names the file and its fault, and reads no other file.

    hostile_worlds_test.py PROGRAM
"""

import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import unittest
import zlib

PROGRAM = None
SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
SHARED = os.path.join(SOURCE, "tests", "data", "worlds")
HANGS_S = 60  # a world is refused in seconds; a fifo or a device once held the start for good

CONFIGURATION = """\
world: {file: world.sdf}
poses:
  initial: {position_m: [0, 0, -3]}
  udp: {bind: 127.0.0.1:14600}
engine: cpu
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    network: {bind: 127.0.0.2, alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}
"""
MESH = "<mesh><uri>%s</uri></mesh>"
HEIGHTMAP = "<heightmap><uri>%s</uri><size>9 9 3</size></heightmap>"
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def visual(geometry, name="v"):
    return '<visual name="%s"><geometry>%s</geometry></visual>' % (name, geometry)


def model(visuals):
    return '<model name="m"><link name="l">%s</link></model>' % visuals


def png(width, height):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes((x * y) % 256 for x in range(width)) for y in range(height))
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")


def ply(promised, there):
    return ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n" % promised
            + "3 0 1 2\n" * there).encode()


def text_stl(facets):
    return ("solid hull\n" + "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
            "endfacet\n" * facets).encode()


def glb(missing):
    text = b'{"asset": {"version": "2.0"}}   '
    whole = b"glTF" + struct.pack("<III", 2, 20 + len(text) + 8 + 72, len(text)) + b"JSON" + text
    return (whole + struct.pack("<I", 72) + b"BIN\0" + bytes(72))[:-missing]


def gltf(uri):
    return ('{"asset": {"version": "2.0"}, "buffers": [{"uri": "%s", "byteLength": 72}], "bufferViews": '
            '[{"buffer": 0, "byteLength": 36}], "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, '
            '"type": "VEC3"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], '
            '"nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0}' % uri).encode()


class World(unittest.TestCase):
    def setUp(self):
        self.above = tempfile.mkdtemp(prefix="sonard-hostile-")
        self.addCleanup(shutil.rmtree, self.above)
        self.folder = os.path.join(self.above, "world")
        os.mkdir(self.folder)
        self.write("world.yaml", CONFIGURATION.encode())

    def write(self, name, content):
        path = os.path.normpath(os.path.join(self.folder, name))
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "wb") as file:
            file.write(content)
        return path

    def check(self, body, *wrapper):
        self.write("world.sdf", ('<sdf version="1.9"><world name="w">%s</world></sdf>' % body).encode())
        return subprocess.run([*wrapper, PROGRAM, "check", "--no-network", os.path.join(self.folder, "world.yaml")], text=True,
                              capture_output=True, timeout=HANGS_S, check=False)

    def expect_refused(self, body, *parts):
        """Exit code 2, and one line with all of `parts`."""
        done = self.check(body)
        text = done.stdout + done.stderr
        self.assertEqual(done.returncode, 2, text)
        self.assertTrue(any(all(part in line for part in parts) for line in text.splitlines()), (parts, text))


class Names(World):
    """Files that name other files."""

    def test_a_tif_that_is_a_recipe_of_gdal_reads_no_file_and_asks_no_server(self):
        with socket.create_server(("127.0.0.1", 0)) as server:
            server.settimeout(0.1)
            port = server.getsockname()[1]
            asked = []
            running = threading.Event()

            def serve():
                while not running.is_set():
                    try:
                        asked.append(server.accept()[1])
                    except TimeoutError:
                        pass

            thread = threading.Thread(target=serve)
            thread.start()
            try:
                elevations = os.path.join(SHARED, "elevation_f32.tif")
                for source in (elevations, "/vsicurl/http://127.0.0.1:%d/bed.tif" % port):
                    self.write("bed.tif", (
                        '<VRTDataset rasterXSize="3" rasterYSize="2"><VRTRasterBand dataType="Float32" band="1">'
                        "<SimpleSource><SourceFilename>%s</SourceFilename><SourceBand>1</SourceBand></SimpleSource>"
                        "</VRTRasterBand></VRTDataset>" % source).encode())
                    self.expect_refused(model(visual(HEIGHTMAP % "bed.tif")), "bed.tif: ", "is not a TIFF")
                self.write("bed.tif", (
                    '<GDAL_WMS><Service name="TMS"><ServerUrl>http://127.0.0.1:%d/${z}/${x}/${y}.png</ServerUrl>'
                    "</Service><DataWindow><UpperLeftX>-9</UpperLeftX><UpperLeftY>9</UpperLeftY><LowerRightX>9"
                    "</LowerRightX><LowerRightY>-9</LowerRightY><SizeX>4</SizeX><SizeY>4</SizeY><TileLevel>0"
                    "</TileLevel></DataWindow><BandsCount>1</BandsCount></GDAL_WMS>" % port).encode())
                self.expect_refused(model(visual(HEIGHTMAP % "bed.tif")), "bed.tif: ", "is not a TIFF")
            finally:
                running.set()
                thread.join()
            self.assertEqual(asked, [])

    def test_a_material_library_is_not_read(self):
        os.mkfifo(os.path.join(self.folder, "pipe.mtl"))
        for name in ("/etc/passwd", "../secret/hull.mtl", "pipe.mtl", "/dev/zero"):
            self.write("hull.obj", ("mtllib %s\nusemtl steel\n" % name + TRIANGLE).encode())
            done = self.check(model(visual(MESH % "hull.obj")))
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)

    def test_a_buffer_of_a_gltf_elsewhere(self):
        secret = self.write("../secret/hull.bin", bytes(72))
        os.symlink(secret, os.path.join(self.folder, "link.bin"))
        for name, named in (("../secret/hull.bin", secret), ("..%2Fsecret%2fhull.bin", secret), ("link.bin", secret),
                            (secret, secret), ("/etc/passwd", "/etc/passwd")):
            self.write("hull.gltf", gltf(name))
            self.expect_refused(model(visual(MESH % "hull.gltf")), "hull.gltf: it refers to %s, outside" % named)

    def test_a_mesh_that_is_a_link_elsewhere(self):
        os.symlink("/dev/zero", os.path.join(self.folder, "hull.stl"))
        self.expect_refused(model(visual(MESH % "hull.stl")), "hull.stl", "leads out of the folders", "/dev/zero")


class SpecialFiles(World):
    """Files that block for ever when they are opened."""

    def fifo(self, name):
        os.makedirs(os.path.dirname(os.path.join(self.folder, name)), exist_ok=True)
        os.mkfifo(os.path.join(self.folder, name))

    def test_fifos_in_the_place_of_files(self):
        for name, geometry in (("pipe.obj", MESH), ("pipe.stl", MESH), ("pipe.dae", MESH), ("pipe.png", HEIGHTMAP),
                               ("pipe.tif", HEIGHTMAP)):
            self.fifo(name)
            self.expect_refused(model(visual(geometry % name)), name + ": not a file")

    def test_a_fifo_that_a_mesh_names(self):
        self.fifo("pipe.bin")
        self.write("hull.gltf", gltf("pipe.bin"))
        self.expect_refused(model(visual(MESH % "hull.gltf")), "hull.gltf: it refers to", "pipe.bin",
                            "not a regular file")

    def test_a_fifo_as_the_manifest_of_a_model(self):
        self.fifo("models/wreck/model.config")
        self.expect_refused("<include><uri>model://wreck</uri></include>", "model://wreck", "not found")

    def test_a_device(self):
        try:
            os.mknod(os.path.join(self.folder, "zero.stl"), 0o20666, os.makedev(1, 5))
        except PermissionError:
            self.skipTest("making a device needs root")
        self.expect_refused(model(visual(MESH % "zero.stl")), "zero.stl: not a file")


class CutFiles(World):
    """For all formats, cut at many places, see tests/unit/renderer/scene/cut_files_test.cpp."""

    def test_what_a_header_declares_is_there(self):
        with open(os.path.join(SHARED, "elevation_f32.tif"), "rb") as file:
            tif = file.read()
        collada = '<?xml version="1.0"?><COLLADA version="1.4.1"><asset/>'
        for name, geometry, content, sentence in (
                ("hull.ply", MESH, ply(1720, 317), "its header declares 1720 of element face, there are 317"),
                ("hull.stl", MESH, bytes(80) + struct.pack("<I", 9) + bytes(400), "9 triangles need 534 bytes"),
                ("text.stl", MESH, text_stl(5), "its last solid has no endsolid"),
                ("hull.glb", MESH, glb(1), "its header declares 132 bytes, there are 131"),
                ("hull.dae", MESH, collada.encode(), "it does not end with </COLLADA>"),
                ("hull.3ds", MESH, struct.pack("<HI", 0x4D4D, 5000) + bytes(99), "declares 5000 bytes"),
                ("hull.obj", MESH, b"v 0 0 0\nv 1 0 0\nf 1 2 3\n", "expected one of the 2 vertices"),
                ("bed.png", HEIGHTMAP, png(64, 64)[:-20], "its chunk IDAT declares"),
                ("bed.pgm", HEIGHTMAP, b"P5 64 64 255\n" + bytes(999), "its header declares"),
                ("bed.tif", HEIGHTMAP, tif[:-8], "its directory is damaged"),
        ):
            with self.subTest(name):
                self.write(name, content)
                self.expect_refused(model(visual(geometry % name)), name + ": ", sentence)


class Size(World):
    def test_three_thousand_fine_spheres(self):
        for radius_m in (lambda i: 50.0, lambda i: 50.0 + 0.001 * i):
            spheres = "".join(visual("<sphere><radius>%.3f</radius></sphere>" % radius_m(i), "v%d" % i)
                              for i in range(3000))
            self.expect_refused(model(spheres), "world.sdf: the world has more than 50000000 triangles",
                                "world.max_triangles")


@unittest.skipUnless(shutil.which("strace"), "strace is not installed")
class SystemCalls(World):
    """System calls of the confined processes that read files."""

    def test_a_reader_opens_no_socket_and_no_file_outside_of_the_world(self):
        for name in ("tetrahedron.obj", "tetrahedron.mtl", "tetrahedron.ply", "tetrahedron.stl", "tetrahedron.osgt",
                     "millimetres.dae", "grey8.png", "elevation_f32.tif"):
            shutil.copy(os.path.join(SHARED, name), self.folder)
        meshes = ("tetrahedron.obj", "tetrahedron.ply", "tetrahedron.stl", "tetrahedron.osgt", "millimetres.dae")
        shapes = [MESH % name for name in meshes] + [HEIGHTMAP % name for name in ("grey8.png", "elevation_f32.tif")]
        trace = os.path.join(self.above, "trace")
        done = self.check(model("".join(visual(shape, "v%d" % i) for i, shape in enumerate(shapes))), "strace", "-f",
                          "-o", trace, "-e", "trace=%network,open,openat,openat2,execve,seccomp")
        if "ptrace" in done.stderr.lower() and done.returncode == 1:  # forbidden, or by LeakSanitizer
            self.skipTest("processes cannot be traced here")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        confined, opened = set(), []
        with open(trace, encoding="utf-8") as lines:
            for line in lines:
                process, call = line.split(maxsplit=1)
                if call.startswith("seccomp(SECCOMP_SET_MODE_FILTER") and call.rstrip().endswith("= 0"):
                    confined.add(process)
                elif process in confined and not call.startswith(("+++", "---")):
                    path = re.match(r'open(?:at)?\((?:AT_FDCWD, )?"([^"]*)"', call)
                    self.assertIsNotNone(path, line)
                    opened.append(path.group(1))
        self.assertEqual(len(confined), len(shapes))
        for path in opened:
            self.assertTrue(os.path.realpath(path).startswith(self.folder + os.sep), path)
        self.assertEqual({os.path.basename(path) for path in opened}, {*meshes, "grey8.png", "elevation_f32.tif"})


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
