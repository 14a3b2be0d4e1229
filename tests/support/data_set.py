# SPDX-License-Identifier: Apache-2.0
"""A small trajectory to render with `sonard render`, and the contents of a folder of frames."""

import hashlib
import pathlib
import subprocess
import tempfile
import unittest

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
FRAMES = 100
TRAJECTORY = "t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n9.9,2.475,0,0,0,0,0,1\n"
CONFIGURATION = f"""
world:
  file: {REPOSITORY}/tests/data/system/sphere_to_port.sdf
poses:
  initial:
    position_m: [0, 0, 0]
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 601
    network:
      alternate_address: 127.0.0.2
      netmask: 255.0.0.0
      status: [127.0.0.1]
"""


def sums(folder):
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in pathlib.Path(folder).iterdir()}


def frames(folder):
    """{name: (inode, time)} of the complete frames."""
    return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in pathlib.Path(folder).glob("ping_*.json")}


class Files(unittest.TestCase):
    """Base of tests; each gets a folder with config.yaml and trajectory.csv."""

    RENDER = ["--rate", "10", "--range", "6", "--picture-every", "4"]

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sonard-cluster-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.write("config.yaml", CONFIGURATION)
        self.write("trajectory.csv", TRAJECTORY)

    def write(self, name, text):
        (self.folder / name).write_text(text, encoding="utf-8")

    def arguments(self, out, *more):
        return [str(self.folder / "config.yaml"), "--trajectory", str(self.folder / "trajectory.csv"), "--out", str(self.folder / out),
                *(more or self.RENDER)]

    def render_whole(self, programs):
        """Renders with one process into the folder `whole`, as the truth for all other runs."""
        subprocess.run([programs / "sonard", "render", *self.arguments("whole")], check=True, capture_output=True, timeout=600)
        self.assertEqual(len(frames(self.folder / "whole")), FRAMES)
