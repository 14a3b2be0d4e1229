#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`sonard render` as a user runs it: its files are read without our C++ code.

    render_test.py --programs DIR [TestCase.test_name ...]
"""

import argparse
import hashlib
import json
import math
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import uuid
import zipfile
import zlib

import numpy

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path += [os.path.join(SOURCE, "tests", "support"), os.path.join(SOURCE, "tests", "system", "gemini")]
import glf_reader  # noqa: E402
from lab import Namespace, Program  # noqa: E402

PROGRAMS = None  # folder of the programs under test
DEMO = os.path.join(SOURCE, "configs", "demo.yaml")
DEMO_WAY = os.path.join(SOURCE, "configs", "trajectories", "demo.csv")
SPHERE = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
CSV_HEADER = "t,x,y,z,qx,qy,qz,qw\n"
PNG_MAGIC = b"\x89PNG\r\n\x1a\n"
PATIENCE_S = 120

CONFIG = """
world:
  file: {world}
poses:
  initial:
    position_m: [0, 0, 0]
  udp:
    bind: 127.0.0.1:14600
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 601
    network:
      alternate_address: 127.0.0.2
      netmask: 255.0.0.0
      status: [127.0.0.1]
    dump:
      directory: {dump}
  - name: mast
    type: micron
    serial:
      tcp:
        - bind: 127.0.0.1:4001
