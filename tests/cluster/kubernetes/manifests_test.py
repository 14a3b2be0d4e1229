#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks clients/examples/kubernetes with the published schemas, and runs its commands as a cluster would.

    manifests_test.py --programs DIR --npm DIR [TestCase.test_name ...]

No cluster is started. Needs permission to make network namespaces.
"""

import argparse
import pathlib
import subprocess
import sys
import unittest
import urllib.error
import urllib.request

import yaml

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
sys.path += [str(REPOSITORY / "tests" / "support"), str(REPOSITORY / "tests" / "system" / "gemini")]
from data_set import FRAMES, Files, frames, sums  # noqa: E402
from lab import Deadline, OwnMachine, Program  # noqa: E402

PROGRAMS = None  # folder of the programs under test
NPM = None  # folder with check_manifests.js and its node_modules
MANIFESTS = REPOSITORY / "clients" / "examples" / "kubernetes"
PATIENCE_S = 300


def objects(name):
    return list(yaml.safe_load_all((MANIFESTS / name).read_text()))


def of_kind(name, kind):
    return [one for one in objects(name) if one["kind"] == kind]


def container_of(workload):
    [container] = workload["spec"]["template"]["spec"]["containers"]
    return container


class Schemas(Files):
    def check(self, *paths):
        done = subprocess.run(["node", "check_manifests.js", *map(str, paths)], cwd=NPM, capture_output=True, text=True, timeout=120)
        self.assertEqual(done.stderr, "")
        return done.returncode, done.stdout.splitlines()

    def test_all_manifests_are_good(self):
        files = sorted(MANIFESTS.glob("*.yaml"))
        code, said = self.check(*files)
        self.assertEqual(said, [f"{one['kind']} {one['metadata']['name']}: good" for file in files for one in objects(file.name)])
        self.assertEqual(code, 0)

    def test_mistakes_are_found(self):
        good = (MANIFESTS / "frames.yaml").read_text()
        for right, wrong, named in (("completionMode: Indexed", "completionMode: Index", "/spec/completionMode"),
                                    ("backoffLimitPerIndex", "backofLimitPerIndex", "/spec/backofLimitPerIndex"),
                                    ("- action: FailJob", "- action: Fail", "/spec/podFailurePolicy/rules/1/action"),
                                    ("completions: 16", "completions: all", "/spec/completions"),
                                    ("image: sonard", "images: sonard", "/spec/template/spec/containers/0/images"),
                                    ("apiVersion: batch/v1", "apiVersion: apps/v1", "no kind Job")):
            self.assertIn(right, good)
            self.write("broken.yaml", good.replace(right, wrong, 1))
            code, said = self.check(self.folder / "broken.yaml")
            self.assertEqual((code, said[0]), (1, "Job sonard-frames: bad"))
            self.assertIn(named, said[1])


class IndexedJob(Files):
    """Rules of Kubernetes' documentation of Jobs that are in no schema, and the results of the pods."""

    def setUp(self):
        super().setUp()
        [self.job] = of_kind("frames.yaml", "Job")
        [self.log] = of_kind("log.yaml", "Job")

    def run_pod(self, job, index=None, expected=0, **changes):
        """Runs the command of a pod of the job, with this machine's folder as /data."""
        arguments = [text.replace("$(JOB_COMPLETION_INDEX)", str(index)).replace("/data", str(self.folder))
                     for text in container_of(job)["args"]]
        arguments = [changes.get(text, text) for text in arguments]
        done = subprocess.run([PROGRAMS / "sonard", *arguments, *self.RENDER], capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, expected, done.stderr)
        return done

    def test_all_indexes_together_make_the_bytes_of_one_process(self):
        self.render_whole(PROGRAMS)
        count = self.job["spec"]["completions"]
        lost = 5
        for index in reversed(range(count)):
            if index != lost:
                self.run_pod(self.job, index)
        there = {f"ping_{k:06}.json" for k in range(FRAMES) if k % count != lost}
        self.assertEqual(set(frames(self.folder / "frames")), there)
        before = frames(self.folder / "frames")
        self.run_pod(self.log)
        self.assertEqual({name: frames(self.folder / "frames")[name] for name in before}, before, "a whole frame was made again")
        self.assertEqual(sums(self.folder / "frames"), sums(self.folder / "whole"))

    def test_shares_and_tries(self):
        spec = self.job["spec"]
        self.assertEqual((spec["completionMode"], spec["template"]["spec"]["restartPolicy"]), ("Indexed", "Never"))
        self.assertIn(f"--shard=$(JOB_COMPLETION_INDEX)/{spec['completions']}", container_of(self.job)["args"])
        self.assertEqual(spec["parallelism"], spec["completions"])
        self.assertEqual(container_of(self.job)["args"][:-1], container_of(self.log)["args"])
        disrupted, mistake = spec["podFailurePolicy"]["rules"]
        self.assertEqual((disrupted["action"], disrupted["onPodConditions"]), ("Ignore", [{"type": "DisruptionTarget", "status": "True"}]))
        self.assertEqual((mistake["action"], mistake["onExitCodes"]["containerName"]), ("FailJob", container_of(self.job)["name"]))
        # 137 is SIGKILL, for example if memory runs out; 143 is the SIGTERM of a node that is drained.
        self.assertEqual(mistake["onExitCodes"]["values"], [2, 5, 64])

    def test_mistakes_end_with_the_exit_codes_that_fail_the_job(self):
        self.run_pod(self.job, 0, expected=64, **{"render": "rendr"})
        (self.folder / "frames").mkdir()
        self.write("frames/run.json", "{}\n")
        self.run_pod(self.job, 0, expected=5)
        self.write("config.yaml", "heads: 3\n")
        self.run_pod(self.job, 0, expected=2)


