#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Recorded, shown by `sonard info`, replayed and rendered offline: the same bytes in all four ways.

    recording_test.py --programs DIR [Recording.test_name ...]
"""

import glob
import json
import math
import os
import subprocess

import numpy

import messages
from head import DEMO, PATIENCE_S, HeadCase, UdpClient, main
from messages import ACK, AUTO_DEVICE_DATA, DEVICE_DATA, DEVICE_INFORMATION, NACK, PROTOCOL_VERSION, AutoTransmit, Transducer
import pcapng_reader  # head says where these are

# The settings of sonarview and `sonard render --range 10 --step 9`.
SETTINGS = dict(gain=1, duration=53, period=444, frequency=740, samples=1200)
ORDERS = [Transducer(angle=angle, **SETTINGS) for angle in range(0, 60, 10)]
SCAN = AutoTransmit(start=60, stop=59, steps=10, **SETTINGS)
SCAN_ANGLES = [*range(60, 400, 10), 0, 10]  # one way: it is more than half a turn
TURN = 40  # pings
WALLS_M = {0: 8.0, 100: 4.5, 200: 6.0, 300: 5.5}  # by angle: the tank is 14 x 10 m, the head at (-1, -0.5) looks east


class Recording(HeadCase):
    """A session of one client with the demo's head; all cases read its logs."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sonard = os.path.join(cls.PROGRAMS, "sonard")
        cls.sent, cls.received = [], []
        cls.live = cls.session(("127.0.0.1", 12345), cls.sent, cls.received)
        code, _ = cls.daemon.terminate(10)
        assert code == 0, cls.daemon.tail()
        cls.mcap, = glob.glob(os.path.join(cls.folder, "logs", "*.mcap"))
        cls.pcapng, = glob.glob(os.path.join(cls.folder, "logs", "*.pcapng"))

    @classmethod
    def demo_with(cls, name, head="", water="", more=""):
        """The demo's configuration, with more keys in its sections."""
        with open(DEMO, encoding="utf-8") as file:
            text = file.read().replace("file: worlds", "file: " + os.path.join(os.path.dirname(DEMO), "worlds"))
        path = os.path.join(cls.folder, name + ".yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace("water:\n", f"water:\n  {water}\n") + f"\n    {head}\n{more}\n")
        return path

    @classmethod
    def configuration(cls):
        return cls.demo_with("recorded", "timing: {scale: 0.1}", more="recording: {directory: logs}")

    @classmethod
    def session(cls, head, sent=None, received=None):
        """One client: greets, pings singly, scans, stops. Returns the frames of all requested pings."""
        class Noting(UdpClient):
            def write(self, data):
                super().write(data)
                if sent is not None:
                    sent.append(data)

            def next(self, seconds=PATIENCE_S):
                got = super().next(seconds)
                if got is not None and received is not None:
                    received.append(got.bytes())
                return got

        client = Noting(cls.machine.udp_socket("127.0.0.1", 0), head)
        cls.addClassCleanup(client.close)
        client.ask(messages.request(PROTOCOL_VERSION), PROTOCOL_VERSION)
        client.ask(messages.request(DEVICE_INFORMATION), DEVICE_INFORMATION)
        client.ask(messages.request(DEVICE_DATA), DEVICE_DATA)
        pings = [client.ask(order.bytes(), DEVICE_DATA, NACK) for order in ORDERS]
        client.write(b"")
        client.write(SCAN.bytes())
        pings += [client.wait(AUTO_DEVICE_DATA, NACK) for _ in SCAN_ANGLES]
        if sent is not None:
            client.ask(messages.MOTOR_OFF_FRAME, ACK)
            client.all_until_quiet()
        return pings

    def info(self, path, *options):
        done = subprocess.run([self.sonard, "info", path, *options], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("warning", done.stderr)
        return done.stdout

    def test_the_session_was_what_was_asked_for(self):
        for got, order in zip(self.live, ORDERS):
            self.assert_ping(got, order)
        for got, angle in zip(self.live[len(ORDERS):], SCAN_ANGLES, strict=True):
            self.assert_ping(got, SCAN, angle)

    def pings_recorded(self):
        """The daemon's count; the scan may have gone on until the stop command arrived."""
        line = self.daemon.wait_for_line("head=ping360: ended ", 1)
        count = int(line.split("pings_sent=")[1].split()[0])
        self.assertGreaterEqual(count, len(self.live))
        return count

    # ---- sonard info

    def test_info_says_what_the_head_said(self):
        count = self.pings_recorded()
        text = self.info(self.mcap)
        self.assertIn(f"head     Ping360 2 'ping360': {count} lines\n", text)
        self.assertIn(f"{count}x 1200 bins, range 9.99 m, sound speed 1500.0 m/s, gain 50 %, 740 kHz\n", text)
        said = json.loads(self.info(self.mcap, "--json"))
        self.assertTrue(said["closed"])
        head, = said["heads"]
        self.assertEqual((head["type"], head["name"], head["id"], head["scanning"]), ("ping360", "ping360", 2, True))

    def test_info_draws_turns(self):
        """Single pings and those of the scan make one turn; the next turn begins when an angle repeats."""
        folder = os.path.join(self.folder, "pictures")
        self.info(self.mcap, "--png", folder)
        self.assertEqual(sorted(os.listdir(folder)), ["ping360_000000.png", "ping360_000001.png"])

    def test_the_capture_holds_the_datagrams_of_both_directions(self):
        packets = pcapng_reader.read(self.pcapng)
        self.assertEqual({(packet.protocol, packet.interface) for packet in packets}, {("udp", "ping360")})
        self.assertEqual([packet.payload for packet in packets if packet.target[1] == 12345], self.sent)
        self.assertEqual([packet.payload for packet in packets if packet.source[1] == 12345], self.received)

    # ---- sonard replay

    def replayed(self, *arguments, head):
        player = self.start(self.sonard, "replay", self.mcap, *arguments)
        player.wait_for_line("sonard ready", PATIENCE_S)
        played = self.session(head)
        self.assertEqual([got.bytes() for got in played], [got.bytes() for got in self.live])
        self.assertNotIn("differs from the recording", player.output())
        return player

    def test_replay_gives_the_same_frames_where_no_configuration_says_another_place(self):
        """At the times of the recording."""
        player = self.replayed(head=("127.0.0.2", 12345))
        self.assertNotIn(" warning ", player.output())
        code, _ = player.terminate(10)
        self.assertEqual(code, 0, player.tail())

    def test_replay_by_a_configuration_ends_with_the_recording(self):
        player = self.replayed("--config", self.demo_with("player"), "--as-fast-as-asked",
                               head=("127.0.0.1", 12345))
        self.assertEqual(player.wait(PATIENCE_S), 0, player.tail())
        self.assertIn("the recording has ended", player.output())

    # ---- sonard render

    def rendered(self, config):
        """Samples by line, and the JSON, of the first turn at the demo's pose."""
        out = os.path.join(self.folder, "rendered-" + os.path.basename(config))
        if not os.path.isdir(out):
            way = os.path.join(self.folder, "way.csv")
            with open(way, "w", encoding="utf-8") as file:
                file.write("t,x,y,z,qx,qy,qz,qw\n0,-1,-0.5,-4,0,0,0,1\n4,-1,-0.5,-4,0,0,0,1\n")
            done = subprocess.run([self.sonard, "render", config, "--trajectory", way, "--out", out, "--range", "10", "--step",
                                   "9", "--size", "64"], capture_output=True, text=True, timeout=120)
            self.assertEqual((done.returncode, done.stdout), (0, f"{out}: 1 frame\n"), done.stderr)
        samples = numpy.load(os.path.join(out, "scan_000000.npy"))
        with open(os.path.join(out, "scan_000000.json"), encoding="utf-8") as file:
            sidecar = json.load(file)
        self.assertEqual((samples.shape, samples.dtype), ((1200, TURN), numpy.uint8))
        self.assertEqual(len(sidecar["geometry"]["bearings_rad"]), TURN)
        return [line.tobytes() for line in samples.T], sidecar

    def check_walls(self, lines, sidecar):
        """The echo of a wall begins at its range, within a sample and the pulse's length; before it there is no echo."""
        step_m = sidecar["geometry"]["line_step_m"]
        pulse_m = 53e-6 * sidecar["geometry"]["sound_speed_mps"] / 2
        for angle, range_m in WALLS_M.items():
            line = lines[angle // 10]
            bearing = sidecar["geometry"]["bearings_rad"][angle // 10]
            self.assertAlmostEqual(math.remainder(bearing + angle * math.pi / 200, 2 * math.pi), 0.0, places=9)
            quiet_to = int((range_m - pulse_m) / step_m) - 1
            first = next(i for i in range(int(1.0 / step_m), len(line)) if line[i] > 50)
            self.assertGreaterEqual(first, quiet_to, f"angle {angle}")
            self.assertAlmostEqual((first + 0.5) * step_m, range_m, delta=step_m + pulse_m, msg=f"angle {angle}")
            strongest = max(line[first:first + 20])
            self.assertGreater(strongest, 128, f"angle {angle}: in the upper half of the scale")

    def test_walls_are_at_their_range(self):
        lines, sidecar = self.rendered(DEMO)
        self.assertEqual((sidecar["type"], sidecar["device_id"], sidecar["settings"]["bins"]), ("ping360", 2, 1200))
        self.assertAlmostEqual(sidecar["geometry"]["line_step_m"], 444 * 25e-9 * 1500 / 2)
        self.check_walls(lines, sidecar)

    def test_walls_are_at_their_range_in_water_of_another_speed(self):
        """Fresh water of 15 degrees has 1466 m/s: a client that assumes 1500 m/s shows walls 2 % too far."""
        lines, sidecar = self.rendered(self.demo_with("computed", water="sound_speed_mps: computed"))
        self.assertAlmostEqual(sidecar["geometry"]["sound_speed_mps"], 1466, delta=1)
        self.assertAlmostEqual(sidecar["geometry"]["line_step_m"], 444 * 25e-9 * 1466 / 2, delta=1e-5)
        self.check_walls(lines, sidecar)

    def test_a_rendered_turn_has_the_bytes_of_the_served_one(self):
        lines, _ = self.rendered(DEMO)
        for number, line in enumerate(lines):
            self.assertEqual(messages.data_of(self.live[number]).data, line, f"ping {number}")


if __name__ == "__main__":
    main()
