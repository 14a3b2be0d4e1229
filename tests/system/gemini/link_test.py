#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon and its clients as separate processes on separate machines (network namespaces on one wire).

    link_test.py --programs DIR [--replay] [TestCase.test_name ...]

With --replay the heads play back logs written here, and the received pings are compared with those.
"""

import argparse
import csv
import math
import os
import re
import signal
import sys
import tempfile
import time
import types
import unittest

sys.path.append(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "support"))
import glf_writer
import wire
from lab import (COMMAND_PORT, HEAD_ADDRESS, REPORT_PORT, SECOND_HEAD_ADDRESS, SECOND_CLIENT_ADDRESS, CLIENT_ADDRESS, Deadline,
                 Lab, need, receive)

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
PROGRAMS = None  # folder of the programs under test
REPLAY = False  # heads play back logs instead of rendering

# Long time-outs, because the machine may be busy with other tests.
START_S = 60
PATIENCE_S = 60

HEAD = """
  - name: {name}
    type: gemini_720i
    sonar_id: {sonar_id}
    network:
      alternate_address: {address}
      netmask: 255.255.255.0
      bind: {bind}
      allow: [10.61.19.0/24]
    timing:
      min_ping_period_ms: 10
      # A head does not wait long for a client that asks for lines again (protocol/gemini/README.md 7.3); these do, because
      # here the client may share a busy processor, and a late request is not what these tests are about.
      retry_hold_ms: 100
      retry_hold_max_ms: 5000
    acoustics:
      seed: {sonar_id}
      azimuth_pattern: ideal    # a beam without an echo hears nothing
      pulse: point
      physical:
        speckle: {speckle}
        noise: {noise}
        water_clutter: {{density_per_m3: 0}}
    dump:
      directory: {dump}
{more}"""

DAEMON = """
world:
  file: {world}
poses:
  initial:
    position_m: [0, 0, 0]
  udp:
    bind: 127.0.0.1:14600
  extrapolation_limit_ms: 300
  stale: {stale}
sampling:
  preset: grid
  views: 3
  columns_per_view: 64
  rows: 32
