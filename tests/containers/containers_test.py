#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""docker/Dockerfile and docker/compose.yaml: builds the image and runs containers connected by their network only.

    sudo containers_test.py [--keep DIR] [TestCase.test_name ...]

buildah builds and podman runs, with their own storage, which is removed at the end. --keep DIR keeps it, and uses the
image in it. The base image is made by debootstrap from this machine's mirror. Needs root and the packages in section
[containers] of docker/packages.txt.
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import yaml

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(REPOSITORY / "tests" / "support"))
from container_image import BASE, build_image, set_up_engines  # noqa: E402

KEEP = None  # folder of a storage that stays
MOST_MB = 300  # beside the base
PATIENCE_S = 180
COMPOSE = REPOSITORY / "docker" / "compose.yaml"
HARDENED = ["--read-only", "--tmpfs", "/tmp", "--cap-drop", "all", "--security-opt", "no-new-privileges"]


def run(*command, expected=0, timeout=PATIENCE_S, cwd=None):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=timeout, cwd=cwd)
    if done.returncode != expected:
        raise AssertionError(f"{command} ended with {done.returncode}:\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
    return done.stdout


def podman(*arguments, **others):
    return run("podman", *map(str, arguments), **others)


class Containers(unittest.TestCase):
    """Test cases remove their containers and networks."""

    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(KEEP or tempfile.mkdtemp(prefix="sonard-", dir="/var/tmp"))
        cls.folder.mkdir(exist_ok=True)
        set_up_engines(cls.folder)
        if not podman("images", "--quiet", "localhost/sonard"):
            build_image(cls.folder)

    @classmethod
    def tearDownClass(cls):
        if not KEEP:
            shutil.rmtree(cls.folder)

    def network(self, name="vehicle"):
        """Makes the network of the compose file, because podman-compose 1.0 ignores its addresses and `internal`."""
        vehicle = yaml.safe_load(COMPOSE.read_text())["networks"]["vehicle"]
        [addresses] = vehicle["ipam"]["config"]
        podman("network", "create", *(["--internal"] if vehicle["internal"] else []), "--subnet", addresses["subnet"],
               "--gateway", addresses["gateway"], name)
        self.addCleanup(podman, "network", "rm", "--force", name)
        return name

    def start(self, *arguments):
        name = podman("run", "--detach", *HARDENED, *arguments).strip()
        self.addCleanup(podman, "rm", "--force", name)
        return name

    def wait_for(self, what, holds, name):
        end = time.monotonic() + PATIENCE_S
        while not holds():
            self.assertLess(time.monotonic(), end, f"waited for: {what}; {self.log(name)}")
            time.sleep(0.5)

    def log(self, name):
        done = subprocess.run(["podman", "logs", name], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        return done.stdout

    def wait_until_ready(self, name):
        self.wait_for("sonard ready", lambda: "sonard ready" in self.log(name), name)

    def address_of(self, name):
        [described] = json.loads(podman("inspect", name))
        [network] = described["NetworkSettings"]["Networks"].values()
        return network["IPAddress"]

    def view(self, network, *arguments):
        """Output of a client in a container of its own."""
        options, arguments = (arguments[0], arguments[1:]) if arguments and isinstance(arguments[0], list) else ([], arguments)
        return podman("run", "--rm", *HARDENED, "--network", network, *options, "--entrypoint", "/usr/bin/sonarview", "sonard",
                      "--range", 10, "--pings", 20, "--quiet", *arguments)

    def test_the_image_is_small_and_whole(self):
        [image], [base] = (json.loads(podman("image", "inspect", name)) for name in ("localhost/sonard", BASE))
        megabytes = (image["Size"] - base["Size"]) / 1e6
        print(f"image: {megabytes:.0f} MB beside the base of {base['Size'] / 1e6:.0f} MB")
        self.assertLessEqual(megabytes, MOST_MB)
        self.assertEqual(image["User"], "sonard")
        self.assertIn("NVIDIA_DRIVER_CAPABILITIES=graphics,compute,utility", image["Config"]["Env"])
        for program in ("sonard", "sonarview", "posecast"):
            libraries = podman("run", "--rm", "--network", "none", "--entrypoint", "ldd", "sonard", f"/usr/bin/{program}")
            self.assertNotIn("not found", libraries)
        plugins = podman("run", "--rm", "--network", "none", "--entrypoint", "sh", "sonard", "-c",
                         "ldd /usr/lib/*/osgPlugins-*/osgdb_png.so /usr/lib/*/osgPlugins-*/osgdb_jpeg.so /usr/lib/*/osgPlugins-*/osgdb_tiff.so")
        self.assertNotIn("not found", plugins)
        self.assertRegex(podman("run", "--rm", "--network", "none", "sonard", "--version"), r"^sonard \d+\.\d+\.\d+, commit [0-9a-f]+")

    def test_the_default_command_serves_other_containers(self):
        network = self.network()
        head = self.start("--network", network, "sonard")
        self.wait_until_ready(head)
        self.assertNotIn("warning", self.log(head))
        podman("healthcheck", "run", head)
        self.assertIn("pings_complete=20 pings_incomplete=0", self.view(network))
        self.assertIn("pings_complete=20 pings_incomplete=0", self.view(network, "--head", self.address_of(head)))
        podman("stop", "--time", 60, head)
        [described] = json.loads(podman("inspect", head))
        self.assertEqual(described["State"]["ExitCode"], 0, self.log(head))

    def test_a_head_tells_one_client_and_no_other(self):
        network = self.network()
        text = (REPOSITORY / "configs" / "container.yaml").read_text()
        text = text.replace("worlds/", "/usr/share/sonard/configs/worlds/").replace("status: limited_broadcast", "status: [10.61.19.99]")
        configuration = self.folder / "unicast.yaml"
        configuration.write_text(text)
        head = self.start("--network", network, "--volume", f"{configuration}:/etc/unicast.yaml:ro", "sonard", "run", "/etc/unicast.yaml")
        self.wait_until_ready(head)
        self.assertIn("pings_complete=20 pings_incomplete=0", self.view(network, ["--ip", "10.61.19.99"]))
        with self.assertRaisesRegex(AssertionError, "no status"):
            self.view(network, ["--ip", "10.61.19.98"])

    def test_health_is_what_the_page_says(self):
        other = self.start("--network", "none", "--entrypoint", "sleep", "sonard", "600")
        podman("healthcheck", "run", other, expected=1)

    def test_the_demo_moves_without_a_network(self):
        said = podman("run", "--rm", *HARDENED, "--network", "none", "sonard", "demo", "--seconds", 10, "--out", "/tmp/out")
        self.assertRegex(said, r"got .* complete \([1-9]\d* in all\); 0 lines missing")

    def test_the_vehicle_of_the_compose_file(self):
        self.network("docker_vehicle")
        compose = ["podman-compose", "--file", COMPOSE]
        self.addCleanup(run, *compose, "down")
        run(*compose, "up", "--no-build", "--detach")
        head, client = "docker_sonar_1", "docker_client_1"
        self.wait_until_ready(head)
        self.wait_for("poses", lambda: "poses=" in self.log(head), head)

        def last_line():
            lines = [line for line in self.log(client).splitlines() if " pings, " in line]
            return lines[-1] if lines else "sonarview: 0 pings, "

        self.wait_for("100 pings", lambda: int(last_line().split()[1]) >= 100, client)
        print(last_line())
        self.assertIn("; 0 lines repaired, 0 missing", last_line())
        podman("healthcheck", "run", head)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--keep")
    options, rest = parser.parse_known_args()
    KEEP = options.keep and os.path.abspath(options.keep)
    unittest.main(argv=[sys.argv[0], *rest], verbosity=2)