"""


def render(*arguments, check=True):
    done = subprocess.run([os.path.join(PROGRAMS, "sonard"), "render", *arguments], capture_output=True, text=True,
                          timeout=PATIENCE_S)
    if check and done.returncode != 0:
        raise AssertionError(f"exit code {done.returncode}: {done.stderr}")
    return done


def sums(folder):
    """{name: SHA-256}"""
    found = {}
    for name in os.listdir(folder):
        with open(os.path.join(folder, name), "rb") as file:
            found[name] = hashlib.sha256(file.read()).hexdigest()
    return found


class Case(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        return self.path(name)

    def config(self, world=SPHERE):
        return self.write("config.yaml", CONFIG.format(world=world, dump=self.path("dump")))

    def way(self, seconds, start=0.0, speed=0.0):
        """A straight line ahead from the origin."""
        return self.write("way.csv", CSV_HEADER + f"{start},0,0,0,0,0,0,1\n{start + seconds},{speed * seconds},0,0,0,0,0,1\n")

    def sidecar(self, folder, name):
        with open(os.path.join(folder, name + ".json")) as file:
            return json.load(file)


class Files(Case):
    def test_contract(self):
        """Only the required options; only the start of the demo, to save time."""
        with open(DEMO_WAY) as file:
            short = self.write("way.csv", "".join(file.readlines()[:4]))
        out = self.path("out")
        done = render(DEMO, "--trajectory", short, "--out", out)
        self.assertEqual(done.stdout, f"{out}: 4 frames\n")
        names = sorted(os.listdir(out))
        self.assertEqual([n for n in names if n.endswith(".glf")], ["log_1980-01-01-000000.glf"])
        self.assertEqual(len(names), 4 * 3 + 2, names)
        for k in range(4):
            samples = numpy.load(os.path.join(out, f"ping_{k:06}.npy"))
            rows, columns = samples.shape
            sidecar = self.sidecar(out, f"ping_{k:06}")
            self.assertEqual(sidecar["samples"]["shape"], [rows, columns])
            self.assertEqual((samples.dtype.str, samples.flags.c_contiguous), (sidecar["samples"]["dtype"], True))
            self.assertEqual(len(sidecar["geometry"]["bearings_rad"]), columns)
            self.assertAlmostEqual(sidecar["geometry"]["line_step_m"] * rows, sidecar["geometry"]["range_m"])
            with open(os.path.join(out, sidecar["picture"]), "rb") as file:
                self.assertEqual(file.read(8), PNG_MAGIC)

    def test_pictures_of_every_third_frame_or_none(self):
        arguments = [self.config(), "--trajectory", self.way(1.0), "--rate", "4", "--compression", "4"]
        for every, drawn in (("3", [0, 3]), ("0", [])):
            out = self.path("every" + every)
            done = render(*arguments, "--out", out, "--picture-every", every)
            self.assertEqual(done.stdout, f"{out}: 5 frames\n")
            self.assertEqual(sorted(n for n in os.listdir(out) if n.endswith(".png")), [f"ping_{k:06}.png" for k in drawn])
            for k in range(5):
                self.assertEqual("picture" in self.sidecar(out, f"ping_{k:06}"), k in drawn)
            before = sums(out)
            render(*arguments, "--out", out, "--picture-every", every)
            self.assertEqual(sums(out), before, "nothing is missing")
        refused = render(*arguments, "--out", out, "--picture-every", "2", check=False)
        self.assertEqual(refused.returncode, 5, "a folder holds the frames of one setting")

    def test_python_of_the_documentation_runs(self):
        """The blocks of docs/python.md, in the folder that its command fills (with a short trajectory, to save time)."""
        out = self.path("out")
        with open(DEMO_WAY) as file:
            short = self.write("way.csv", "".join(file.readlines()[:2]))
        render(DEMO, "--trajectory", short, "--out", out, "--truth", "--picture-every", "0")
        with open(os.path.join(SOURCE, "docs", "python.md")) as file:
            blocks = re.findall("```python\n(.*?)```", file.read(), re.DOTALL)
        self.assertEqual(len(blocks), 4)
        said = [subprocess.run([sys.executable, "-W", "error", "-W", "ignore::ResourceWarning", "-c", block], cwd=out,
                               capture_output=True, text=True, timeout=PATIENCE_S) for block in blocks]
        self.assertEqual([run.stderr for run in said], 4 * [""])
        self.assertRegex(said[0].stdout, r"^strongest at [0-9.]+ m, -?[0-9.]+ degrees to port\n$")
        self.assertRegex(said[1].stdout, r" [1-9][0-9]* bins\n")
        self.assertEqual(said[2].stdout, "(1,) (1, 3)\n")
        self.assertEqual(said[3].stdout, "(3, 256)\n")

    def test_open_water_is_noise_alone(self):
        """Negatives for data sets: noise on both engines, and a mask without a body."""
        config = self.config()
        with open(config) as file:
            text = re.sub("^world:\n  file: .*$", "world: empty", file.read(), flags=re.MULTILINE)
        arguments = ["--trajectory", self.way(1.0), "--rate", "4", "--range", "10", "--picture-every", "0"]
        for engine in ("cpu", "gpu"):
            with self.subTest(engine):
                out = self.path(engine)
                path = self.write(engine + ".yaml", text + f"engine: {engine}\n")
                done = render(path, *arguments, "--head", "bow", "--truth", "--out", out, check=engine == "cpu")
                if done.returncode != 0 and "OpenGL" in done.stderr:
                    self.skipTest(done.stderr)
                self.assertEqual(done.stdout, f"{out}: 5 frames\n", done.stderr)
                self.assertNotIn("warning", done.stderr)
                frames = [numpy.load(os.path.join(out, f"ping_{k:06}.npy")) for k in range(5)]
                for frame in frames:
                    self.assertGreater(numpy.count_nonzero(frame), frame.size // 100)
                    self.assertGreater(frame.std(), 0)
                self.assertTrue(any((frames[0] != frame).any() for frame in frames[1:]), "noise is new in each ping")
                self.assertFalse(numpy.load(os.path.join(out, "ping_000000_bodies.npy")).any())
                self.assertEqual(self.sidecar(out, "ping_000000")["truth"]["bodies"], [])

    def test_black_frames_are_counted_with_their_cause(self):
        """The water surface of this world is at z = 10, and the sphere at (3, 2, 0) has a radius of 0.5 m."""
        cases = (
            ("in the air", "0,0,8,0,0,0,1", "0,0,13,0,0,0,1", r"3 of 5 frames: The sonar is 0\.5 m above the water surface, in the "
             r"air.*\(first in ping_000002\)"),
            ("UTM", "500000,5000000,0,0,0,0,1", "500001,5000000,0,0,0,0,1", r"5 of 5 frames: Nothing is within .* looks like UTM"),
            ("w first", "0,0,0,1,0,0,0", "0.1,0,0,1,0,0,0", r"5 of 5 frames: The vehicle lies .* w first"),
            ("inside", "3,2,0,0,0,0,1", "3.1,2,0,0,0,0,1", r"5 of 5 frames: The sonar is inside the body 'sphere'"),
            ("good", "0,0,0,0,0,0,1", "0.1,0,0,0,0,0,1", None))
        for name, begin, end, expected in cases:
            with self.subTest(name):
                way = self.write("way.csv", CSV_HEADER + f"0,{begin}\n4,{end}\n")
                done = render(self.config(), "--trajectory", way, "--out", self.path(name), "--rate", "1", "--range", "5",
                              "--picture-every", "0", "--no-still")
                warnings = [line for line in done.stderr.splitlines() if "frames: " in line]
                if expected is None:
                    self.assertEqual(warnings, [])
                else:
                    self.assertRegex(warnings[0], r"\bwarning " + expected)

    def test_one_frame_has_no_plural(self):
        out = self.path("out")
        done = render(self.config(), "--trajectory", self.way(0.3), "--out", out, "--rate", "1", "--picture-every", "0")
        self.assertEqual(done.stdout, f"{out}: 1 frame\n")

    def test_log_holds_the_arrays(self):
        """Unix times in the trajectory are the times of the log."""
        start = 1_700_000_000.25
        out = self.path("out")
        render(self.config(), "--trajectory", self.way(1.0, start), "--out", out, "--rate", "4", "--compression", "2")
        logs = [name for name in os.listdir(out) if name.endswith(".glf")]
        self.assertEqual(logs, ["log_2023-11-14-221320.glf"])
        with zipfile.ZipFile(os.path.join(out, logs[0])) as archive:
            self.assertIsNone(archive.testzip())
        log = glf_reader.read(os.path.join(out, logs[0]))
        self.assertEqual(len(log.images), 5)
        self.assertEqual(log.device_info, "Gemini - 601")
        for k, image in enumerate(log.images):
            samples = numpy.load(os.path.join(out, f"ping_{k:06}.npy"))
            self.assertEqual((image.lines, image.beams, image.pixels), (*samples.shape, samples.tobytes()))
            self.assertAlmostEqual(image.header.unix_s, start + k / 4, places=6)
            self.assertEqual(image.transmit_time_s, image.header.time_s)
            sidecar = self.sidecar(out, f"ping_{k:06}")
            self.assertEqual(list(image.bearings_rad), sidecar["geometry"]["bearings_rad"])
            self.assertAlmostEqual(image.max_range_m, sidecar["geometry"]["range_m"], delta=0.01)

    def test_target_to_port_is_on_the_port_side(self):
        """The sphere at (3, 2, 0): 33.7 degrees to port; its near side is at sqrt(13) - 0.5 m."""
        out = self.path("out")
        render(self.config(), "--trajectory", self.way(0.1), "--out", out, "--rate", "1", "--range", "6")
        samples = numpy.load(os.path.join(out, "ping_000000.npy"))
        line, beam = numpy.unravel_index(samples.argmax(), samples.shape)
        geometry = self.sidecar(out, "ping_000000")["geometry"]
        bearing = geometry["bearings_rad"][beam]
        range_m = (line + 0.5) * geometry["line_step_m"]
        self.assertAlmostEqual(math.degrees(bearing), 33.7, delta=4.0)
        self.assertTrue(math.sqrt(13) - 0.55 < range_m < math.sqrt(13), range_m)
        image = glf_reader.read(os.path.join(out, "log_1980-01-01-000000.glf")).images[0]
        self.assertGreater(image.bearings_rad[beam], 0.0)

    def test_truth_names_bodies(self):
        out = self.path("out")
        render(self.config(), "--trajectory", self.way(0.1), "--out", out, "--rate", "1", "--range", "6", "--truth",
               "--compression", "1")
        truth = self.sidecar(out, "ping_000000")["truth"]
        self.assertEqual(truth["bodies"], [{"id": 1, "name": "sphere"}])
        ids = numpy.load(os.path.join(out, truth["file"]))
        geometry = self.sidecar(out, "ping_000000")["geometry"]
        near = math.sqrt(13) - 0.5
        seen = [(line * geometry["line_step_m"], geometry["bearings_rad"][beam]) for line, beam in numpy.argwhere(ids == 1)]
        self.assertEqual(set(ids.flat), {0, 1})
        self.assertAlmostEqual(min(r for r, _ in seen), near, delta=2 * geometry["line_step_m"])
        self.assertLess(max(r for r, _ in seen), math.sqrt(13 - 0.25) + 0.1)  # the rim, where rays graze; the back is at 4.1 m
        half_rad = math.asin(0.5 / math.sqrt(13)) + 0.02
        for _, bearing in seen:
            self.assertLess(abs(bearing - math.atan2(2, 3)), half_rad)

    def test_vehicle_of_the_world_moves_along_unless_hidden(self):
        # The guard of the vehicle is 1.1 m ahead of the sonar and stays there while the vehicle moves.
        basin = os.path.join(SOURCE, "configs", "worlds", "gazebo_basin.sdf")
        way = self.write("way.csv", CSV_HEADER + "0,0,0,-2.5,0,0,0,1\n1,1.5,0,-2.5,0,0,0,1\n")
        for hides, expected in (("false", {1.1}), ("true", set())):
            config = self.write("config.yaml", CONFIG.format(world=basin, dump=self.path("dump")).replace(
                "  - name: mast", f"    mount:\n      from_world: gemini\n    hides_vehicle: {hides}\n  - name: mast"))
            out = self.path("out_" + hides)
            render(config, "--trajectory", way, "--out", out, "--rate", "1", "--range", "3", "--truth")
            seen = set()
            for name in ("ping_000000", "ping_000001"):
                truth = self.sidecar(out, name)["truth"]
                rov = next(body["id"] for body in truth["bodies"] if body["name"] == "rov")
                ids = numpy.load(os.path.join(out, truth["file"]))
                step_m = self.sidecar(out, name)["geometry"]["line_step_m"]
                ahead = numpy.flatnonzero(ids[:, ids.shape[1] // 2] == rov) * step_m
                seen |= {round(range_m, 1) for range_m in ahead[:1]}
            self.assertEqual(seen, expected)

    def test_clean_pictures_have_the_bearing_and_range_that_the_json_says(self):
        """The sphere at (3, 2, 0) in the fan and its mask, by apex and scale alone, for both types of head."""
        for head, stem, more in (("bow", "ping_000000", []), ("mast", "scan_000000", ["--rate", "300", "--bins", "200"])):
            out = self.path(head)
            render(self.config(), "--trajectory", self.way(1.0), "--out", out, "--head", head, "--range", "6", "--truth",
                   "--clean-png", "--picture-every", "0", *(more or ["--rate", "1"]))
            clean = self.sidecar(out, stem)["clean_pictures"]
            samples = numpy.load(os.path.join(out, stem + ".npy"))
            ids = numpy.load(os.path.join(out, stem + "_bodies.npy"))
            numpy.testing.assert_array_equal(self.grey_png(out, clean["grey"]["file"]), samples)
            numpy.testing.assert_array_equal(self.grey_png(out, clean["grey"]["mask"]), ids)
            fan, mask = (self.grey_png(out, clean["fan"][name]) for name in ("file", "mask"))
            self.assertEqual((fan.shape, mask.shape), 2 * (tuple(reversed(clean["fan"]["size_px"])),))
            self.assertEqual(set(mask.flat), {0, 1})
            y, x = numpy.nonzero(mask)
            apex_x, apex_y = clean["fan"]["apex_px"]
            ranges_m = numpy.hypot(x - apex_x, y - apex_y) * clean["fan"]["metres_per_px"]
            bearings_rad = numpy.arctan2(apex_x - x, apex_y - y)
            centre_rad = (bearings_rad.max() + bearings_rad.min()) / 2
            self.assertAlmostEqual(math.degrees(centre_rad), math.degrees(math.atan2(2, 3)), delta=1.5, msg=head)
            self.assertAlmostEqual(ranges_m.min(), math.sqrt(13) - 0.5, delta=0.05, msg=head)
            self.assertGreater(fan[mask > 0].mean(), 2 * fan[mask == 0].mean(), head)

    @staticmethod
    def grey_png(folder, name):
        """A grey PNG of 8 bits, by the filters of RFC 2083."""
        with open(os.path.join(folder, name), "rb") as file:
            data = file.read()
        assert data[:8] == PNG_MAGIC
        at, packed = 8, b""
        while at < len(data):
            length, kind = int.from_bytes(data[at:at + 4], "big"), data[at + 4:at + 8]
            body = data[at + 8:at + 8 + length]
            if kind == b"IHDR":
                width, height = int.from_bytes(body[:4], "big"), int.from_bytes(body[4:8], "big")
                assert body[8:10] == b"\x08\x00", "8 bits, grey"
            elif kind == b"IDAT":
                packed += body
            at += 12 + length
        rows = numpy.frombuffer(zlib.decompress(packed), numpy.uint8).reshape(height, width + 1)
        out = numpy.zeros((height, width), numpy.int64)
        above = numpy.zeros(width, numpy.int64)
        for y, (kind, *line) in enumerate(rows.tolist()):
            made = out[y]
            if kind in (0, 2):
                made[:] = numpy.array(line) + (above if kind == 2 else 0)
            else:
                left = 0
                for k, value in enumerate(line):
                    up, corner = int(above[k]), int(above[k - 1]) if k else 0
                    if kind == 1:
                        guess = left
                    elif kind == 3:
                        guess = (left + up) // 2
                    else:
                        estimate = left + up - corner
                        guess = min((left, up, corner), key=lambda one: abs(estimate - one))
                    left = (value + guess) & 255
                    made[k] = left
            made &= 255
            above = made
        return out.astype(numpy.uint8)

    def test_log_for_foxglove(self):
        sys.path.insert(0, os.path.join(SOURCE, "clients", "python"))
        from sonard_client import read_log
        arguments = [self.config(), "--trajectory", self.way(1.0, speed=0.5), "--range", "6", "--picture-every", "0", "--mcap"]
        for head, more in (("bow", ["--rate", "4", "--compression", "2"]),
                           ("mast", ["--head", "mast", "--rate", "300", "--bins", "200"])):
            out = self.path(head)
            render(*arguments, *more, "--out", out)
            log = os.path.join(out, "log_1980-01-01-000000.mcap")
            with open(log, "rb") as file:
                content = file.read()
            for topic in ("picture", "echoes", "transform"):
                self.assertIn(f"/{head}/{topic}".encode(), content)
            self.assertIn(b"foxglove.CompressedImage", content)
            pings = list(read_log(log))
            if head == "bow":
                self.assertEqual(len(pings), 5)
                for k, ping in enumerate(pings):
                    numpy.testing.assert_array_equal(ping.samples, numpy.load(os.path.join(out, f"ping_{k:06}.npy")))
                    self.assertAlmostEqual(ping.sonar_position_m[0], 0.5 * k / 4)
                    self.assertEqual(ping.time_ns, 315_532_800_000_000_000 + k * 250_000_000)
            else:
                samples = numpy.load(os.path.join(out, "scan_000000.npy"))
                self.assertEqual(len(pings), samples.shape[1])
                for k, bearing_rad in enumerate(self.sidecar(out, "scan_000000")["geometry"]["bearings_rad"]):
                    numpy.testing.assert_array_equal(pings[k].samples.ravel(), samples[:, k])
                    self.assertAlmostEqual(float(pings[k].bearings_rad[0]), bearing_rad)
            before = sums(out)
            os.unlink(log)
            render(*arguments, *more, "--out", out)
            self.assertEqual(sums(out), before, "of the frames that are there, the same bytes")

    def test_the_narrow_fan_of_an_oculus(self):
        """protocol/oculus/README.md: the fan of an M750d is 130 degrees at 750 kHz and 70 degrees at 1.2 MHz."""
        config = os.path.join(SOURCE, "configs", "demo-oculus.yaml")
        way = self.write("way.csv", CSV_HEADER + "0,-2,-12,-25.6,0,0,0.64,0.77\n")
        for frequency, width_deg, hertz in ((None, 130, 750e3), ("low", 130, 750e3), ("high", 70, 1.2e6)):
            out = self.path(str(frequency))
            render(config, "--trajectory", way, "--out", out, "--picture-every", "0", "--range", "5",
                   *(["--frequency", frequency] if frequency else []))
            sidecar = self.sidecar(out, "ping_000000")
            bearings = sidecar["geometry"]["bearings_rad"]
            self.assertAlmostEqual(math.degrees(bearings[0] - bearings[-1]), width_deg, delta=1.0)
            self.assertEqual(sidecar["settings"]["frequency_hz"], hertz)
        refused = render(self.config(), "--trajectory", self.way(1.0), "--out", self.path("out"), "--frequency", "high",
                         check=False)
        self.assertEqual(refused.returncode, 64)
        self.assertIn("--frequency: not an option for Gemini", refused.stderr)

    def test_sweeps_of_a_micron(self):
        out = self.path("out")
        render(self.config(), "--trajectory", self.way(2.0, speed=0.5), "--out", out, "--head", "mast", "--rate", "150",
               "--sector", "-45", "45", "--bins", "200", "--range", "5")
        scans = sorted(name for name in os.listdir(out) if name.endswith(".npy"))
        self.assertEqual(scans, [f"scan_{k:06}.npy" for k in range(6)])
        self.assertFalse([name for name in os.listdir(out) if name.endswith(".glf")])
        samples = numpy.load(os.path.join(out, scans[0]))
        self.assertEqual(samples.shape, (200, 51))
        sidecar = self.sidecar(out, "scan_000000")
        bearings = sidecar["geometry"]["bearings_rad"]
        self.assertAlmostEqual(bearings[0], math.pi / 4)
        self.assertAlmostEqual(bearings[-1], -math.pi / 4)
        # From 1.2 m on, the ring-down of the head is gone: the brightest sample is the sphere.
        first = int(1.2 / sidecar["geometry"]["line_step_m"])
        brightest = samples[first:].argmax() % samples.shape[1]
        self.assertAlmostEqual(math.degrees(bearings[brightest]), 33.7, delta=6.0)
        last = self.sidecar(out, "scan_000005")
        self.assertAlmostEqual(last["T_world_vehicle"][-1]["position_m"][0], 0.5 * last["stamps_s"][-1])


class Stills(Case):
    """Poses around the sphere at (3, 2, 0), each heading roughly towards it, in an order that no vehicle could follow."""

    POSES = 11

    def random_way(self, step_s=1.0):
        seeded = random.Random(46)
        self.poses, lines = [], [CSV_HEADER]
        for k in range(self.POSES):
            side = seeded.uniform(-math.pi, math.pi)
            x, y = 3 + 4 * math.cos(side), 2 + 4 * math.sin(side)
            heading = side + math.pi + seeded.uniform(-0.6, 0.6)
            self.poses.append((x, y, heading))
            lines.append(f"{k * step_s},{x},{y},0,0,0,{math.sin(heading / 2)},{math.cos(heading / 2)}\n")
        return self.write("random.csv", "".join(lines))

    def expect_sphere_where_it_is(self, out):
        """Compares image and mask with the bearing of the sphere from the pose."""
        for k, (x, y, heading) in enumerate(self.poses):
            name = f"ping_{k:06}"
            bearings = numpy.array(self.sidecar(out, name)["geometry"]["bearings_rad"])
            expected = math.remainder(math.atan2(2 - y, 3 - x) - heading, 2 * math.pi)
            columns = numpy.load(os.path.join(out, name + "_bodies.npy")).any(axis=0).nonzero()[0]
            middle = (bearings[columns[0]] + bearings[columns[-1]]) / 2
            self.assertAlmostEqual(math.degrees(middle), math.degrees(expected), delta=0.5, msg=f"mask of {name}")
            brightest = numpy.load(os.path.join(out, name + ".npy")).astype(float).sum(axis=0).argmax()
            self.assertAlmostEqual(math.degrees(bearings[brightest]), math.degrees(expected), delta=1.0, msg=f"image of {name}")

    def config_without_noise(self):
        return self.write("config.yaml", CONFIG.format(world=SPHERE, dump=self.path("dump")).replace(
            "    dump:\n", "    acoustics:\n      physical: {speckle: off, noise: false, texture_nu: 0, "
            "water_clutter: {density_per_m3: 0}}\n    dump:\n", 1))

    def render(self, out, *more):
        return render(self.config_without_noise(), "--trajectory", self.random_way(), "--out", out, "--range", "12", "--truth",
                      "--picture-every", "0", "--compression", "1", *more)

    def test_each_pose_is_a_frame_at_rest(self):
        out = self.path("out")
        done = self.render(out, "--still")
        self.assertEqual(done.stdout, f"{out}: {self.POSES} frames\n")
        self.assertNotIn("no vehicle", done.stderr)
        self.expect_sphere_where_it_is(out)
        sidecar = self.sidecar(out, "ping_000003")
        self.assertEqual(sidecar["T_world_sonar_at_end"], sidecar["T_world_sonar"])
        self.assertEqual(sidecar["stamp_s"], 3.0)

    def test_poses_that_no_vehicle_follows_are_taken_for_stills(self):
        out = self.path("out")
        done = self.render(out, "--rate", "1")
        self.assertEqual(done.stdout, f"{out}: {self.POSES} frames\n")
        self.assertRegex(done.stderr, r"random.csv: no vehicle moves like this \(from t=[0-9] to t=[0-9]: .*(m/s, [0-9.]+ deg/s|velocity changes by [0-9.]+ m/s .*)\)"
                                      r".*--still.*--no-still")
        self.expect_sphere_where_it_is(out)

    def test_the_mask_follows_the_motion_where_there_is_some(self):
        """At 150 degrees/s the sonar turns by 1.2 degrees until the echo of the sphere's near side, at 6.0 m, arrives."""
        rate = math.radians(150)
        way = self.write("turn.csv", CSV_HEADER + "".join(
            f"{t},-3.4,2,0,0,0,{math.sin(rate * (t - 1) / 2)},{math.cos(rate * (t - 1) / 2)}\n" for t in (0.5, 1.0, 1.5)))
        middles = {}
        for name, more in (("moving", []), ("still", ["--still"])):
            out = self.path(name)
            done = render(self.config_without_noise(), "--trajectory", way, "--out", out, "--range", "12", "--truth",
                          "--picture-every", "0", "--compression", "1", "--rate", "2", *more)
            self.assertNotIn("no vehicle", done.stderr)
            bearings = numpy.array(self.sidecar(out, "ping_000001")["geometry"]["bearings_rad"])
            columns = numpy.load(os.path.join(out, "ping_000001_bodies.npy")).any(axis=0).nonzero()[0]
            image = numpy.load(os.path.join(out, "ping_000001.npy")).astype(float).sum(axis=0)
            middles[name] = (math.degrees(bearings[columns[0]] + bearings[columns[-1]]) / 2,
                             math.degrees(bearings[image.argmax()]))
        turned = 150 * 2 * 5.9 / 1500
        self.assertAlmostEqual(middles["still"][0], 0, delta=0.3)
        self.assertAlmostEqual(middles["moving"][0], -turned, delta=0.4)
        self.assertAlmostEqual(middles["moving"][1], -turned, delta=0.9)

    def test_a_jump_in_a_way_is_at_rest_and_the_rest_moves(self):
        way = self.write("jump.csv", CSV_HEADER + "".join(
            f"{t},{x},0,0,0,0,0,1\n" for t, x in [(k, 0.1 * k) for k in range(8)] + [(8, 900.0)]))
        out = self.path("out")
        done = render(self.config(), "--trajectory", way, "--out", out, "--range", "6", "--rate", "1", "--compression", "4",
                      "--picture-every", "0")
        self.assertRegex(done.stderr, r"jump.csv: 1 of 8 steps are jumps that no vehicle makes \(from t=7 to t=8: 899 m/s, 0 deg/s\)")
        for k, rests in ((6, False), (7, True)):
            sidecar = self.sidecar(out, f"ping_{k:06}")
            self.assertEqual(sidecar["T_world_sonar_at_end"] == sidecar["T_world_sonar"], rests, k)
        moving = self.path("moving")
        render(self.config(), "--trajectory", way, "--out", moving, "--range", "6", "--rate", "1", "--compression", "4",
               "--picture-every", "0", "--no-still")
        self.assertGreater(self.sidecar(moving, "ping_000007")["T_world_sonar_at_end"]["position_m"][0], 1.0)


