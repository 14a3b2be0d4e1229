#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The findings of log, status and `sonard check` about poses that make an image black, on a machine of its own.

    diagnosis_test.py --programs DIR --modules DIR [TestCase.test_name ...]

Places and their findings are in tests/data/system/wrong_poses.json; distances follow from pier_and_hull.sdf beside it.
"""

import argparse
import contextlib
import itertools
import json
import os
import re
import socket
import subprocess
import sys
import threading
import time
import unittest
import urllib.error
import urllib.request

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path.append(os.path.join(SOURCE, "tests", "system", "gemini"))
from lab import OwnMachine, Program  # noqa: E402

DATA = os.path.join(SOURCE, "tests", "data", "system")
PROGRAMS = None  # folder of the programs under test
POSE_PB2 = None
PATIENCE_S = 20
POSES = ("127.0.0.1", 14600)
PAGE = "127.0.0.1:8014"
GOOD = {"position_m": [30, 0, -5]}  # 17 m before the pier

CONFIG = """
engine: cpu
world: {{file: {world}{vehicle}}}
poses: {{{poses}}}
sampling: {{preset: fast}}
web: {{bind: "{page}"}}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    network: {{alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}}
{head}"""


def wrong_poses():
    with open(os.path.join(DATA, "wrong_poses.json"), encoding="utf-8") as file:
        return json.load(file)


class Publisher:
    """Sends a pose every `period_s` that moves at a constant speed. Stamps are from its own clock, or `stamp` computes
    them from the seconds since the start."""

    def __init__(self, pose, ticks_per_s=1e9, speed_mps=0.0, stamp=None, period_s=0.05):
        self.pose = pose
        self.period_s = period_s
        self.ticks_per_s = ticks_per_s
        self.speed_mps = speed_mps
        self.stamp = stamp
        self._begin = time.monotonic()
        self.back_s = 0.0
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.connect(POSES)
        self.address = "127.0.0.1:%d" % self._socket.getsockname()[1]
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    def _run(self):
        while not self._end.wait(self.period_s):
            since_s = time.monotonic() - self._begin
            own_ns = round((time.monotonic() - self.back_s) * self.ticks_per_s)
            update = POSE_PB2.PoseUpdate(time_ns=own_ns if self.stamp is None else self.stamp(since_s))
            at, turn = update.vehicle.position_m, update.vehicle.orientation
            at.x, at.y, at.z = self.pose["position_m"]
            at.y += self.speed_mps * since_s
            turn.x, turn.y, turn.z, turn.w = self.pose.get("orientation_xyzw", [0, 0, 0, 1])
            with contextlib.suppress(ConnectionRefusedError):  # nobody listens yet
                self._socket.send(update.SerializeToString())

    def close(self):
        self._end.set()
        self._thread.join()
        self._socket.close()


class Diagnosis(OwnMachine):
    def config(self, poses="udp: {bind: 127.0.0.1:14600}", vehicle="", world="pier_and_hull.sdf", head=""):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=os.path.join(DATA, world), poses=poses, vehicle=vehicle,
                                     page=PAGE, head=head))
        return path

    def start(self, **config):
        """A daemon, and a client that requests pings to 20 m."""
        daemon = Program([os.path.join(PROGRAMS, "sonard"), "run", self.config(**config)], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", PATIENCE_S)
        self.start_client()
        return daemon

    def start_client(self):
        client = Program([os.path.join(PROGRAMS, "sonarview"), "--continuous", "100", "--range", "20", "--ping-wait", "0",
                          "--client-address", "127.0.0.1"], "sonarview")
        self.addCleanup(client.kill)

    def publish(self, pose, **options):
        publisher = Publisher(pose, **options)
        self.addCleanup(publisher.close)
        return publisher

    def status(self):
        with urllib.request.urlopen(f"http://{PAGE}/api/status", timeout=PATIENCE_S) as answer:
            return json.load(answer)

    def reasons(self):
        """Why the daemon is not ready; empty if it is."""
        try:
            with urllib.request.urlopen(f"http://{PAGE}/ready", timeout=PATIENCE_S) as answer:
                return json.load(answer)["reasons"]
        except urllib.error.HTTPError as error:
            self.assertEqual(error.code, 503)
            return json.load(error)["reasons"]

    def wait_for_finding(self, findings_of, says):
        """Waits until the status has the finding; otherwise fails and prints the findings."""
        end = time.monotonic() + PATIENCE_S
        found = []
        while time.monotonic() < end:
            found = [finding["text"] for finding in findings_of(self.status())]
            if any(re.search(says, text) for text in found):
                return
            time.sleep(0.1)
        self.fail(f"the status does not say '{says}' but {found}")

    def check(self, *arguments, expected_exit=0):
        done = subprocess.run([os.path.join(PROGRAMS, "sonard"), "check", "--no-network", *arguments], text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=PATIENCE_S)
        self.assertEqual(done.returncode, expected_exit, done.stdout)
        return done.stdout

    def test_every_wrong_pose_is_named_once_in_the_log_and_in_the_status(self):
        daemon = self.start()
        publisher = self.publish(GOOD)
        for number, pose in enumerate(wrong_poses(), 1):
            publisher.pose = pose
            daemon.wait_for_line("warning head=bow: .*" + pose["says"], PATIENCE_S)
            self.wait_for_finding(lambda status: status["heads"][0]["findings"], pose["says"])
            publisher.pose = GOOD
            daemon.wait_for_line("head=bow: problem resolved", PATIENCE_S, count=number)
        for pose in wrong_poses():
            said = [line for line in daemon.lines if re.search("warning head=bow: .*" + pose["says"], line)]
            self.assertEqual(len(said), 1, said)

    @staticmethod
    def says_of_check(pose):
        """Until a client requests a range, the check uses the range of the head's usual ping."""
        return pose["says"].replace("20(\\.\\d+)?", "\\d+(\\.\\d+)?")

    def test_check_names_every_wrong_start_pose(self):
        for pose in wrong_poses():
            if "orientation_xyzw" in pose:
                continue  # angles say it in the configuration
            with self.subTest(pose["name"]):
                printed = self.check(self.config("initial: {position_m: %s}" % pose["position_m"]))
                self.assertRegex(printed, "head 'bow': .*" + self.says_of_check(pose))

    def test_check_names_every_wrong_start_of_a_trajectory(self):
        way = os.path.join(self.folder.name, "way.csv")
        for pose in wrong_poses():
            with self.subTest(pose["name"]):
                turn = pose.get("orientation_xyzw", [0, 0, 0, 1])
                row = ",".join(str(number) for number in [*pose["position_m"], *turn])
                with open(way, "w", encoding="utf-8") as file:
                    file.write(f"t,x,y,z,qx,qy,qz,qw\n0,{row}\n1,{row}\n")
                printed = self.check(self.config("trajectory: {file: way.csv}"))
                self.assertRegex(printed, "poses.trajectory.file: head 'bow': .*" + self.says_of_check(pose))

    def test_listening_names_every_wrong_pose_that_is_heard(self):
        publisher = self.publish(GOOD)
        self.assertNotIn("wrong?", self.check("--listen", "1", self.config()))
        for pose in wrong_poses():
            with self.subTest(pose["name"]):
                publisher.pose = pose
                printed = self.check("--listen", "1", self.config())
                self.assertRegex(printed, "wrong\\?   head 'bow': .*" + self.says_of_check(pose))

    def test_a_publisher_that_was_started_anew_is_not_two(self):
        first = self.publish(GOOD)
        check = Program([os.path.join(PROGRAMS, "sonard"), "check", "--no-network", "--listen", "2", self.config()], "check")
        self.addCleanup(check.kill)
        check.wait_for_line("listening for", PATIENCE_S)
        time.sleep(0.7)
        first.close()
        self.publish(GOOD)
        self.assertEqual(check.wait(PATIENCE_S), 0, check.tail())
        self.assertFalse([line for line in check.lines if "at once" in line])

    def test_check_tells_of_the_own_hull(self):
        start = "initial: {position_m: [30, 0, -5]}"
        printed = self.check(self.config(start, ", vehicle_model: rov"))
        self.assertIn("inside the body 'rov', its own vehicle (to hide it, set hides_vehicle: true)", printed)
        with open(self.config(start, ", vehicle_model: rov"), "a", encoding="utf-8") as file:
            file.write("    hides_vehicle: true\n")
        self.assertNotIn("inside of", self.check(file.name))

    def test_open_water_is_no_fault(self):
        """Noise is present in each ping, so nothing is found, and the log states once that there is no surface."""
        path = self.config("initial: {position_m: [0, 0, -5]}")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        with open(path, "w", encoding="utf-8") as file:
            file.write(re.sub("^world: .*$", "world: empty", text, flags=re.MULTILINE))
        daemon = Program([os.path.join(PROGRAMS, "sonard"), "run", path], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", PATIENCE_S)
        client = subprocess.run([os.path.join(PROGRAMS, "sonarview"), "--pings", "5", "--range", "20",
                                 "--client-address", "127.0.0.1"], capture_output=True, text=True, timeout=PATIENCE_S)
        self.assertEqual(client.returncode, 0, client.stderr)
        self.assertEqual(self.status()["heads"][0]["findings"], [])
        self.assertEqual([line for line in daemon.lines if "warning" in line], [])
        self.assertEqual(len([line for line in daemon.lines if "no surface reflects sound" in line]), 1)

    def test_no_pose_is_said(self):
        daemon = self.start()
        daemon.wait_for_line("head=bow: No pose of the vehicle has arrived", PATIENCE_S)

    def test_no_pose_is_said_if_pings_wait_for_stamps(self):
        says = "^No pose of the vehicle has arrived, so the head does not ping"
        for initial in ("", ", initial: {position_m: [30, 0, -5]}"):
            for clock in ("simulated", "simulated_lock_step"):
                daemon = self.start(poses=f"udp: {{bind: 127.0.0.1:14600}}, clock: {clock}{initial}")
                daemon.wait_for_line("warning head=bow: " + says[1:], PATIENCE_S)
                self.wait_for_finding(self.heads_findings, says)
                publisher = self.publish(GOOD)
                daemon.wait_for_line("head=bow: problem resolved", PATIENCE_S)
                end = time.monotonic() + PATIENCE_S  # the page keeps a status for a moment
                while self.heads_findings(self.status()) and time.monotonic() < end:
                    time.sleep(0.1)
                self.assertEqual(self.heads_findings(self.status()), [])
                publisher.close()
                daemon.kill()

    def test_a_pose_that_went_stale_before_the_first_ping_is_not_a_missing_one(self):
        daemon = Program([os.path.join(PROGRAMS, "sonard"), "run",
                          self.config("udp: {bind: 127.0.0.1:14600}, stale: silence")], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", PATIENCE_S)
        publisher = self.publish(GOOD)
        time.sleep(0.5)
        publisher.close()
        time.sleep(1)
        self.start_client()
        self.wait_for_finding(self.heads_findings, "The head does not ping: the pose is stale")
        self.assertEqual([finding["code"] for finding in self.heads_findings(self.status())], ["stale_pose"])

    def heads_findings(self, status):
        return status["heads"][0]["findings"]

    def inputs_findings(self, status):
        return status["poses"]["inputs"][0]["findings"]

    def test_two_publishers_are_named(self):
        daemon = self.start()
        one, other = self.publish(GOOD), self.publish(GOOD)
        says = "2 publishers send poses at the same time: .*127"
        line = daemon.wait_for_line(says, PATIENCE_S)
        self.assertIn(one.address, line)
        self.assertIn(other.address, line)
        self.wait_for_finding(self.inputs_findings, says)
        daemon.kill()
        self.assertRegex(self.check("--listen", "2", self.config()), "wrong\\?   " + says)

    def test_units_of_stamps_are_named(self):
        for ticks_per_s, unit in ((1e6, "microseconds"), (1e3, "milliseconds"), (1.0, "seconds")):
            with self.subTest(unit):
                publisher = self.publish(GOOD, ticks_per_s=ticks_per_s)
                says = f"Stamps of poses look like {unit}[.] Send time_ns in nanoseconds"
                self.assertRegex(self.check("--listen", "3", self.config()), "wrong\\?   " + says)
                daemon = self.start()
                daemon.wait_for_line(says, PATIENCE_S)
                self.wait_for_finding(self.inputs_findings, says)
                daemon.kill()
                publisher.close()

    def test_stamps_in_seconds_have_one_cause(self):
        self.publish(GOOD, speed_mps=0.5, stamp=lambda since_s: int(1732800000 + since_s))
        output = self.check("--listen", "5", self.config())
        self.assertRegex(output, "wrong\\?   Stamps of poses look like seconds")
        self.assertEqual(output.count("wrong?"), 1, output)

    def test_stamps_that_run_backwards_are_named(self):
        self.publish(GOOD, speed_mps=0.5, stamp=lambda since_s: 10**15 - round(since_s * 1e9))
        says = "Stamps run backwards by (1|0\\.9\\d?) s per second"
        self.assertRegex(self.check("--listen", "3", self.config()), "wrong\\?   " + says)

    def test_stamps_that_count_poses_are_named(self):
        numbers = itertools.count(1)
        self.publish(GOOD, speed_mps=0.5, stamp=lambda since_s: next(numbers))
        says = r"Stamps advanced by only \S+ s over \d+ poses: do they count poses\? Send the time of each pose as time_ns, in nanoseconds"
        self.assertRegex(self.check("--listen", "3", self.config()), "wrong\\?   " + says)
        self.start()
        self.wait_for_finding(self.inputs_findings, says)

    def test_poses_at_one_hertz_are_too_rare(self):
        daemon = self.start()
        self.publish(GOOD, period_s=1.0)
        says = "Poses arrive at only (1|0\\.9\\d?) Hz, so the vehicle moves in jumps[.] Publish at 10 Hz or more"
        daemon.wait_for_line("warning pose stream udp .*" + says, PATIENCE_S)
        self.wait_for_finding(self.inputs_findings, says)
        daemon.kill()
        self.assertRegex(self.check("--listen", "6", self.config()), "wrong\\?   " + says)

    def test_messages_that_cannot_be_read_are_named_though_there_is_an_initial_pose(self):
        self.start(poses="udp: {bind: 127.0.0.1:14600}, initial: {position_m: [30, 0, -5]}")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
            sender.sendto(b"hello", POSES)
            self.wait_for_finding(self.inputs_findings, "^1 message from 127[.0-9:]* could not be read: message: is not a PoseUpdate")

    STANDING = {  # what is made of the seconds since the first pose
        "left out": (lambda since_s: 0, "The stamps do not change while the vehicle moves(, so the heads do not ping .*)?: is time_ns missing\\?"),
        "all alike": (lambda since_s: 1732800000123456789, "The stamps do not change while the vehicle moves"),
        "whole seconds": (lambda since_s: int(1732800000 + since_s) * 10**9,
                          "The stamps change only every (1|0\\.9\\d?) s while the vehicle moves: is time_ns in whole"),
    }

    def listen_without_stall(self):
        """What `check --listen` prints. It measures intervals by arrivals, so it listens again if a pose came late because
        the machine stalled."""
        for _ in range(5):
            printed = self.check("--listen", "5", self.config())
            if int(re.search(r"longest_gap_ms=(\d+)", printed)[1]) < 150:
                break
        return printed

    def test_stamps_that_stand_still_are_named(self):
        for name, (stamp, says) in self.STANDING.items():
            with self.subTest(name):
                publisher = self.publish(GOOD, speed_mps=0.5, stamp=stamp)
                self.assertRegex(self.listen_without_stall(), "wrong\\?   " + says)
                for clock in ("wall", "simulated"):
                    daemon = self.start(poses=f"udp: {{bind: 127.0.0.1:14600}}, clock: {clock}")
                    daemon.wait_for_line("warning pose stream udp .*" + says, PATIENCE_S)
                    self.wait_for_finding(self.inputs_findings, says)
                    self.assertEqual(self.reasons() == [], clock == "wall" or name == "whole seconds")
                    daemon.kill()
                publisher.close()

    def test_an_initial_pose_makes_no_ping_that_waits_for_stamps(self):
        initial = "udp: {bind: 127.0.0.1:14600}, initial: {position_m: [30, 0, -5]}, clock: "
        for clock, ready in (("wall", True), ("simulated", False), ("simulated_lock_step", False)):
            daemon = self.start(poses=initial + clock)
            self.assertEqual(self.reasons() == [], ready, clock)
            daemon.kill()

    def test_a_paused_simulation_is_not_taken_for_stamps_that_are_left_out(self):
        publisher = self.publish(GOOD, speed_mps=0.5, stamp=lambda since_s: round(since_s * 1e9))
        check = Program([os.path.join(PROGRAMS, "sonard"), "check", "--no-network", "--listen", "5",
                         self.config(poses="udp: {bind: 127.0.0.1:14600}, clock: simulated")], "check")
        self.addCleanup(check.kill)
        check.wait_for_line("listening for", PATIENCE_S)
        time.sleep(1)
        publisher.speed_mps, publisher.stamp = 0.0, lambda since_s: 10**10
        self.assertEqual(check.wait(PATIENCE_S), 0, check.tail())
        self.assertNotRegex(check.output(), "stamps")

    def test_stamps_that_never_moved_are_named_though_the_vehicle_is_at_rest(self):
        self.publish(GOOD, stamp=lambda since_s: 0)
        self.assertRegex(self.check("--listen", "3", self.config()),
                         "wrong\\?   The stamps have not changed since the first pose: is time_ns missing\\?")
        says = "The stamps have not changed since the first pose, so the heads do not ping \\(poses.clock\\)"
        source = self.config(poses="udp: {bind: 127.0.0.1:14600}, clock: simulated")
        self.assertRegex(self.check("--listen", "3", source), "wrong\\?   " + says)

    BLACK = {  # start pose in bed_and_wall.sdf, acoustics of the head, what is said
        "under the bed": ("[30, 0, -24]", "", "The sonar is 4 m below the body 'bed', and nothing is below the sonar"),
        "inside of a wall": ("[0, 40, -15]", "", "The sonar is inside the body 'wall'"),
        "turned away": ("[30, 0, -17], rpy_deg: [0, -60, 0]", "",
                        "Nothing is in the fan; the nearest body, 'bed', is 3 m away, .* and 30 degrees below the axis"),
        "below the noise": ("[30, 0, -17]", "{physical: {noise_level_db: -50}}",
                            "No echo stands out: the strongest one is \\d+ dB below the noise .* The nearest body, 'bed', is 3 m"),
        "below the least step": ("[30, 0, -17]", "{physical: {noise: false, gain_db: -90}}",
                                 "No echo stands out: the strongest one is 100 dB or more below"),
    }

    def test_each_black_picture_has_its_reason(self):
        for name, (pose, acoustics, says) in self.BLACK.items():
            with self.subTest(name):
                config = {"poses": f"initial: {{position_m: {pose}}}", "world": "bed_and_wall.sdf",
                          "head": f"    acoustics: {acoustics}\n" if acoustics else ""}
                self.assertRegex(self.check(self.config(**config)), "warning: .*poses.initial: head 'bow': " + says)
                daemon = self.start(**config)
                daemon.wait_for_line("warning head=bow: " + says, PATIENCE_S)
                self.wait_for_finding(lambda status: status["heads"][0]["findings"], says)
                daemon.kill()

    def test_a_good_start_says_what_is_seen_of_the_bed(self):
        """5 m above it, 30 degrees down, a beam of 20 degrees: 5 / sin 40 = 7.78 m to 5 / sin 20 = 14.6 m."""
        printed = self.check(self.config(poses="initial: {position_m: [30, 0, -15]}", world="bed_and_wall.sdf",
                                         head="    mount: {rpy_deg: [0, 30, 0]}\n"))
        self.assertIn("looks    bow: forward and 30 degrees down; the bed below ('bed') is visible from 7.78 to 14.6 m\n", printed)
        self.assertNotIn("warning", printed)

    def test_a_mount_in_radians_is_named_and_shows_where_it_looks(self):
        printed = self.check(self.config(poses="initial: {position_m: [30, 0, -15]}", world="bed_and_wall.sdf",
                                         head="    mount: {rpy_deg: [0, 1.57, 0], position_m: [150, 0, -30]}\n"))
        self.assertIn("heads[0].mount.rpy_deg: 0, 1.57, 0 look like radians", printed)
        self.assertIn("heads[0].mount.position_m: puts the sonar 153 m from the origin of the vehicle", printed)
        self.assertIn("looks    bow: forward and 2 degrees down;", printed)

    def test_a_clock_that_runs_backwards_is_named(self):
        daemon = self.start()
        publisher = self.publish(GOOD)
        daemon.wait_for_line("[1-9][0-9]* pings|connected", PATIENCE_S)
        time.sleep(1)
        publisher.back_s = 100.0
        says = "The publisher's clock went back 1 time:"
        daemon.wait_for_line(says, PATIENCE_S)
        self.wait_for_finding(self.inputs_findings, says)


def main():
    global PROGRAMS, POSE_PB2
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard and sonarview")
    parser.add_argument("--modules", required=True, help="folder with pose_pb2.py")
    options, rest = parser.parse_known_args()
    PROGRAMS = os.path.abspath(options.programs)
    sys.path.insert(0, options.modules)
    import pose_pb2
    POSE_PB2 = pose_pb2
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