heads:
{heads}
"""


def key_values(line):
    return dict(item.split("=", 1) for item in line.split() if "=" in item)


class LinkTest(unittest.TestCase):
    def setUp(self):
        need("ip")
        self.folder = tempfile.TemporaryDirectory(prefix="sonard-link-")
        self.addCleanup(self.folder.cleanup)

    # ---- Set-up ----

    def make_lab(self, clients=1):
        lab = Lab(clients)
        lab.__enter__()
        self.addCleanup(lab.__exit__)
        return lab

    def head_config(self, name="bow", sonar_id=513, address=HEAD_ADDRESS, bind=None, noisy=True, more=""):
        return HEAD.format(name=name, sonar_id=sonar_id, address=address, bind=bind or address,
                           speckle="per_ping" if noisy else "off", noise="true" if noisy else "false",
                           dump=self.folder.name, more=more)

    def start_daemon(self, lab, *heads, stale="hold"):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(DAEMON.format(world=WORLD, stale=stale, heads="".join(heads)))
        command = ["replay", self.write_log(heads), "--config", path, "--as-fast-as-asked", "--loop"] if REPLAY else ["run", path]
        daemon = lab.start(lab.head, os.path.join(PROGRAMS, "sonard"), *command)
        daemon.wait_for_line(r"sonard ready heads=%d " % len(heads), START_S)
        return daemon

    def write_log(self, heads):
        """A log for heads of these configurations, with images of the shape that start_viewer() requests."""
        names = [re.search(r"name: (\S+)", head).group(1) for head in heads]
        ids = [int(re.search(r"sonar_id: (\d+)", head).group(1)) for head in heads]
        self.recorded = {name: glf_writer.noise(250, 482, sonar_id) for name, sonar_id in zip(names, ids)}
        path = os.path.join(self.folder.name, "log.glf")
        glf_writer.write_glf(path, [image for images in self.recorded.values() for image in images])
        return path

    def check_recorded(self, crcs, name):
        """The received pings are in the log, in this order. A request that the link doubled makes one more ping than the
        client counts, so a few pings may lie between."""
        written = 2 * [f"{image.crc32():08x}" for image in self.recorded[name]]
        at = 0
        for crc in crcs:
            self.assertIn(crc, written[at:])
            at = written.index(crc, at) + 1

    def start_viewer(self, lab, *options, client=None, range_m=4):
        """A viewer that finds its own address towards the head. Other jobs of a busy machine do not make it late."""
        return lab.start(client or lab.client, "nice", "-n", "-15", os.path.join(PROGRAMS, "sonarview"),
                         "--log-pings", "--wait", str(PATIENCE_S), "--ping-wait", str(PATIENCE_S), "--range", str(range_m), *options)

    # ---- Checks ----

    def rendered(self, name="bow"):
        """CRC-32 of every ping as the renderer returned it, by its transmit time."""
        with open(os.path.join(self.folder.name, name + ".csv"), encoding="utf-8") as file:
            return {int(row["transmit_us"]): row["crc32"] for row in csv.DictReader(file)}

    def check_pings(self, viewer, count, name="bow"):
        """All pings are complete and bit-identical to the rendered ones. Returns the viewer's summary."""
        logged = [key_values(line) for line in viewer.lines if line.startswith("ping ")]
        self.assertEqual(len(logged), count)
        rendered = self.rendered(name)
        for ping in logged:
            self.assertEqual(ping["lines_lost"], "0", ping)
            self.assertEqual(ping["crc32"], rendered.get(int(ping["transmit_us"])), ping)
        self.assertEqual(len({ping["transmit_us"] for ping in logged}), count, "the same ping was counted twice")
        if REPLAY:
            self.check_recorded([ping["crc32"] for ping in logged], name)
        summary = key_values([line for line in viewer.lines if line.startswith("summary ")][-1])
        self.assertEqual(summary["pings_complete"], str(count))
        self.assertEqual(summary["pings_incomplete"], "0")
        self.assertEqual(summary["lines_missing"], "0")
        return summary

    def end_daemon(self, daemon):
        code, seconds = daemon.terminate(10)
        self.assertEqual(code, 0, daemon.tail())
        return seconds

    def run_pings(self, viewer_options=(), more_config="", count=200):
        lab = self.make_lab()
        daemon = self.start_daemon(lab, self.head_config(more=more_config))
        viewer = self.start_viewer(lab, "--pings", str(count), *viewer_options)
        self.assertEqual(viewer.wait(100), 0, viewer.tail())
        summary = self.check_pings(viewer, count)
        self.end_daemon(daemon)
        return summary


class Pings(LinkTest):
    """200 pings, found by broadcast; every image is complete and bit-identical to the renderer's output."""

    LOSSY = ("--drop-rx", "0.05", "--drop-tx", "0.05", "--seed")

    def test_single(self):
        summary = self.run_pings()
        self.assertEqual(summary["pings_missed"], "0")

    def test_continuous(self):
        summary = self.run_pings(["--continuous", "40"])
        self.assertEqual(summary["pings_missed"], "0")

    def test_single_with_loss_both_ways(self):
        summary = self.run_pings([*self.LOSSY, "1"])
        self.assertGreater(int(summary["dropped_rx"]), 1000)
        self.assertGreater(int(summary["dropped_tx"]), 10)
        self.assertEqual(summary["pings_abandoned"], "0")

    def test_continuous_with_loss_both_ways(self):
        # A ping must be repaired before the next one begins, and a busy machine takes long to answer.
        summary = self.run_pings([*self.LOSSY, "2", "--continuous", "200"])
        self.assertGreater(int(summary["dropped_rx"]), 1000)
        self.assertEqual(summary["pings_missed"], "0")

    def test_single_over_a_link_with_every_fault(self):
        self.run_pings(count=100, more_config="""    link:
      seed: 11
      to_client: {loss: 0.03, duplicate: 0.02, reorder: 0.02, delay_ms: 3, jitter_ms: 1}
      from_client: {loss: 0.05, duplicate: 0.05, reorder: 0.05, delay_ms: 3, jitter_ms: 2}
""")

    def test_compressed_run_length_coded_16_bit(self):
        for options in (["--compression", "2"], ["--bits", "16"]):
            with self.subTest(options=options):
                self.run_pings(options, count=20)