POST = """<?xml version="1.0"?>
<sdf version="1.9" xmlns:sonard="https://sonard.dev/sdf"><world name="w"><model name="post"><pose>8 0 0 0 0 0</pose>
<static>true</static><link name="l"><visual name="v"><geometry><box><size>0.1 0.1 {height_m}</size></box></geometry>
<sonard:material>rock</sonard:material></visual></link></model></world></sdf>
"""
POST_CONFIG = """
world: {file: post.sdf}
engine: cpu
sampling: {preset: fast}
heads:
  - name: g
    type: gemini_720i
    sonar_id: 513
    network: {alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}
    acoustics: {fine_beams: 1, physical: {speckle: off, noise: false, texture_nu: 0, water_clutter: {density_per_m3: 0}}}
poses: {initial: {position_m: [0, 0, 0]}}
"""


class Levels(Case):
    def greatest(self, height_m):
        """Maxima of the post, whose front is 7.95 m ahead. Clients request 4 cycles at 10 m, 25 at 40, 89 at 80 and 128 at
        120 (protocol/gemini/README.md 5)."""
        self.write("post.sdf", POST.format(height_m=height_m))
        config = self.write("config.yaml", POST_CONFIG)
        greatest = []
        for range_m in (10, 40, 80, 120):
            out = self.path(f"out{height_m}-{range_m}")
            render(config, "--trajectory", self.way(0.01), "--out", out, "--rate", "1", "--range", str(range_m), "--gain", "20",
                   "--bits", "16")
            greatest.append(int(numpy.load(os.path.join(out, "ping_000000.npy")).max()))
        self.assertTrue(0 < min(greatest) and max(greatest) < 65535, greatest)
        return greatest

    def test_a_point_is_as_bright_under_a_longer_tone(self):
        greatest = self.greatest(0.1)
        self.assertLess(20 * math.log10(max(greatest) / min(greatest)), 0.5, greatest)

    def test_a_post_does_not_fade_under_a_longer_tone(self):
        """Its ends are 16 mm farther away than its middle. A tone that covers all of it brightens it by less than 2.5 dB:
        the shortest tone covers 16.3 mm (docs/physics.md 2.6)."""
        greatest = self.greatest(1)
        self.assertEqual(greatest, sorted(greatest))
        self.assertLess(20 * math.log10(greatest[-1] / greatest[0]), 2.5, greatest)


