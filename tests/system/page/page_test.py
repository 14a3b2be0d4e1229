#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon's page in a browser, and its data in Foxglove's client, each case on a machine of its own (a network
namespace).

    page_test.py --programs DIR --npm DIR [TestCase.test_name ...]

The checks are in mock_test.js, daemon_test.js and foxglove_test.js, because a browser is driven from JavaScript.
"""

import argparse
import os
import signal
import subprocess
import sys
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path.append(os.path.join(HERE, "..", "gemini"))
from lab import Namespace, need  # noqa: E402

PAGE = os.path.join(SOURCE, "server", "web", "page")
DATA = os.path.join(SOURCE, "tests", "data", "system")
POSE_SCHEMA = os.path.join(SOURCE, "protocol", "pose", "pose.proto")
PROGRAMS = None  # folder of the programs under test
NPM = None  # folder with the scripts and their node_modules
PATIENCE_S = 380


class Page(unittest.TestCase):
    def run_script(self, script, *arguments):
        """Runs a script of node's test runner; if it fails, its report is the message."""
        namespace = Namespace(f"sonard-page-{os.getpid()}")
        self.addCleanup(namespace.remove)
        process = subprocess.Popen(namespace.command("node", script, *arguments), cwd=NPM, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, start_new_session=True)
        try:
            report, _ = process.communicate(timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            report, _ = process.communicate()
            self.fail(f"{script} has not ended within {PATIENCE_S} s\n{report}")
        self.assertEqual(process.returncode, 0, report)

    def test_alone(self):
        need("chromium")
        self.run_script("mock_test.js", PAGE)

    def test_with_a_daemon(self):
        need("chromium")
        self.run_script("daemon_test.js", PROGRAMS, DATA, POSE_SCHEMA)

    def test_with_foxglove(self):
        self.run_script("foxglove_test.js", PROGRAMS, DATA)


def main():
    global PROGRAMS, NPM
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard, sonarview and posecast")
    parser.add_argument("--npm", required=True, help="folder with the scripts, where npm has installed their needs")
    options, rest = parser.parse_known_args()
    PROGRAMS, NPM = os.path.abspath(options.programs), options.npm
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