class Clients(LinkTest):
    """Clients that connect, leave, become silent and share the wire."""

    def test_killed_in_the_middle_of_a_ping_and_started_again(self):
        lab = self.make_lab()
        daemon = self.start_daemon(lab, self.head_config())
        for life in range(3):
            viewer = self.start_viewer(lab, "--compression", "0", "--continuous", "50", range_m=50)
            viewer.wait_for_line("^ping ", PATIENCE_S, count=1 + life)
            time.sleep(0.01 + 0.02 * life)  # a ping of 6028 lines takes 0.16 s on the wire
            viewer.signal(signal.SIGKILL)
            viewer.wait(10)
        viewer = self.start_viewer(lab, "--pings", "20")
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        self.check_pings(viewer, 20)
        self.end_daemon(daemon)

    def test_two_heads_at_once_for_two_clients(self):
        lab = self.make_lab(clients=2)
        daemon = self.start_daemon(lab, self.head_config(),
                                   self.head_config("stern", 514, SECOND_HEAD_ADDRESS))
        viewers = [self.start_viewer(lab, "--sonar-id", str(513 + i), "--pings", "60", client=client)
                   for i, client in enumerate(lab.clients)]
        for viewer, name in zip(viewers, ("bow", "stern")):
            self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
            self.check_pings(viewer, 60, name)
        self.assertFalse(set(self.rendered("bow").values()) & set(self.rendered("stern").values()),
                         "two heads with different seeds made the same image")
        self.end_daemon(daemon)

    def test_two_heads_at_once_for_one_client(self):
        lab = self.make_lab()
        daemon = self.start_daemon(lab, self.head_config(),
                                   self.head_config("stern", 514, SECOND_HEAD_ADDRESS))
        out = os.path.join(self.folder.name, "pictures")
        viewer = self.start_viewer(lab, "--sonar-id", "513,514", "--pings", "30", "--out", out)
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        for sonar_id, name in (("513", "bow"), ("514", "stern")):
            its_lines = [line for line in viewer.lines if line.endswith(f"sonar_id={sonar_id}")]
            self.check_pings(types.SimpleNamespace(lines=its_lines, tail=viewer.tail), 30, name)
            self.assertTrue(os.path.exists(os.path.join(out, sonar_id, "fan-last.png")))
        self.end_daemon(daemon)

    def test_a_head_that_is_not_there_is_told_with_those_that_are(self):
        lab = self.make_lab()
        daemon = self.start_daemon(lab, self.head_config(), self.head_config("stern", 514, SECOND_HEAD_ADDRESS))
        viewer = lab.start(lab.client, os.path.join(PROGRAMS, "sonarview"), "--sonar-id", "600", "--wait", "4", "--pings", "1")
        self.assertEqual(viewer.wait(PATIENCE_S), 3, viewer.tail())
        self.assertIn(f"no status of head 600 on port 52900 within 4.0 s: only head 513 at {HEAD_ADDRESS}, head 514 "
                      f"at {SECOND_HEAD_ADDRESS} sent a status (to view one, use --sonar-id 513)", viewer.output())
        self.end_daemon(daemon)

    def test_a_wrong_address_is_told_with_the_address_in_the_status(self):
        lab = self.make_lab()
        daemon = self.start_daemon(lab, self.head_config())
        viewer = lab.start(lab.client, os.path.join(PROGRAMS, "sonarview"), "--head", HEAD_ADDRESS.rpartition(".")[0] + ".250",
                           "--ping-wait", "2", "--pings", "1")
        self.assertEqual(viewer.wait(PATIENCE_S), 4, viewer.tail())
        self.assertIn(f"Its status gives the address {HEAD_ADDRESS} (to use it, omit --head)", viewer.output())
        self.end_daemon(daemon)

    def test_daemon_ends_within_a_second_while_it_pings(self):
        lab = self.make_lab()
        daemon = self.start_daemon(lab, self.head_config())
        viewer = self.start_viewer(lab, "--continuous", "20")
        viewer.wait_for_line("^ping ", PATIENCE_S, count=5)
        seconds = self.end_daemon(daemon)
        self.assertLess(seconds, 1.0)
        self.assertIn("head=bow: ended pings_sent=", daemon.output())


