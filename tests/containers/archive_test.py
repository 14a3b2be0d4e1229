#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The image of a release, as a user runs it: podman loads the archive and runs it with no option but ports.

    sudo archive_test.py IMAGE.oci.tar

The storage is a folder of its own, which is removed at the end. Needs root and the packages in section [containers] of
docker/packages.txt.
"""

import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.request

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(REPOSITORY / "tests" / "support"))
from container_image import set_up_engines  # noqa: E402

ARCHIVE = None
READY_WITHIN_S = 60


def podman(*arguments):
    done = subprocess.run(["podman", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=600)
    if done.returncode:
        raise AssertionError(f"podman {arguments} ended with {done.returncode}:\n{done.stdout[-4000:]}")
    return done.stdout


class Archive(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sonard-", dir="/var/tmp"))
        self.addCleanup(shutil.rmtree, self.folder)
        set_up_engines(self.folder)

    def page(self, port, path):
        with urllib.request.urlopen(f"http://127.0.0.1:{port}{path}", timeout=4) as answer:
            return answer.status, answer.read()

    def test_it_runs_with_ports_alone_and_sends_pictures(self):
        image = podman("load", "--quiet", "--input", ARCHIVE).split()[-1]
        started = time.monotonic()
        name = podman("run", "--detach", "--publish", "127.0.0.1::8014", "--publish", "127.0.0.1::14600/udp", image).split()[-1]
        self.addCleanup(podman, "rm", "--force", name)
        port = podman("port", name, "8014/tcp").strip().rsplit(":", 1)[1]
        while True:
            try:
                self.assertEqual(self.page(port, "/health")[0], 200)
                break
            except OSError:
                self.assertLess(time.monotonic() - started, READY_WITHIN_S, podman("logs", name))
                time.sleep(0.5)
        self.assertIn(b"<html", self.page(port, "/")[1])
        self.assertIn("summary pings_complete=10 pings_incomplete=0",
                      podman("exec", name, "sonarview", "--pings", "10", "--range", "10", "--quiet"))
        print(f"ready and 10 pings after {time.monotonic() - started:.0f} s")


if __name__ == "__main__":
    ARCHIVE = sys.argv.pop(1)
    unittest.main(verbosity=2)