class Bytes(Case):
    def one_run(self, out, way, *arguments):
        return render(self.config(), "--trajectory", way, "--out", out, "--rate", "10", "--compression", "3", "--truth",
                      *arguments)

    def test_three_shards_make_the_files_of_one_run(self):
        """The shards run at the same time; the sonar moves and its speckle continues from ping to ping."""
        way = self.way(1.5, speed=0.1)
        self.one_run(self.path("one"), way)
        self.config()
        command = [os.path.join(PROGRAMS, "sonard"), "render", self.path("config.yaml"), "--trajectory", way, "--out",
                   self.path("three"), "--rate", "10", "--compression", "3", "--truth", "--shard"]
        shards = [subprocess.Popen([*command, f"{i}/3"], stdout=subprocess.PIPE, text=True) for i in range(3)]
        said = [shard.communicate(timeout=PATIENCE_S)[0] for shard in shards]
        self.assertEqual([shard.returncode for shard in shards], [0, 0, 0])
        whole, part = (f"{self.path('three')}: {text}\n"
                       for text in ("16 frames", "this share is complete; other frames of all 16 are missing"))
        self.assertIn(whole, said)
        self.assertLessEqual(set(said), {whole, part})
        self.assertEqual(sums(self.path("three")), sums(self.path("one")))
        self.assertEqual(len(sums(self.path("one"))), 16 * 4 + 2)

    def test_killed_and_started_again_makes_the_files_of_one_run(self):
        way = self.way(1.5, speed=0.1)
        self.one_run(self.path("one"), way)
        out = self.path("killed")
        seeded = random.Random(7)
        command = [os.path.join(PROGRAMS, "sonard"), "render", self.path("config.yaml"), "--trajectory", way, "--out", out,
                   "--rate", "10", "--compression", "3", "--truth"]
        killed = 0
        for _ in range(5):
            program = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            try:
                program.wait(0.4 + 0.6 * seeded.random())
            except subprocess.TimeoutExpired:
                program.send_signal(signal.SIGKILL)
                program.wait()
                killed += 1
            whole = sums(self.path("one"))
            for name, found in (sums(out) if os.path.isdir(out) else {}).items():
                if not name.startswith(".part-"):
                    self.assertEqual(found, whole[name], name)
        self.assertGreater(killed, 0)
        self.one_run(out, way)
        self.assertEqual(sums(out), sums(self.path("one")))
        # All files exist: no file is written again.
        before = {name: os.stat(os.path.join(out, name)).st_mtime_ns for name in os.listdir(out)}
        self.one_run(out, way)
        self.assertEqual({name: os.stat(os.path.join(out, name)).st_mtime_ns for name in os.listdir(out)}, before)
        # One file is missing: the new one has the same bytes.
        os.unlink(os.path.join(out, "ping_000005.npy"))
        self.one_run(out, way)
        self.assertEqual(sums(out), sums(self.path("one")))
        # All files are rendered again.
        self.one_run(out, way, "--overwrite")
        self.assertEqual(sums(out), sums(self.path("one")))

    def test_says_what_is_there_when_interrupted_and_resumed(self):
        out = self.path("out")
        arguments = [self.config(), "--trajectory", self.way(3.0), "--out", out, "--rate", "10", "--compression", "3",
                     "--picture-every", "0"]
        program = subprocess.Popen([os.path.join(PROGRAMS, "sonard"), "render", *arguments], stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, text=True)
        deadline = time.monotonic() + PATIENCE_S
        while not os.path.exists(os.path.join(out, "ping_000001.json")) and time.monotonic() < deadline:
            time.sleep(0.01)
        program.send_signal(signal.SIGINT)
        said = program.communicate(timeout=PATIENCE_S)[1]
        self.assertEqual(program.returncode, -signal.SIGINT)
        there = len([name for name in os.listdir(out) if name.endswith(".json") and name.startswith("ping")])
        self.assertIn(f"{out}: interrupted: {there} of 31 frames exist; run the same command again to render the rest\n", said)
        done = render(*arguments)
        self.assertIn(f"{out}: {there} of 31 frames exist; {31 - there} to render\n", done.stderr)
        self.assertEqual(done.stdout, f"{out}: 31 frames\n")

    def test_warns_of_a_rate_beyond_the_head(self):
        arguments = [self.config(), "--trajectory", self.way(0.02), "--compression", "4", "--picture-every", "0"]
        fast = render(*arguments, "--out", self.path("fast"), "--rate", "200")
        self.assertRegex(fast.stderr, r"--rate 200 exceeds the limit of head 'bow': at most [0-9.]+ pings per second")
        usual = render(*arguments, "--out", self.path("usual"), "--rate", "4")
        self.assertNotIn("beyond", usual.stderr)

    def test_a_seed_of_its_own_changes_noise_alone(self):
        arguments = [self.config(), "--trajectory", self.way(0.02), "--compression", "4", "--picture-every", "0", "--rate", "4",
                     "--truth", "--bits", "16"]
        samples, masks = {}, {}
        for name, seed in (("none", []), ("1", ["--seed", "1"]), ("2", ["--seed", "2"])):
            render(*arguments, "--out", self.path(name), *seed)
            samples[name] = numpy.load(self.path(name, "ping_000000.npy"))
            masks[name] = numpy.load(self.path(name, "ping_000000_bodies.npy"))
        numpy.testing.assert_array_equal(samples["1"], samples["none"], "1 is the default of acoustics.seed")
        numpy.testing.assert_array_equal(masks["2"], masks["1"])
        self.assertGreater(numpy.mean(samples["2"] != samples["1"]), 0.9)
        self.assertEqual(self.sidecar(self.path("2"), "ping_000000")["seed"], 2)
        refused = render(*arguments, "--out", self.path("2"), "--seed", "3", check=False)
        self.assertEqual(refused.returncode, 5, "the folder is another run's: " + refused.stderr)

    def test_elements_have_a_seed_of_their_own(self):
        """Without noise, equal seeds of the elements give equal images."""
        quiet = self.write("quiet.yaml", CONFIG.format(world=SPHERE, dump=self.path("dump")).replace(
            "    dump:\n", "    acoustics:\n      element_amplitude_sd: 0.3\n      physical: {speckle: off, noise: false, "
            "texture_nu: 0, water_clutter: {density_per_m3: 0}}\n    dump:\n", 1))
        def one(config, name, *seeds):
            render(config, "--trajectory", self.way(0.02), "--rate", "1", "--bits", "16", "--compression", "4", "--picture-every",
                   "0", "--range", "6", "--out", self.path(name), *seeds)
            return numpy.load(self.path(name, "ping_000000.npy"))
        first = one(quiet, "a", "--seed", "1", "--element-seed", "9")
        numpy.testing.assert_array_equal(one(quiet, "b", "--seed", "2", "--element-seed", "9"), first)
        self.assertTrue((one(quiet, "c", "--seed", "1", "--element-seed", "8") != first).any())
        self.assertTrue((one(quiet, "d", "--seed", "1") != first).any())
        self.assertEqual(self.sidecar(self.path("b"), "ping_000000")["element_seed"], 9)
        with open(quiet) as file:
            by_key = self.write("by_key.yaml", file.read().replace("acoustics:\n", "acoustics:\n      element_seed: 9\n", 1))
        numpy.testing.assert_array_equal(one(by_key, "e", "--seed", "3"), first)
        noisy = one(self.config(), "f", "--seed", "1", "--element-seed", "9")
        self.assertTrue((one(self.config(), "g", "--seed", "2", "--element-seed", "9") != noisy).any())

    def test_a_body_moves_along_a_file(self):
        """The sphere 5 m to port goes away: it is in the first ping, but not in the second, when it is 1 km off."""
        ball = self.write("ball.csv", CSV_HEADER + "0,3,3,0,0,0,0,1\n1,1000,3,0,0,0,0,1\n")
        out = self.path("out")
        arguments = [self.config(), "--trajectory", self.way(1.0), "--out", out, "--rate", "1", "--compression", "3", "--truth",
                     "--picture-every", "0"]
        name = self.body_name()
        render(*arguments, "--body", f"{name}={ball}")
        seen = [numpy.load(os.path.join(out, f"ping_{k:06}_bodies.npy")).any() for k in range(2)]
        self.assertEqual(seen, [True, False])
        other = self.path("other")
        arguments[arguments.index(out)] = other
        refused = render(*arguments, "--body", f"whale={ball}", check=False)
        self.assertEqual(refused.returncode, 2)
        self.assertIn(f"--body: 'whale' cannot be moved (expected one of {name})", refused.stderr)
        self.assertEqual(render(*arguments, "--body", "whale", check=False).returncode, 64)

    @staticmethod
    def body_name():
        with open(SPHERE) as file:
            return re.search('<model name="([^"]+)"', file.read()).group(1)

    def test_offline_equals_served(self):
        """The same pose, seed and ping numbers give the same samples as a daemon renders for a client."""
        config = self.config()
        machine = Namespace("sonard-" + uuid.uuid4().hex[:8])
        self.addCleanup(machine.remove)
        daemon = Program(machine.command(os.path.join(PROGRAMS, "sonard"), "run", config), "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", 60)
        view = machine.command(os.path.join(PROGRAMS, "sonarview"), "--pings", "4", "--range", "12", "--gain", "60",
                               "--compression", "1", "--quiet")
        self.assertEqual(subprocess.run(view, capture_output=True, timeout=60).returncode, 0)
        daemon.terminate(10)

        out = self.path("out")
        render(config, "--trajectory", self.way(0.3), "--out", out, "--rate", "10", "--range", "12", "--gain", "60",
               "--compression", "1")
        for k in range(4):
            served = numpy.load(self.path("dump", f"bow-{k:08}.npy"))
            numpy.testing.assert_array_equal(served, numpy.load(os.path.join(out, f"ping_{k:06}.npy")), f"ping {k}", strict=True)
        first, second = (numpy.load(os.path.join(out, f"ping_{k:06}.npy")) for k in range(2))
        self.assertTrue((first != second).any())


