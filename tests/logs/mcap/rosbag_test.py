#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A recording of a Gemini and a Micron as a bag of ROS 2 (sonard_client.to_rosbag); check_rosbag.js reads the bag.

    rosbag_test.py --programs DIR --npm DIR [TestCase.test_name ...]
"""

import glob
import json
import math
import os
import subprocess
import sys

import numpy
from recorded import PATIENCE_S, SOURCE, RecordingTest, main

sys.path.insert(0, os.path.join(SOURCE, "clients", "python"))
from sonard_client import read_log  # noqa: E402


class RosBag(RecordingTest):
    def convert(self, log, bag="bag.mcap", *options, code=0):
        """The path of the bag, and the output of the program."""
        path = os.path.join(self.folder.name, bag)
        done = subprocess.run([sys.executable, "-B", "-m", "sonard_client.to_rosbag", log, path, *options], text=True,
                              env={**os.environ, "PYTHONPATH": os.path.join(SOURCE, "clients", "python")}, timeout=PATIENCE_S,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.assertEqual(done.returncode, code, done.stdout)
        return path, done.stdout

    def read(self, bag):
        """Messages by topic, in the order of time."""
        topics = {}
        for line in self.node("check_rosbag.js", bag).splitlines():
            message = json.loads(line)
            topics.setdefault(message["topic"], []).append(message)
        return topics

    def test_every_field_is_that_of_the_log(self):
        log = self.record()
        pings = sorted(read_log(log), key=lambda ping: ping.time_ns)
        bag, text = self.convert(log, "bag.mcap", "--threshold-percent", "20", "--min-range-m", "1.5")
        self.assertEqual(text, f"{bag}: {len(pings)} pings\n")
        topics = self.read(bag)
        self.assertEqual(sorted(topics), ["/bow/points", "/bow/sonar", "/clock", "/stern/points", "/stern/sonar", "/tf"])
        self.assertEqual([message["fields"]["clock"] for message in topics["/clock"]], [stamp(ping) for ping in pings])
        self.assertEqual(len(topics["/tf"]), len(pings))
        for ping, tf in zip(pings, topics["/tf"]):
            self.expect_transforms(ping, tf["fields"]["transforms"])
        for head, beams in (("bow", 256), ("stern", 1)):
            its_pings = [ping for ping in pings if ping.head == head]
            self.assertEqual(len(its_pings), len(topics[f"/{head}/sonar"]))
            for ping, sonar, points in zip(its_pings, topics[f"/{head}/sonar"], topics[f"/{head}/points"]):
                self.assertEqual((sonar["time_ns"], points["time_ns"]), (ping.time_ns, ping.time_ns))
                self.assertEqual(ping.samples.shape[1], beams)
                self.expect_sonar(ping, sonar["fields"])
                self.expect_points(ping, points["fields"])

    def expect_transforms(self, ping, transforms):
        world, beams = transforms
        self.assertEqual(world["header"], {"stamp": stamp(ping), "frame_id": "world"})
        self.assertEqual((world["child_frame_id"], beams["header"]["frame_id"], beams["child_frame_id"]),
                         (ping.head, ping.head, ping.head + "_beams"))
        place, turn = world["transform"]["translation"], world["transform"]["rotation"]
        self.assertEqual([place[axis] for axis in "xyz"], list(ping.sonar_position_m))
        self.assertEqual([turn[axis] for axis in "xyzw"], list(ping.sonar_quaternion_xyzw))

    def expect_sonar(self, ping, said):
        self.assertEqual(said["header"], {"stamp": stamp(ping), "frame_id": ping.head + "_beams"})
        self.assertEqual(bytes(said["image"]["data"]), ping.samples.tobytes())
        self.assertEqual((said["image"]["dtype"], said["image"]["beam_count"]), (0, ping.samples.shape[1]))
        numpy.testing.assert_allclose(said["ranges"], ping.ranges_m, rtol=1e-6)
        directions = said["beam_directions"]
        expected = [(0, -math.sin(bearing_rad), math.cos(bearing_rad)) for bearing_rad in ping.bearings_rad]
        numpy.testing.assert_allclose([[one[axis] for axis in "xyz"] for one in directions], expected, atol=1e-12)
        frequency_hz = {"bow": 723380, "stern": 700000}[ping.head]
        self.assertEqual((said["ping_info"]["frequency"], said["ping_info"]["sound_speed"]), (frequency_hz, 1500))

    def expect_points(self, ping, said):
        rows, beams = numpy.nonzero((ping.samples >= 51) & (ping.ranges_m[:, None] >= 1.5))
        ranges_m, bearings_rad = ping.ranges_m[rows], ping.bearings_rad[beams]
        table = numpy.stack([ranges_m * numpy.cos(bearings_rad), ranges_m * numpy.sin(bearings_rad), 0 * ranges_m,
                             ping.samples[rows, beams]], axis=1)
        self.assertEqual((said["width"], said["point_step"], [field["name"] for field in said["fields"]]),
                         (len(rows), 16, ["x", "y", "z", "intensity"]))
        numpy.testing.assert_allclose(numpy.frombuffer(bytes(said["data"]), "<f4").reshape(-1, 4), table, atol=1e-5)

    def test_a_log_without_poses(self):
        glf, = glob.glob(os.path.join(os.path.dirname(self.record()), "*.glf"))
        topics = self.read(self.convert(glf)[0])
        self.assertEqual(sorted(topics), ["/clock", "/sonar_513/points", "/sonar_513/sonar", "/tf"])
        self.assertEqual([one["child_frame_id"] for one in topics["/tf"][0]["fields"]["transforms"]], ["sonar_513_beams"])

    def test_what_is_refused(self):
        log = os.path.join(self.folder.name, "text")
        with open(log, "w", encoding="utf-8") as file:
            file.write("no log")
        bag, text = self.convert(log, code=2)
        self.assertEqual(text, f"to_rosbag: {log} is not a .mcap, .glf or .dat log\n")
        self.assertFalse(os.path.exists(bag))
        self.assertEqual(self.convert(log, "text", code=2)[1], f"to_rosbag: {log} exists\n")
        self.assertEqual(os.path.getsize(log), 6)


def stamp(ping):
    return {"sec": ping.time_ns // 10**9, "nanosec": ping.time_ns % 10**9}


if __name__ == "__main__":
    main(__doc__)