class RawClient:
    """A client of two sockets, with bytes from the document."""

    def __init__(self, lab, sonar_id=513, head=HEAD_ADDRESS, client=0):
        self.sonar_id = sonar_id
        self.head = head
        self.reports = lab.clients[client].udp_socket("0.0.0.0", REPORT_PORT)
        address = [CLIENT_ADDRESS, SECOND_CLIENT_ADDRESS][client]
        self.commands = lab.clients[client].udp_socket(address, COMMAND_PORT)

    def close(self):
        self.reports.close()
        self.commands.close()

    def send(self, message, to=None):
        self.commands.sendto(message, (to or self.head, COMMAND_PORT))

    def next_of(self, message_type, seconds=PATIENCE_S):
        """The next datagram of this type and its sender; None after the time-out."""
        deadline = Deadline(seconds)
        while not deadline.over():
            got = receive(self.reports, deadline.left())
            if got and wire.message_type(got[0]) == message_type:
                return got
        return None

    def next_ping(self, seconds=PATIENCE_S):
        """The next complete ping; times out if the socket lost lines."""
        deadline = Deadline(seconds)
        ping = None
        while not deadline.over():
            got = receive(self.reports, deadline.left())
            if not got:
                continue
            if wire.message_type(got[0]) == wire.PING_HEAD:
                ping = wire.Ping(got[0])
            elif ping:
                ping.add(got[0])
                if ping.complete():
                    return ping
        raise AssertionError(f"no complete ping within {seconds} s")

    def drain(self):
        while receive(self.reports, 0):
            pass