class Fleet(OwnMachine):
    """A pod is a machine (namespace) of its own with address 127.0.0.2."""

    def test_a_pod_serves_its_heads_and_says_that_it_is_well(self):
        [vehicle] = of_kind("fleet.yaml", "StatefulSet")
        container = container_of(vehicle)
        folder = pathlib.Path(self.folder.name)
        [configuration] = of_kind("fleet.yaml", "ConfigMap")
        text = configuration["data"]["vehicle.yaml"].replace("/usr/share/sonard", str(REPOSITORY))
        text = text.replace("10.0.0.0/8", "127.0.0.0/8").replace("address: eth0", "address: 127.0.0.2").replace("netmask: eth0", "netmask: 255.0.0.0")
        (folder / "vehicle.yaml").write_text(text)
        pod = Program([PROGRAMS / "sonard", *(word.replace("/etc/vehicle", str(folder)) for word in container["args"])], "sonard")
        self.addCleanup(pod.kill)
        pod.wait_for_line("sonard ready", 120)
        ports = {port["name"]: port["containerPort"] for port in container["ports"]}
        for probe, path in (("readinessProbe", "/ready"), ("livenessProbe", "/health")):
            asked = container[probe]["httpGet"]
            self.assertEqual(asked["path"], path, "ready to serve is not the same as alive")
            self.assertGreaterEqual(container[probe]["timeoutSeconds"], 5, "the default of 1 s is short for a busy node")
            self.wait_until_well(f"http://127.0.0.2:{ports[asked['port']]}{asked['path']}")
        view = subprocess.run([PROGRAMS / "sonarview", "--pings", "3", "--range", "10"], capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertIn("summary pings_complete=3 pings_incomplete=0", view.stdout)
        view = subprocess.run([PROGRAMS / "sonarview", "micron", "--tcp", f"127.0.0.2:{ports['micron']}", "--lines", "20"],
                              capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(view.returncode, 0, view.stderr)
        pod.terminate(60)

    def wait_until_well(self, address):
        deadline = Deadline(PATIENCE_S)
        while True:
            try:
                with urllib.request.urlopen(address, timeout=30) as answer:
                    self.assertEqual(answer.status, 200)
                    return
            except urllib.error.HTTPError:
                self.assertFalse(deadline.over(), address)

    def test_each_head_of_each_vehicle_has_its_service(self):
        [vehicle] = of_kind("fleet.yaml", "StatefulSet")
        [configuration] = of_kind("fleet.yaml", "ConfigMap")
        heads = {head["name"]: head for head in yaml.safe_load(configuration["data"]["vehicle.yaml"])["heads"]}
        ports = {"gemini": (heads["gemini"]["network"].get("command_port", 52901), "UDP"),
                 "micron": (int(heads["micron"]["serial"]["tcp"][0]["bind"].split(":")[1]), "TCP")}
        self.assertEqual(ports.keys(), heads.keys())
        services = {one["metadata"]["name"]: one["spec"] for one in of_kind("fleet.yaml", "Service")}
        everything = services.pop(vehicle["spec"]["serviceName"])
        self.assertEqual(everything["selector"], vehicle["spec"]["template"]["metadata"]["labels"])
        self.assertEqual(vehicle["spec"]["selector"]["matchLabels"], everything["selector"])
        expected = {f"vehicle-{number}-{head}": (f"vehicle-{number}", *port)
                    for number in range(vehicle["spec"]["replicas"]) for head, port in ports.items()}
        found = {name: (spec["selector"]["statefulset.kubernetes.io/pod-name"], spec["ports"][0]["port"],
                        spec["ports"][0].get("protocol", "TCP")) for name, spec in services.items()}
        self.assertEqual(found, expected)
        self.assertEqual({spec["clusterIP"] for spec in [*services.values(), everything]}, {"None"})
        opened = {(port["containerPort"], port.get("protocol", "TCP")) for port in container_of(vehicle)["ports"]}
        self.assertLessEqual(set(ports.values()), opened)


def main():
    global PROGRAMS, NPM
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, type=pathlib.Path, help="folder with sonard and sonarview")
    parser.add_argument("--npm", required=True, help="folder with the script, where npm has installed its needs")
    parser.add_argument("tests", nargs="*")
    options = parser.parse_args()
    PROGRAMS, NPM = options.programs.resolve(), options.npm
    unittest.main(argv=[sys.argv[0], "-v", *options.tests], module=__name__)


if __name__ == "__main__":
    main()
