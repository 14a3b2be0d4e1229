#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon's image follows poses by Ignition Transport: the test compares ranges of walls whose places are known. The
publishers are a program on the stock library, and its command line tool.

    gazebo_test.py --programs DIR --publisher PROGRAM --tool PROGRAM [TestCase.test_name ...]
"""

import argparse
import os
import subprocess
import sys
import time
import unittest

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path.insert(0, os.path.join(SOURCE, "tests", "system", "gemini"))

import link_test  # noqa: E402
import wire  # noqa: E402
from lab import HEAD_ADDRESS, SECOND_HEAD_ADDRESS, Deadline, need  # noqa: E402

BASIN = os.path.join(SOURCE, "configs", "worlds", "gazebo_basin.sdf")
TWO_WALLS = os.path.join(SOURCE, "tests", "data", "system", "two_walls.sdf")
SHIPPED = os.path.join(SOURCE, "configs", "gazebo.yaml")
TOPIC = "/world/gazebo_basin/dynamic_pose/info"
PUBLISHER = None
TOOL = None

DAEMON = """
world:
  file: {world}
engine: cpu
poses:
  gazebo:
    topic: {topic}
{gazebo_input}
sampling:
  preset: grid
  views: 3
  columns_per_view: 64
  rows: 32
heads:
{head}
"""

# The sonar of the basin is 0.4 m ahead of the vehicle's origin and 0.2 m below it.
BASIN_INPUT = """
    frame: world
    bodies:
      - { entity: crate, body: crate }
"""
FROM_WORLD = """
    mount:
      from_world: gemini
    hides_vehicle: {hides}
"""


class Gazebo(link_test.LinkTest):
    def setUp(self):
        super().setUp()
        self.lab = self.make_lab()
        self.lab.head.ip("link", "set", "lo", "multicast", "on")
        self.lab.head.ip("route", "add", "239.0.0.0/8", "dev", "lo")
        self.publisher = None

    # ---- Set-up ----

    def start(self, world=BASIN, gazebo_input=BASIN_INPUT, more=FROM_WORLD.format(hides="true")):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(DAEMON.format(world=world, topic=TOPIC, gazebo_input=gazebo_input,
                                     head=self.head_config(noisy=False, more=more)))
        self.daemon = self.lab.start(self.lab.head, os.path.join(link_test.PROGRAMS, "sonard"), "run", path)
        self.daemon.wait_for_line(r"sonard ready heads=", link_test.START_S)
        self.client = link_test.RawClient(self.lab)
        self.addCleanup(self.client.close)

    def publish(self, *entities, kind="ignition.msgs.Pose_V"):
        """Publishes until the test ends, or until the next call. An entity is (name, x, y, z, roll, pitch, yaw), in degrees."""
        if self.publisher:
            self.publisher.kill()
        words = [str(word) for entity in entities for word in entity]
        self.publisher = self.lab.start(self.lab.head, PUBLISHER, TOPIC, "200", "1", kind, *words)

    # ---- Checks ----

    def range_ahead(self, sonar_id, address):
        """Range of the first echo in the middle beam, metres. None without an echo, or without a ping (no pose yet)."""
        self.client.send(wire.ping_config(sonar_id, lines=840, spreading=293), address)  # 7 m
        try:
            ping = self.client.next_ping(seconds=2)
        except AssertionError:
            return None
        first = next((i for i in range(ping.count) if ping.lines[i][128] > 0), None)
        return None if first is None else first * wire.line_step_m(1500.0)

    def check_range(self, expected_m, again=lambda: None, head=(513, HEAD_ADDRESS)):
        """The first pings may still show the pose before. `again` is called before each ping."""
        deadline = Deadline(link_test.PATIENCE_S)
        seen = []
        while not deadline.over():
            again()
            seen.append(self.range_ahead(*head))
            # Two lines, plus the footprint of a sample.
            if len(seen) >= 3 and all(range_m and abs(range_m - expected_m) < 0.03 for range_m in seen[-3:]):
                return
        self.fail(f"expected {expected_m} m three times in a row, saw {seen[-8:]}; {self.daemon.tail()}")

    # ---- Cases ----

    def follow(self, kind):
        self.start()
        # Nose to the north, sonar at y = 1.5. If axes were swapped, another wall would be seen, 4.6 m or more away.
        self.publish(("rov", -1, 1.1, -2.3, 0, 0, 90), kind=kind)
        self.check_range(2.5)
        # Nose to the east, rolled, sonar at x = 2.75.
        self.publish(("rov", 2.35, 0.5, -2.5, 20, 0, 0), kind=kind)
        self.check_range(3.25)
        # Nose straight down, sonar at z = -1.
        self.publish(("rov", 0, 0, -0.6, 0, 90, 0), kind=kind)
        self.check_range(4.0)
        self.end_daemon(self.daemon)
        ends = link_test.key_values(self.daemon.wait_for_line(r"pose gazebo .*: ended ", link_test.PATIENCE_S))
        self.assertGreater(int(ends["samples"]), 0)
        self.assertEqual((ends["malformed"], ends["bad_value"]), ("0", "0"), ends)
        in_all = link_test.key_values(self.daemon.wait_for_line(r"pose gazebo .*: in total ", link_test.PATIENCE_S))
        self.assertEqual(in_all["poses"], ends["samples"])

    def test_range_follows_the_pose(self):
        self.follow("ignition.msgs.Pose_V")

    def test_poses_of_newer_package_names(self):
        self.follow("gz.msgs.Pose_V")

    def test_poses_relative_to_parents(self):
        self.start(world=TWO_WALLS, more="", gazebo_input="""
    frame: relative
    vehicle: wrist
    parents: [rov, arm]