class Wire(LinkTest):
    """The view of another maker's client: bytes and timing from the document, without our protocol code."""

    def start(self, *heads, **keywords):
        lab = self.make_lab()
        daemon = self.start_daemon(lab, *heads, **keywords)
        client = RawClient(lab)
        self.addCleanup(client.close)
        return lab, daemon, client

    def test_status_is_broadcast_once_a_second(self):
        _, _, client = self.start(self.head_config())
        arrivals = []
        for _ in range(4):
            datagram, sender = client.next_of(wire.STATUS)
            arrivals.append(time.monotonic())
            status = wire.Status(datagram)
            self.assertEqual(sender, (HEAD_ADDRESS, COMMAND_PORT))
            self.assertEqual((status.header_id, status.sonar_id), (513, 513))
            self.assertEqual(status.fixed, wire.address("10.61.19.200"))
            self.assertEqual(status.alternate, wire.address(HEAD_ADDRESS))
            self.assertEqual(status.netmask, wire.address("255.255.255.0"))
            self.assertEqual(status.client, 0)
            self.assertNotEqual(status.boot & 0x1FF, 0x001)
        # The first may have waited in the socket's queue.
        self.assertAlmostEqual(arrivals[3] - arrivals[1], 2.0, delta=0.5)

    def test_target_to_port_is_in_the_low_beams(self):
        _, _, client = self.start(self.head_config(noisy=False))
        client.send(wire.ping_config(513, lines=483, spreading=293))
        ping = client.next_ping()
        self.assertEqual((ping.count, ping.beams), (483, 256))
        energy = [sum(ping.lines[i][beam] for i in range(ping.count)) for beam in range(256)]
        self.assertGreater(sum(energy[:128]), 0)
        self.assertEqual(sum(energy[128:]), 0)
        # Sphere of radius 0.5 m at (3, 2) m: bearing -33.69 degrees, half its width asin(0.5 / sqrt(13)) = 7.97.
        seen = [math.degrees(wire.bearing_rad(beam)) for beam in range(256) if energy[beam] > 0]
        self.assertGreater(min(seen), -33.69 - 7.97 - 1.0)
        self.assertLess(max(seen), -33.69 + 7.97 + 1.0)
        middle = min(range(256), key=lambda beam: abs(math.degrees(wire.bearing_rad(beam)) + 33.69))
        first = min(i for i in range(ping.count) if ping.lines[i][middle] > 0)
        self.assertAlmostEqual(first * wire.line_step_m(1500.0), math.sqrt(13) - 0.5, delta=0.05)

    def place_of_target(self, ping):
        """Bearing of the middle of all beams with an echo, degrees to starboard."""
        beams = [beam for beam in range(256) if any(ping.lines[i][beam] for i in range(ping.count))]
        self.assertTrue(beams, "nothing is seen")
        return math.degrees(sum(wire.bearing_rad(beam) for beam in beams) / len(beams))

    def test_poses_move_the_vehicle_and_the_bodies(self):
        lab, _, client = self.start(self.head_config(noisy=False))
        poses = lab.head.udp_socket("127.0.0.1", 0)
        self.addCleanup(poses.close)

        def ping_after(*arguments, **keywords):
            message = wire.pose_update(time.monotonic_ns(), *arguments, **keywords)
            poses.sendto(message, ("127.0.0.1", 14600))
            time.sleep(0.2)  # poses and commands come by different sockets
            client.send(wire.ping_config(513, lines=483, spreading=293))
            return client.next_ping()

        # The sphere is 33.69 degrees to port of the x axis. If the sonar turns 60 degrees to port, it is 26.31 degrees to
        # starboard.
        self.assertAlmostEqual(self.place_of_target(ping_after((0, 0, 0))), -33.69, delta=1.0)
        turned = ping_after((0, 0, 0), yaw_rad=math.radians(60))
        self.assertAlmostEqual(self.place_of_target(turned), 26.31, delta=1.0)
        # The sphere moves to the mirrored place.
        moved = ping_after((0, 0, 0), bodies=[("sphere", (3.0, -2.0, 0.0))])
        self.assertAlmostEqual(self.place_of_target(moved), 33.69, delta=1.0)

    def test_link_slower_than_the_head_loses_nothing(self):
        lab, daemon, client = self.start(self.head_config())
        # 20 Mbit/s for the 80 that the head sends: the queue of the socket fills up, and the head must wait.
        lab.tc(lab.head, "qdisc", "add", "dev", "eth0", "root", "tbf", "rate", "20mbit", "burst", "5kb", "limit", "50mb")
        client.send(wire.ping_config(513, lines=10000))
        ping = client.next_ping()
        self.assertEqual(ping.crc32(), int(self.rendered()[ping.transmit_us], 16))
        self.end_daemon(daemon)
        socket_line = key_values(daemon.wait_for_line("head=bow: transport ", PATIENCE_S))
        self.assertGreater(int(socket_line["blocked"]), 0, "the link was not slow enough for this test to mean something")
        self.assertEqual((socket_line["send_failed"], socket_line["overflowed"]), ("0", "0"))

    def test_silence_for_three_seconds_suspends_and_any_command_resumes(self):
        _, daemon, client = self.start(self.head_config())
        client.send(wire.ping_config(513, lines=64, continuous_ms=100))
        client.next_ping()
        asked = time.monotonic()
        last_ping = asked
        while time.monotonic() - last_ping < 1.5:  # 15 periods without a ping: it has stopped
            self.assertLess(time.monotonic() - asked, 30, "went on pinging without a client")
            if client.next_of(wire.PING_HEAD, seconds=0.2):
                last_ping = time.monotonic()
        # The configuration was the last command: 3 s, plus the delay of a busy machine.
        self.assertGreater(last_ping - asked, 1.5)
        self.assertLess(last_ping - asked, 6.0)
        daemon.wait_for_line(f"client {CLIENT_ADDRESS} lost", PATIENCE_S)
        client.drain()
        self.assertEqual(wire.Status(client.next_of(wire.STATUS)[0]).client, 0)
        client.send(wire.status_request(513))
        self.assertIsNotNone(client.next_of(wire.ACKNOWLEDGE))
        client.next_ping()
        client.drain()
        self.assertEqual(wire.Status(client.next_of(wire.STATUS)[0]).client, wire.address(CLIENT_ADDRESS))

    def test_commands_for_another_id_are_dropped(self):
        _, _, client = self.start(self.head_config())
        client.send(wire.status_request(600))
        client.send(wire.status_request(513))
        self.assertIsNotNone(client.next_of(wire.ACKNOWLEDGE))
        self.assertIsNone(client.next_of(wire.ACKNOWLEDGE, seconds=1.0))

    def test_answers_come_from_the_address_that_was_addressed(self):
        _, _, client = self.start(self.head_config(bind="0.0.0.0"))
        for address in (HEAD_ADDRESS, SECOND_HEAD_ADDRESS):
            client.send(wire.status_request(513), to=address)
            _, sender = client.next_of(wire.ACKNOWLEDGE)
            self.assertEqual(sender, (address, COMMAND_PORT))
        _, sender = client.next_of(wire.STATUS)
        self.assertEqual(sender, (HEAD_ADDRESS, COMMAND_PORT))


