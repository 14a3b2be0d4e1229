#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Pings by the clock of a simulator that is slow, fast, paused, reset or set: equal stamps give equal images.

    simulated_time_test.py --programs DIR --modules DIR [TestCase.test_name ...]
"""

import argparse
import csv
import os
import subprocess
import sys
import time
import unittest

import numpy

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "tests", "support"), os.path.join(SOURCE, "tests", "system", "gemini")]

import link_test  # noqa: E402
import wire  # noqa: E402
from lab import Deadline, OwnMachine, Program  # noqa: E402
from link_test import PATIENCE_S, key_values  # noqa: E402

HERE = os.path.dirname(os.path.abspath(__file__))
WORLD = os.path.join(SOURCE, "tests", "data", "system", "two_walls.sdf")
WALL_M = 6.0  # the east wall, from x = 0
SPEED_MPS = 0.4  # of publish_stamps.py
PERIOD_MS = 60  # that the client asks for
MODULES = None  # folder with pose_pb2.py

DAEMON = """
world:
  file: {world}
engine: cpu
poses:
  {transport}:
    bind: 127.0.0.1:14601
  clock: {clock}
sampling:
  preset: grid
  views: 3
  columns_per_view: 64
  rows: 32
heads:
{head}
"""

MICRON = """
  - name: bow
    type: micron
    serial:
      tcp: [{{bind: 10.61.19.200:4001, allow: [10.61.19.0/24]}}]
    dump: {{directory: {dump}}}