""")
        # The vehicle looks north, and its wrist back to starboard: from (1, 1.5) to the wall at x = 6.
        self.publish(("wrist", 0, 0, 0, 0, 0, -90), ("rov", 1, 1, 0, 0, 0, 90), ("arm", 0.5, 0, 0, 0, 0, 0))
        self.check_range(5.0)

    def test_pose_of_the_command_line_tool(self):
        self.start()
        # One publication of the tool may be lost (gazebosim/gz-transport#586), so it publishes again for each ping.
        self.time_s = 0

        def publish_once():
            self.time_s += 1
            pose = (f'header {{ stamp {{ sec: {self.time_s} }} }} pose {{ name: "rov" position {{ x: -1 y: 1.1 z: -2.3 }} '
                    'orientation { w: 0.70710678118654757 z: 0.70710678118654757 } }')
            self.lab.start(self.lab.head, TOOL, "-t", TOPIC, "-m", "ignition.msgs.Pose_V", "-p", pose).wait(30)

        self.check_range(2.5, again=publish_once)

    def test_body_moves(self):
        self.start()
        rov = ("rov", 0, 0, -2.5, 0, 0, 90)
        self.publish(rov, ("crate", 3, 3, -4.75, 0, 0, 0))
        self.check_range(3.6)
        # In front of the sonar, which is at y = 0.4 and z = -2.7: the near face is at y = 1.75.
        self.publish(rov, ("crate", 0, 2, -2.7, 0, 0, 0))
        self.check_range(1.35)
        # Turned by half a right angle, its edge is nearest, half a diagonal before its middle.
        self.publish(rov, ("crate", 0, 2, -2.7, 0, 0, 45))
        self.check_range(1.6 - 0.25 * 2 ** 0.5)
        self.publish(rov, ("crate", 3, 3, -4.75, 0, 0, 0))
        self.check_range(3.6)

    def test_vehicle_is_shown_and_moves_along(self):
        self.start(more=FROM_WORLD.format(hides="false"))
        # The near face of the guard is 1.5 m ahead of the vehicle's origin and 1.1 m ahead of the sonar, at any place.
        self.publish(("rov", -1, 1.1, -2.3, 0, 0, 90))
        self.check_range(1.1)
        self.publish(("rov", 2.35, 0.5, -2.5, 0, 0, 180))
        self.check_range(1.1)

    def test_vehicle_is_hidden_from_one_head_only(self):
        other = self.head_config("stern", 514, SECOND_HEAD_ADDRESS, noisy=False, more=FROM_WORLD.format(hides="false"))
        self.start(more=FROM_WORLD.format(hides="true") + other)
        self.publish(("rov", -1, 1.1, -2.3, 0, 0, 90))
        for _ in range(3):  # by turns: they share a renderer
            self.check_range(2.5)
            self.check_range(1.1, head=(514, SECOND_HEAD_ADDRESS))

    def test_shipped_configuration(self):
        sonard = os.path.join(link_test.PROGRAMS, "sonard")
        self.daemon = self.lab.start(self.lab.head, sonard, "run", SHIPPED)
        self.daemon.wait_for_line(r"sonard ready heads=1 world=gazebo_basin ", link_test.START_S)
        self.publish(("rov", -2, 0, -2.5, 0, 0, 30), ("crate", 1, 1.2, -2.7, 0, 0, 20))
        self.daemon.wait_for_line(r"the vehicle is entity 'rov', first at \(-2.000, 0.000, -2.500\)", link_test.PATIENCE_S)
        view = self.lab.start(self.lab.head, os.path.join(link_test.PROGRAMS, "sonarview"), "--pings", "3", "--quiet",
                              "--log-pings", "--wait", "60", "--ping-wait", "60", "--range", "8", "--out", self.folder.name)
        self.assertEqual(view.wait(100), 0, view.tail())
        self.end_daemon(self.daemon)

    def publish_from_elsewhere(self, relay):
        """Publishes from another machine, which sends discovery to the group, or only to `relay`."""
        return self.lab.start(self.lab.client, "env", f"IGN_RELAY={relay}", PUBLISHER, TOPIC, "200", "1",
                              "ignition.msgs.Pose_V", "rov", "-1", "1.1", "-2.3", "0", "0", "90")

    def test_other_machines_are_not_listened_to(self):
        need("ss")
        self.start()
        sockets = subprocess.run(self.lab.head.command("ss", "-Hltnp"), capture_output=True, text=True, check=True).stdout
        own = [line.split()[3] for line in sockets.splitlines() if f"pid={self.daemon.pid}," in line]
        self.assertGreaterEqual(len(own), 3, sockets)
        self.assertEqual([address for address in own if not address.startswith("127.")], [])
        elsewhere = self.publish_from_elsewhere(relay=HEAD_ADDRESS)  # nothing routes the group to the head yet
        time.sleep(4)  # discovery takes less than two
        elsewhere.kill()
        # To the multicast group, which a simulator on this machine joins on all interfaces unless IGN_IP sets an address.
        self.lab.client.ip("route", "add", "239.0.0.0/8", "dev", "eth0")
        self.lab.start(self.lab.head, PUBLISHER, "/bystander", "200", "1", "ignition.msgs.Pose_V", "rov", *["0"] * 6)
        self.publish_from_elsewhere(relay="")
        time.sleep(4)
        self.assertNotIn("the vehicle is entity", self.daemon.output())
        # A simulator on this machine.
        self.publish(("rov", 2, 0, -2.5, 0, 0, 0))
        self.daemon.wait_for_line(r"first at \(2.000, 0.000, -2.500\)", link_test.PATIENCE_S)

    def test_other_machines_are_listened_to_at_an_address(self):
        self.start(gazebo_input=BASIN_INPUT + f"    address: {HEAD_ADDRESS}\n")
        self.publish_from_elsewhere(relay=HEAD_ADDRESS)
        self.daemon.wait_for_line(r"first at \(-1.000, 1.100, -2.300\)", link_test.PATIENCE_S)

    def test_check_tells_what_arrives(self):
        sonard = os.path.join(link_test.PROGRAMS, "sonard")

        def check():
            return self.lab.start(self.lab.head, sonard, "check", "--listen", "3", SHIPPED)

        silent = check()
        self.assertEqual(silent.wait(60), 2, silent.tail())
        silent.wait_for_line("no pose of the vehicle: nothing arrived: is the simulator running", 1)
        self.publish(("submarine", 1, 2, -3, 0, 0, 90), ("crate", 0, 0, 0, 0, 0, 0))
        other = check()
        self.assertEqual(other.wait(60), 2, other.tail())
        other.wait_for_line("names    crate, submarine$", 1)
        other.wait_for_line("entity 'rov' is not in it", 1)
        self.publish(("rov", 1, 2, -3, 0, 0, 90), ("crate", 0, 0, 0, 0, 0, 0))
        good = check()
        self.assertEqual(good.wait(60), 0, good.tail())
        good.wait_for_line(r"vehicle  last at \(1.000, 2.000, -3.000\) m .*yaw 90.0", 1)
        good.wait_for_line("bodies   crate", 1)
        good.wait_for_line("left out: lights .1.: sun", 1)


def main():
    global PUBLISHER, TOOL
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    parser.add_argument("--publisher", required=True, help="the program gazebo_publisher")
    parser.add_argument("--tool", required=True, help="ign-transport-topic")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    link_test.PROGRAMS = os.path.abspath(arguments.programs)
    PUBLISHER = os.path.abspath(arguments.publisher)
    TOOL = arguments.tool
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