class SecondClient(LinkTest):
    """A second client on the wire of a head that serves another (docs/security.md)."""

    def start(self, lock_to_first):
        lab = self.make_lab(clients=2)
        daemon = self.start_daemon(lab, self.head_config(more="    lock_to_first: on\n" if lock_to_first else ""))
        self.first, self.second = (RawClient(lab, client=i) for i in range(2))
        for client in (self.first, self.second):
            self.addCleanup(client.close)
        self.first.send(wire.ping_config(513, lines=64, continuous_ms=100))
        self.first.next_ping()
        return daemon

    def ask_as_both(self, rounds):
        """Both keep requesting the status. Returns the types of the second's messages, except the status."""
        heard = set()
        for _ in range(rounds):
            self.first.send(wire.status_request(513))
            self.second.send(wire.status_request(513))
            self.first.next_ping()
            while got := receive(self.second.reports, 0.0):
                heard.add(wire.message_type(got[0]))
        return heard - {wire.STATUS}

    def test_a_reading_is_answered_and_diverts_no_ping(self):
        self.start(lock_to_first=False)
        self.assertEqual(self.ask_as_both(rounds=20), {wire.ACKNOWLEDGE})

    def test_the_newest_configuration_has_the_head(self):
        self.start(lock_to_first=False)
        self.second.send(wire.ping_config(513, lines=128))
        self.second.next_ping()

    def test_a_locked_head_is_the_firsts_until_it_is_silent(self):
        daemon = self.start(lock_to_first=True)
        self.second.send(wire.ping_config(513, lines=128))
        self.assertEqual(self.ask_as_both(rounds=20), set())
        daemon.wait_for_line(f"client {CLIENT_ADDRESS} lost", PATIENCE_S)  # it says no more
        self.second.send(wire.ping_config(513, lines=128))
        self.second.next_ping()
        self.end_daemon(daemon)
        self.assertRegex(daemon.output(), "head=bow: ended .* locked_out=21 ")


class StalePoses(LinkTest):
    def start(self, stale):
        lab = self.make_lab()
        daemon = self.start_daemon(lab, self.head_config(), stale=stale)
        client = RawClient(lab)
        self.addCleanup(client.close)
        self.poses = lab.head.udp_socket("127.0.0.1", 0)
        self.addCleanup(self.poses.close)
        return daemon, client

    def send_poses(self, client, seconds, x_m):
        """50 poses a second; the client keeps the connection alive."""
        deadline = Deadline(seconds)
        while not deadline.over():
            self.poses.sendto(wire.pose_update(time.monotonic_ns(), (x_m, 0.0, 0.0)), ("127.0.0.1", 14600))
            client.send(wire.status_request(513))
            time.sleep(0.02)

    def pings_within(self, client, seconds):
        """Number of ping heads received, while the client keeps the connection alive."""
        heads, deadline = 0, Deadline(seconds)
        while not deadline.over():
            client.send(wire.status_request(513))
            step = Deadline(0.2)
            while not step.over():
                got = receive(client.reports, step.left())
                heads += 1 if got and wire.message_type(got[0]) == wire.PING_HEAD else 0
        return heads

    def test_hold_goes_on_from_the_last_pose(self):
        _, client = self.start("hold")
        client.send(wire.ping_config(513, lines=64, continuous_ms=100))
        self.send_poses(client, 0.5, 1.0)
        time.sleep(0.5)  # beyond the limit of 300 ms
        client.drain()
        self.assertGreater(self.pings_within(client, 2.0), 3)

    def test_silence_sends_status_only_until_a_pose_arrives(self):
        daemon, client = self.start("silence")
        client.send(wire.ping_config(513, lines=64, continuous_ms=100))
        self.send_poses(client, 0.5, 1.0)
        client.next_ping()
        time.sleep(1.0)
        client.drain()
        self.assertEqual(self.pings_within(client, 1.5), 0)
        self.assertIsNotNone(client.next_of(wire.STATUS))
        self.send_poses(client, 0.3, 2.0)
        client.next_ping()
        daemon.terminate(10)
        self.assertRegex(daemon.output(), r"head=bow: ended .* pings_without_pose=[1-9]")


def main():
    global PROGRAMS, REPLAY
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    parser.add_argument("--replay", action="store_true", help="let the heads play back logs")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    REPLAY = arguments.replay
    PROGRAMS = os.path.abspath(arguments.programs)
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
