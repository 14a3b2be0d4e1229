# SPDX-License-Identifier: Apache-2.0
"""Tests of a daemon with heads of one type, on a machine of its own (a network namespace)."""

import argparse
import os
import sys
import tempfile
import unittest
import uuid

SOURCE = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "tests", "system", "gemini")]
from lab import Namespace, Program, need  # noqa: E402

WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
START_S = 60
PATIENCE_S = 30  # for what has no time of its own

CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
{more}
heads:
{heads}
"""


class HeadCase(unittest.TestCase):
    """One daemon for all cases of a class, because it starts slower than they run; each case has its own clients."""

    PROGRAMS = None  # folder of the programs under test
    CONFIG = CONFIG
    HEADS = ""  # YAML; FOLDER stands for the folder of the case
    MORE = ""  # YAML beside the heads

    @classmethod
    def setUpClass(cls):
        need("ip")
        folder = tempfile.TemporaryDirectory(prefix="sonard-heads-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.make_machines()
        cls.daemon = cls.start_daemon()

    @classmethod
    def make_machines(cls):
        cls.machine = cls.client_machine = Namespace("sonard-" + uuid.uuid4().hex[:8])
        cls.addClassCleanup(cls.machine.remove)

    @classmethod
    def configuration(cls):
        path = os.path.join(cls.folder, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(cls.CONFIG.format(world=WORLD, heads=cls.HEADS, more=cls.MORE).replace("FOLDER", cls.folder))
        return path

    @classmethod
    def start(cls, *arguments, machine=None):
        program = Program((machine or cls.machine).command(*arguments), os.path.basename(arguments[0]))
        cls.addClassCleanup(program.kill)
        return program

    @classmethod
    def start_daemon(cls):
        daemon = cls.start(os.path.join(cls.PROGRAMS, "sonard"), "run", cls.configuration())
        daemon.wait_for_line("sonard ready", START_S)
        return daemon

    def tearDown(self):
        self.assertNotRegex(self.daemon.output(), "Z (error|critical) ")


def main():
    """Runs the cases of the calling script."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    arguments, rest = parser.parse_known_args()
    HeadCase.PROGRAMS = os.path.abspath(arguments.programs)
    unittest.main(argv=[sys.argv[0], "-v", *rest])
