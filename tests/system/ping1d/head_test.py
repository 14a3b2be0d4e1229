#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A Ping1D on UDP with a lossy link, also to another machine, on TCP and on a pseudo terminal; recorded, replayed and
rendered offline.

    head_test.py --programs DIR [Ping1d.test_name ...]
"""

import argparse
import glob
import json
import os
import re
import subprocess
import sys
import tempfile
import unittest
import uuid

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [os.path.join(HERE, "..", "gemini")]
from lab import HEAD_ADDRESS, Lab, Namespace, Program, need  # noqa: E402

DEMO = os.path.join(SOURCE, "configs", "demo-ping1d.yaml")
START_S = 60
PATIENCE_S = 60
DEPTH_M = 4.0  # of the tank below the head
PROGRAMS = None


class Case(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        need("ip")
        folder = tempfile.TemporaryDirectory(prefix="sonard-ping1d-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.make_machines()

    @classmethod
    def make_machines(cls):
        """Sets `machine`, on which the head is, and `viewer`, on which its clients are."""
        cls.machine = cls.viewer = Namespace("sonard-" + uuid.uuid4().hex[:8])
        cls.addClassCleanup(cls.machine.remove)

    def program(self, name, *arguments):
        machine = self.viewer if name == "sonarview" else self.machine
        program = Program(machine.command(os.path.join(PROGRAMS, name), *arguments), name)
        self.addCleanup(program.kill)
        return program

    def daemon(self, **replaced):
        """Starts the demo's head, with other text in its configuration."""
        with open(DEMO, encoding="utf-8") as file:
            text = file.read().replace("file: worlds", "file: " + os.path.join(SOURCE, "configs", "worlds"))
        for old, new in replaced.values():
            self.assertIn(old, text)
            text = text.replace(old, new)
        path = os.path.join(self.folder, uuid.uuid4().hex + ".yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        daemon = self.program("sonard", "run", path)
        daemon.wait_for_line("sonard ready", START_S)
        return daemon

    def end(self, daemon):
        code, _ = daemon.terminate(10)
        self.assertEqual(code, 0, daemon.tail())
        self.assertNotRegex(daemon.output(), "Z (error|critical) ")

    def view(self, *arguments):
        """Runs sonarview; returns its pings and its summary as dictionaries."""
        program = self.program("sonarview", "ping1d", *arguments, "--log-pings", "--quiet")
        self.assertEqual(program.wait(PATIENCE_S), 0, program.tail())
        pairs = [dict(re.findall(r"(\w+)=(\S+)", line)) for line in program.output().splitlines()]
        return [pair for pair in pairs if "crc32" in pair], pairs[-1]

    def assert_depth(self, pings):
        for ping in pings:
            self.assertAlmostEqual(float(ping["distance_m"]), DEPTH_M, delta=0.011)
            self.assertGreater(int(ping["confidence"]), 50)


class Ping1d(Case):
    def test_every_transport_reaches_the_same_head(self):
        daemon = self.daemon(tcp=("      pty:\n        - {}", f"      pty: [{{link: {self.folder}/tty}}]\n"
                                  "      tcp: [{bind: 127.0.0.1:4001}]"))
        numbers = []
        for link in ("--udp", "127.0.0.1:9090"), ("--tcp", "127.0.0.1:4001"), ("--tty", f"{self.folder}/tty"):
            pings, summary = self.view(*link, "--pings", "20", "--interval", "20", "--out", f"{self.folder}/out")
            self.assertEqual((len(pings), summary["pings_missed"], summary["frames_bad"]), (20, "0", "0"), link)
            self.assert_depth(pings)
            numbers += [int(ping["number"]) for ping in pings]
        self.assertEqual(numbers, sorted(numbers), "one count for all clients")
        self.assertGreater(os.path.getsize(f"{self.folder}/out/waterfall-last.png"), 1000)
        self.end(daemon)

    def test_a_lossy_link_costs_pings_but_no_wrong_ones(self):
        daemon = self.daemon(link=("    udp:\n", "    link: {seed: 1, to_client: {loss: 0.1, duplicate: 0.1}, "
                                   "from_client: {loss: 0.1, duplicate: 0.1}}\n    udp:\n"))
        daemon.wait_for_line("serves udp", 1)
        pings, summary = self.view("--udp", "127.0.0.1:9090", "--pings", "100", "--interval", "20")
        self.assert_depth(pings)
        self.assertEqual(summary["frames_bad"], "0")
        self.assertGreater(int(summary["pings_missed"]), 2)
        self.end(daemon)

    def test_manual_mode_and_a_refusal(self):
        daemon = self.daemon()
        pings, _ = self.view("--udp", "127.0.0.1:9090", "--pings", "5", "--range", "8", "--start", "2", "--gain", "3")
        self.assert_depth(pings)
        self.assertEqual({(ping["start_m"], ping["length_m"], ping["gain"]) for ping in pings[1:]},
                         {("2.000", "8.000", "3")}, "but for the ping that was under way")
        refused = self.program("sonarview", "ping1d", "--udp", "127.0.0.1:9090", "--range", "100", "--start", "100")
        self.assertEqual(refused.wait(PATIENCE_S), 4, refused.tail())
        self.assertIn("the head refused a command: range out of range", refused.output())
        self.end(daemon)

    def test_a_recording_is_replayed_byte_for_byte(self):
        logs = os.path.join(self.folder, "logs")
        daemon = self.daemon(recording=("heads:\n", f"recording: {{directory: {logs}}}\nheads:\n"))
        live, _ = self.view("--udp", "127.0.0.1:9090", "--pings", "30", "--interval", "50")
        self.end(daemon)
        log, = glob.glob(os.path.join(logs, "*.mcap"))
        said = subprocess.run([os.path.join(PROGRAMS, "sonard"), "info", log], capture_output=True, text=True, check=True)
        self.assertIn("head     Ping1D 1 'ping2'", said.stdout)
        player = self.program("sonard", "replay", log)
        place = player.wait_for_line(r"serves udp (\S+)", START_S).split("serves udp ")[1].split()[0]
        played, _ = self.view("--udp", place, "--pings", "20")
        known = [ping["crc32"] for ping in live]
        self.assertEqual([ping["crc32"] for ping in played][:15], known[:15])
        self.assertEqual([ping["distance_m"] for ping in played][:15], [ping["distance_m"] for ping in live][:15])

    def test_rendered_offline(self):
        way = os.path.join(self.folder, "way.csv")
        with open(way, "w", encoding="utf-8") as file:
            file.write("t,x,y,z,qx,qy,qz,qw\n0,-1,-0.5,-4,0,0,0,1\n1,-1,-0.5,-4,0,0,0,1\n")
        out = os.path.join(self.folder, "rendered")
        subprocess.run([os.path.join(PROGRAMS, "sonard"), "render", DEMO, "--trajectory", way, "--out", out, "--range", "10"],
                       capture_output=True, timeout=120, check=True)
        frames = sorted(glob.glob(os.path.join(out, "*.npy")))
        self.assertGreaterEqual(len(frames), 4)
        samples = numpy.load(frames[0])
        self.assertEqual((samples.shape, samples.dtype), ((2000, 1), numpy.uint8))
        with open(frames[0].replace(".npy", ".json"), encoding="utf-8") as file:
            geometry = json.load(file)["geometry"]
        bed = next(row for row in range(100, 2000) if samples[row, 0] > 20)
        self.assertAlmostEqual(bed * geometry["line_step_m"], DEPTH_M, delta=0.011)


class TwoMachines(Case):
    """Two network namespaces on one wire, and a link that loses, doubles, reorders and delays in both directions."""

    FAULTS = "{loss: 0.1, duplicate: 0.1, reorder: 0.1, delay_ms: 3, jitter_ms: 4}"

    @classmethod
    def make_machines(cls):
        lab = Lab()
        lab.__enter__()
        cls.addClassCleanup(lab.__exit__)
        cls.machine, cls.viewer = lab.head, lab.client

    def counts(self, daemon):
        """The daemon's counters of the head and of its link."""
        said = " ".join(re.findall(r"head=ping2: (?:ended|transport) (.*)", daemon.output()))
        return {name: int(value) for name, value in re.findall(r"(\w+)=(\d+)(?= |$)", said)}

    def test_each_ping_arrives_once_or_is_lost(self):
        daemon = self.daemon(udp=("      - bind: 127.0.0.1:9090", f"      - {{bind: {HEAD_ADDRESS}:9090, allow: [10.61.19.0/24]}}"),
                             link=("    udp:\n", f"    link: {{seed: 1, to_client: {self.FAULTS}, from_client: {self.FAULTS}}}\n"
                                   "    udp:\n"))
        pings, summary = self.view("--udp", f"{HEAD_ADDRESS}:9090", "--pings", "300", "--interval", "20")
        self.assert_depth(pings)
        numbers = [int(ping["number"]) for ping in pings]
        self.assertEqual(numbers, sorted(set(numbers)), "in order, and none twice")
        self.assertEqual((summary["frames_bad"], summary["bytes_dropped"]), ("0", "0"))
        self.assertEqual(int(summary["pings_missed"]), numbers[-1] - numbers[0] + 1 - len(numbers))
        self.end(daemon)
        counts = self.counts(daemon)
        for fault in "lost", "duplicated", "reordered":
            self.assertGreater(counts[f"to_client_{fault}"], 10)
        arrived = counts.get("from_client_passed", counts["received"])
        self.assertEqual(counts["commands"], arrived, "every command that arrived was understood")
        late = counts["to_client_reordered"]
        self.assertLessEqual(int(summary["pings_missed"]), counts["to_client_lost"] + late, "a ping was lost or came late")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    parsed, rest = parser.parse_known_args()
    PROGRAMS = os.path.abspath(parsed.programs)
    unittest.main(argv=[sys.argv[0], "-v", *rest])