"""


def first_echo_m(path):
    """Range of the first bin above half of the maximum in the beam ahead, of an 8-bit image."""
    image = numpy.load(path)
    column = image[:, image.shape[1] // 2]
    return (column > column.max() / 2).argmax() * wire.line_step_m(1500.0)


class SimulatedTime(link_test.LinkTest):
    life = 0  # daemons started by this test

    def run_daemon(self, steps, clock="simulated_lock_step", noisy=True, transport="tcp", posecast=(), last_ms=None):
        """A daemon and a client that listens; then a simulator with these steps, after standing at time 0 while the client
        requests its pings, or posecast with these arguments. Returns [(time of the pose in ns, CRC-32)] of the pings.
        With `last_ms`, waits for the ping at this time."""
        head = self.head_config(noisy=False).replace(f"directory: {self.folder.name}", f"directory: {self.next_dump()}")
        if noisy:
            head = head.replace("speckle: off", "speckle: ou").replace("noise: false", "noise: true")
        lab = self.start(head, clock, transport)
        viewer = self.start_viewer(lab, "--continuous", str(PERIOD_MS), range_m=7)
        self.daemon.wait_for_line(r"client 10\.61\.19\.10 connected", PATIENCE_S)
        if posecast:
            self.publish(lab.start(lab.head, os.path.join(link_test.PROGRAMS, "posecast"), *posecast))
        else:
            self.simulate(lab, steps, transport)
        if last_ms is not None:
            self.wait_while_pinging(lambda: self.pings()[-1][0] < last_ms * 1_000_000)
        viewer.terminate(PATIENCE_S)
        self.end_daemon(self.daemon)
        self.received = {line["crc32"] for line in map(key_values, viewer.lines) if line.get("lines_lost") == "0"}
        return self.pings()

    def run_micron(self, steps):
        lab = self.start(MICRON.format(dump=self.next_dump()), "simulated_lock_step", "tcp")
        viewer = lab.start(lab.client, os.path.join(link_test.PROGRAMS, "sonarview"), "micron", "--tcp",
                           f"{link_test.HEAD_ADDRESS}:4001", "--range", "7", "--bins", "300", "--line-wait", "0", "--quiet")
        self.daemon.wait_for_line(r"head=bow: ready", PATIENCE_S)
        self.simulate(lab, steps, "tcp")
        viewer.terminate(PATIENCE_S)
        self.end_daemon(self.daemon)
        return self.pings()

    def next_dump(self):
        self.life += 1
        self.dump = os.path.join(self.folder.name, f"life{self.life}")
        return self.dump

    def start(self, head, clock, transport):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(DAEMON.format(world=WORLD, transport=transport, clock=clock, head=head))
        lab = self.make_lab()
        self.daemon = lab.start(lab.head, os.path.join(link_test.PROGRAMS, "sonard"), "run", path)
        self.daemon.wait_for_line(r"sonard ready heads=1 ", link_test.START_S)
        return lab

    def simulate(self, lab, steps, transport):
        publisher = lab.start(lab.head, sys.executable, os.path.join(HERE, "publish_stamps.py"), "--modules", MODULES, "--to",
                              "127.0.0.1:14601", *(["--udp"] if transport == "udp" else []), "stand:1.5", *steps)
        self.publish(publisher)

    def publish(self, publisher):
        self.wait_while_pinging(publisher.running)
        self.assertEqual(publisher.wait(PATIENCE_S), 0, publisher.tail())
        self.wait_for_last_ping()

    def wait_while_pinging(self, unfinished):
        """Waits for the end as long as pings arrive; a daemon without a ping for a long time has stopped."""
        deadline, seen = Deadline(PATIENCE_S), 0
        while unfinished() and not deadline.over():
            time.sleep(0.2)
            if len(self.pings()) != seen:
                deadline, seen = Deadline(PATIENCE_S), len(self.pings())

    def wait_for_last_ping(self):
        """The publisher ends when its last pose is received; a few pings may still come."""
        seen = -1
        while seen != len(self.pings()):
            seen = len(self.pings())
            time.sleep(1.0)

    def pings(self):
        try:
            with open(os.path.join(self.dump, "bow.csv"), encoding="utf-8") as file:
                return [(int(row["pose_ns"]), row["crc32"]) for row in csv.DictReader(file)]
        except FileNotFoundError:
            return []

    def check_grid(self, pings, first_ms, last_ms):
        """A ping every period, without gaps."""
        times = [time_ns for time_ns, _ in pings]
        self.assertEqual(times, list(range(first_ms * 1_000_000, last_ms * 1_000_000 + 1, PERIOD_MS * 1_000_000)))

    def test_the_same_stamps_give_the_same_images_however_fast(self):
        real_time = self.run_daemon(["run:1.5@1"])
        # The last echo of 7 m is back after 9.3 ms, so the last ping in 1.5 s is at 1.44 s.
        self.check_grid(real_time, 0, 1440)
        self.assertEqual(len({crc for _, crc in real_time}), len(real_time), "noise and motion change every image")
        self.assertLessEqual({crc for _, crc in real_time}, self.received, "the client has them all")
        for steps in (["run:1.5@0.25"], ["run:1.5@5"], ["run:1.5@0"],
                      ["run:0.4@1", "stand:1", "run:0.5@5", "silent:2", "run:0.6@0.5"]):
            self.assertEqual(self.run_daemon(steps), real_time, steps)

    def test_posecast_sends_the_same_stamps_however_fast(self):
        way = os.path.join(self.folder.name, "way.csv")
        with open(way, "w", encoding="utf-8") as file:
            file.write(f"t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1.5,{1.5 * SPEED_MPS},0,0,0,0,0,1\n")
        cast = [way, "--tcp", "--to", "127.0.0.1:14601", "--stamps", "file", "--hold", "1.5", "--quiet"]
        slow = self.run_daemon([], posecast=[*cast, "--speed", "1"])
        self.check_grid(slow, 0, 1440)
        self.assertEqual(len({crc for _, crc in slow}), len(slow), "noise and motion change every image")
        self.assertEqual(self.run_daemon([], posecast=[*cast, "--speed", "1000"]), slow)

    def test_a_publisher_by_tcp_waits_for_the_pings(self):
        """45 s of simulated time at once are 4500 poses; the history keeps 4096. Most pings come after the last pose."""
        pings = self.run_daemon(["run:45@0"], noisy=False, last_ms=44940)
        self.check_grid(pings, 0, 44940)
        self.assertNotIn("left out", self.daemon.output())

    def test_images_are_those_of_their_stamps(self):
        for time_ns, _ in self.run_daemon(["run:2@2"], noisy=False)[::6]:
            number = [t for t, _ in self.pings()].index(time_ns)
            range_m = first_echo_m(os.path.join(self.dump, f"bow-{number:08}.npy"))
            # One line, plus the footprint of a sample.
            self.assertAlmostEqual(range_m, WALL_M - SPEED_MPS * time_ns * 1e-9, delta=0.02)

    def test_paused_it_says_nothing_but_its_status(self):
        pings = self.run_daemon(["run:0.3@1", "stand:2", "silent:2"], noisy=False)
        self.check_grid(pings, 0, 240)

    def test_reset_it_begins_anew_with_the_same_images(self):
        pings = self.run_daemon(["run:1@1", "set:0", "run:1@2"], noisy=False)
        first, second = pings[:17], pings[17:]
        self.check_grid(first, 0, 960)
        # The clock of the second life begins with the stamp 10 ms, and its first ping is at a whole number of periods.
        self.assertEqual(second, first[1:])
        self.assertIn("went back by", self.daemon.output())

    def test_set_forward_nothing_is_made_up_for_the_time_between(self):
        pings = self.run_daemon(["run:0.5@1", "set:99.99", "run:0.5@1"], noisy=False)
        times_ms = [time_ns // 1_000_000 for time_ns, _ in pings]
        self.assertEqual(times_ms, [*range(0, 481, 60), *range(100_020, 100_480, 60)])

    def test_without_lock_step_a_fast_simulator_is_kept_up_with(self):
        every = dict(self.run_daemon(["run:3@1"], noisy=False))
        some = self.run_daemon(["run:3@20"], clock="simulated", noisy=False)
        self.assertLess(len(some), len(every))
        self.assertGreater(len(some), 1)
        for time_ns, crc in some:
            self.assertEqual(crc, every[time_ns], "those that are made are the same")

    def test_a_micron_keeps_the_same_time(self):
        slow = self.run_micron(["run:2@0.5"])
        times = [time_ns for time_ns, _ in slow]
        # 300 bins of 23 mm, one line after another over a serial line of 115200 baud (protocol/micron/README.md 8.4).
        self.assertGreater(len(slow), 40)
        self.assertEqual(len({b - a for a, b in zip(times, times[1:])}), 1, "evenly")
        self.assertEqual(self.run_micron(["run:2@4"]), slow)

    def test_poses_by_udp_do_as_well(self):
        by_tcp = self.run_daemon(["run:1@1"])
        self.assertEqual(self.run_daemon(["run:1@1"], transport="udp"), by_tcp)


class LockStepExample(OwnMachine):
    """clients/examples/lock_step.py with configs/lock-step.yaml, as in docs/ci.md."""

    def one_run(self):
        daemon = Program([os.path.join(link_test.PROGRAMS, "sonard"), "run", os.path.join(SOURCE, "configs", "lock-step.yaml")], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", link_test.START_S)
        done = subprocess.run([sys.executable, os.path.join(SOURCE, "clients", "examples", "lock_step.py"), "--pings", "4"],
                              env={**os.environ, "PYTHONPATH": os.path.join(SOURCE, "clients", "python")}, capture_output=True,
                              text=True, timeout=PATIENCE_S, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)
        return done.stdout.splitlines()

    def test_two_runs_agree(self):
        first = self.one_run()
        self.assertEqual([line.split()[0] for line in first], ["0.000", "0.100", "0.200", "0.300"])
        self.assertEqual(len({line.split()[1] for line in first}), 4)
        self.assertEqual(self.one_run(), first)


def main():
    global MODULES
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    parser.add_argument("--modules", required=True, help="folder with pose_pb2.py")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    link_test.PROGRAMS = os.path.abspath(arguments.programs)
    MODULES = os.path.abspath(arguments.modules)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
