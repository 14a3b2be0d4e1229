#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clients/python against the daemon, on a machine of its own (a network namespace).

    python_client_test.py --programs DIR [TestCase.test_name ...]

Pings are compared by CRC-32 with what the renderer handed over, and by range and bearing with the world: a sphere of
0.5 m at (3, 2, 0), tests/data/system/sphere_to_port.sdf.
"""

import argparse
import csv
import math
import os
import shutil
import subprocess
import sys
import unittest
import zlib

import numpy

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "tests", "system", "gemini"), os.path.join(SOURCE, "clients", "python")]
from lab import OwnMachine, Program  # noqa: E402
from sonard_client import Gemini, NoHead, NoPing  # noqa: E402

WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
PROGRAMS = None  # folder of the programs under test
START_S = 60

CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: {position}}}}}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    dump: {{directory: {folder}}}
    network: {{alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}}
{link}
"""


class PythonClient(OwnMachine):
    def start(self, link="", position=(0, 0, 0)):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=WORLD, folder=self.folder.name, position=list(position), link=link))
        daemon = Program([os.path.join(PROGRAMS, "sonard"), "run", path], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", START_S)

    def expect_rendered(self, ping):
        """As the renderer handed it over, bit by bit."""
        with open(os.path.join(self.folder.name, "bow.csv"), encoding="utf-8") as file:
            rendered = {int(row["transmit_us"]): row["crc32"] for row in csv.DictReader(file)}
        samples = ping.samples if ping.samples.dtype == numpy.uint8 else ping.samples.astype(">u2")
        self.assertEqual(ping.missing, 0)
        self.assertEqual(f"{zlib.crc32(samples.tobytes()):08x}", rendered[ping.transmit_us])

    def test_five_lines_see_the_sphere(self):
        self.start()
        with Gemini() as sonar:
            ping = sonar.ping(range_m=6)
        self.expect_rendered(ping)
        row, beam = numpy.unravel_index(ping.samples.argmax(), ping.samples.shape)
        self.assertAlmostEqual(ping.ranges_m[row], math.hypot(3, 2) - 0.5, delta=0.1)
        self.assertAlmostEqual(ping.bearings_rad[beam], math.atan2(2, 3), delta=math.radians(9))
        self.assertGreater(ping.bearings_rad[beam], 0, "port is positive")

    def test_readme_in_a_virtual_environment(self):
        self.start()
        # Building leaves files beside the source.
        shutil.copytree(os.path.join(SOURCE, "clients", "python"), os.path.join(self.folder.name, "source"))
        venv = os.path.join(self.folder.name, "venv")
        for command in ([sys.executable, "-m", "venv", "--system-site-packages", venv],
                        [venv + "/bin/pip", "install", "--quiet", "--no-index", "--no-build-isolation", "--no-deps",
                         os.path.join(self.folder.name, "source")]):
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with open(os.path.join(SOURCE, "clients", "python", "README.md"), encoding="utf-8") as file:
            example = file.read().split("```python\n")[1].split("```")[0]
        done = subprocess.run([venv + "/bin/python", "-c", example], cwd=self.folder.name, capture_output=True, text=True)
        self.assertRegex(done.stdout, r"^\(2411, 256\) 19\.99\d* \[ 1\.04\d* -1\.04\d*\]$", done.stderr)

    def test_forms_of_samples(self):
        self.start()
        with Gemini(sonar_id=513) as sonar:
            for options, dtype, rows in (({}, numpy.uint8, 723), ({"bits": 16}, numpy.uint16, 723),
                                         ({"compression": 2}, numpy.uint8, 180)):
                with self.subTest(options=options):
                    ping = sonar.ping(range_m=6, **options)
                    self.assertEqual((ping.samples.dtype, ping.samples.shape), (dtype, (rows, 256)))
                    self.assertAlmostEqual(ping.ranges_m[-1], 6, delta=0.05)
                    self.expect_rendered(ping)

    def test_pings_come_by_themselves_over_a_link_that_loses(self):
        self.start("    link: {to_surface: {loss: 0.05}, from_surface: {loss: 0.05}}")
        with Gemini() as sonar:
            pings = sonar.pings(interval_s=0.1, range_m=6)
            for _ in range(20):
                self.expect_rendered(next(pings))

    def test_a_head_that_is_silent(self):
        with self.assertRaisesRegex(NoHead, "is the head on"):
            Gemini(patience_s=0.5)
        self.start(position=(0, 0, 0))
        with self.assertRaisesRegex(NoHead, "of head 600"):
            Gemini(sonar_id=600, patience_s=2.5)

    def test_no_pose_no_ping(self):
        self.start()
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, encoding="utf-8") as file:
            text = file.read().replace("poses: {initial: {position_m: [0, 0, 0]}}", "poses: {udp: {bind: 127.0.0.1:14600}}") \
                .replace("127.0.0.2", "127.0.0.5").replace("513", "514")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        daemon = Program([os.path.join(PROGRAMS, "sonard"), "run", path], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", START_S)
        with Gemini(sonar_id=514) as sonar, self.assertRaisesRegex(NoPing, "does the head have a pose"):
            sonar.ping()


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard")
    options, rest = parser.parse_known_args()
    PROGRAMS = os.path.abspath(options.programs)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