class Complaints(Case):
    def expect(self, code, message, *arguments):
        done = render(*arguments, check=False)
        self.assertEqual((done.returncode, done.stderr.strip().splitlines()[-1]), (code, message))

    def test_each_names_its_place(self):
        config = self.config()
        way = self.way(0.3)
        out = self.path("out")
        broken = self.write("broken.csv", CSV_HEADER + "0,0,0,0,0,0,0,1\n0.1,0,0,x,0,0,0,1\n")
        self.expect(2, f"{broken}:3: z 'x' is not a number", config, "--trajectory", broken, "--out", out)
        missing = self.path("missing.csv")
        self.expect(2, f"{missing}: cannot be read: No such file or directory", config, "--trajectory", missing, "--out", out)
        self.expect(2, f"{config}:10:3: heads: no head is named 'stern' (expected bow or mast)", config, "--trajectory", way,
                    "--out", out, "--head", "stern")
        self.expect(2, f"{way}: ends before the first sweep of head 'mast' does", config, "--trajectory", way, "--out", out,
                    "--head", "mast")
        self.expect(64, "--bins: not an option for Gemini", config, "--trajectory", way, "--out", out, "--bins", "100")
        self.expect(64, "--range: 190 is out of range for Gemini (expected 0.3 to 150)", config, "--trajectory", way, "--out",
                    out, "--range", "190")
        self.expect(64, "--shard: expected I/N with 0 <= I <= N and N >= 1, found '4/3'", config, "--trajectory", way, "--out",
                    out, "--shard", "4/3")
        self.expect(64, "--body: 'sphere' is given twice (expected once per body)", config, "--trajectory", way, "--out", out,
                    "--body", f"sphere={way}", "--body", f"sphere={way}")
        self.assertEqual(render(config, "--out", out, check=False).returncode, 64)
        self.assertFalse(os.path.exists(out))
        self.expect(5, "/proc/sonard: cannot create the folder: No such file or directory", config, "--trajectory", way, "--out",
                    "/proc/sonard")
        render(config, "--trajectory", way, "--out", out, "--rate", "1", "--compression", "4")
        done = render(config, "--trajectory", way, "--out", out, "--rate", "1", check=False)
        self.assertEqual(done.returncode, 5)
        self.assertRegex(done.stderr.strip().splitlines()[-1],
                         f"^{re.escape(out)}/run.json: the folder contains another run: settings.compression was 4 and now is 0"
                         ".* \\(expected the same settings and files, another folder, or --overwrite\\)$")


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    PROGRAMS = os.path.abspath(arguments.programs)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
