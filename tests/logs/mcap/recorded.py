# SPDX-License-Identifier: Apache-2.0
"""A recording of a Gemini and a Micron, and readers of others in a folder with their node_modules."""

import argparse
import glob
import os
import subprocess
import sys
import unittest

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path.append(os.path.join(SOURCE, "tests", "system", "gemini"))
from lab import OwnMachine, Program  # noqa: E402

PATIENCE_S = 60
CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
recording: {{directory: logs{options}}}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    network: {{alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}}
  - name: stern
    type: micron
    serial: {{tcp: [{{bind: 127.0.0.1:4001}}]}}
    timing: {{line_period_ms: 10}}
"""


class RecordingTest(OwnMachine):
    PROGRAMS = None  # folder of the programs under test
    NPM = None  # folder with the scripts and their node_modules

    def record(self, options=""):
        """Records pings of both heads. Returns the path of the file."""
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf"), options=options))
        daemon = Program([os.path.join(self.PROGRAMS, "sonard"), "run", path], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", PATIENCE_S)
        clients = [Program([os.path.join(self.PROGRAMS, "sonarview"), *options], "sonarview") for options in (
            ("--range", "6", "--pings", "5", "--client-address", "127.0.0.1"),
            ("micron", "--tcp", "127.0.0.1:4001", "--range", "6", "--turns", "1"))]
        for client in clients:
            self.addCleanup(client.kill)
            self.assertEqual(client.wait(PATIENCE_S), 0, client.tail())
        daemon.terminate(PATIENCE_S)
        log, = glob.glob(os.path.join(self.folder.name, "logs", "*.mcap"))
        return log

    def node(self, script, *arguments):
        """The output of a script of NPM."""
        done = subprocess.run(["node", script, *arguments], cwd=self.NPM, text=True, timeout=PATIENCE_S, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, 0, done.stdout)
        return done.stdout


def main(description):
    parser = argparse.ArgumentParser(description=description, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard and sonarview")
    parser.add_argument("--npm", required=True, help="folder with the scripts, where npm has installed their needs")
    options, rest = parser.parse_known_args()
    RecordingTest.PROGRAMS, RecordingTest.NPM = os.path.abspath(options.programs), options.npm
    unittest.main(argv=[sys.argv[0], *rest])
