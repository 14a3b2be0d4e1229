#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Recorded, shown by `sonard info`, replayed and rendered offline: the same samples in all four ways.

    recording_test.py --programs DIR [Recording.test_name ...]
"""

import glob
import json
import math
import os
import struct
import subprocess

import numpy

import messages
from head import CONFIG, PATIENCE_S, WORLD, Client, HeadCase, main, tcp_client
from messages import LOW, PING
import pcapng_reader  # head says where these are

HEAD = """
  - name: bow
    type: oculus
    network: {address: 127.0.0.3, netmask: 255.0.0.0, status: [127.0.0.1]}
"""
FIRE = messages.fire(mode=LOW, flags=0x49, range_m=5.0, gamma=255, speed=1500.0, version=2, extension=0)
PINGS = 4
# The fields that differ between two pings of one image: numbers and times.
VARYING = (slice(89, 93), slice(153, 161))


def by_number(raws):
    """Messages of version 2. A busy machine makes the client too slow for some of them, which are missing."""
    return {struct.unpack_from("<I", raw, 89)[0]: raw for raw in raws}


def same_but_for_times(raw):
    blank = bytearray(raw)
    for part in VARYING:
        blank[part] = bytes(part.stop - part.start)
    return bytes(blank)


class Recording(HeadCase):
    """A session of one client; all cases read its logs."""

    HEADS = HEAD
    MORE = "recording: {directory: logs}"

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sonard = os.path.join(cls.PROGRAMS, "sonard")
        cls.live = cls.session("127.0.0.3")
        code, _ = cls.daemon.terminate(10)
        assert code == 0, cls.daemon.tail()
        cls.mcap, = glob.glob(os.path.join(cls.folder, "logs", "*.mcap"))
        cls.pcapng, = glob.glob(os.path.join(cls.folder, "logs", "*.pcapng"))

    @classmethod
    def session(cls, address, fire=FIRE):
        """The messages of the first pings."""
        client = Client(tcp_client(cls.client_machine, address))
        try:
            client.write(fire)
            return [client.wait(PING).raw for _ in range(PINGS)]
        finally:
            client.close()

    def info(self, path, *options):
        done = subprocess.run([self.sonard, "info", path, *options], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertNotIn("warning", done.stderr)
        return done.stdout

    # ---- sonard info

    def test_info_says_what_the_head_said(self):
        text = self.info(self.mcap)
        self.assertIn("head     Oculus 7892 'bow': ", text)
        self.assertIn("x 874 range bins of 512 beams, range 5.00 m, sound speed 1500.0 m/s, gain 50 %, 750 kHz\n", text)
        said = json.loads(self.info(self.mcap, "--json"))
        head, = said["heads"]
        self.assertEqual((head["type"], head["name"], head["id"], head["scanning"]), ("oculus", "bow", 7892, False))

    def test_the_capture_holds_the_stream_and_the_statuses(self):
        packets = pcapng_reader.read(self.pcapng)
        self.assertEqual({packet.protocol for packet in packets}, {"udp", "tcp"})
        stream = b"".join(packet.payload for packet in packets if packet.protocol == "tcp" and packet.source[1] == 52100)
        pings = [message.raw for message in messages.Stream().feed(stream) if message.id == PING]
        self.assertEqual(pings[:PINGS], self.live)
        for packet in packets:
            if packet.protocol == "udp":
                messages.status_of(packet.payload)

    # ---- sonard replay

    def replayed(self, *arguments, address):
        player = self.start(self.sonard, "replay", self.mcap, *arguments)
        player.wait_for_line("sonard ready", PATIENCE_S)
        played, live = by_number(self.session(address)), by_number(self.live)
        both = played.keys() & live.keys()
        self.assertGreaterEqual(len(both), 2)
        for number in both:
            self.assertEqual(same_but_for_times(played[number]), same_but_for_times(live[number]))
        self.assertNotIn("differs from the recording", player.output())
        return player

    def test_replay_gives_the_same_pings_where_no_configuration_says_another_place(self):
        player = self.replayed(address="127.0.0.2")
        self.assertNotIn(" warning ", player.output())

    def test_replay_by_a_configuration_gives_what_was_recorded_whatever_is_asked_for(self):
        path = os.path.join(self.folder, "player.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=WORLD, heads=HEAD, more=""))
        self.replayed("--config", path, "--as-fast-as-asked", address="127.0.0.3").terminate(10)
        player = self.start(self.sonard, "replay", self.mcap, "--config", path, "--as-fast-as-asked")
        player.wait_for_line("sonard ready", PATIENCE_S)
        other = self.session("127.0.0.3", messages.fire(flags=0x0F, range_m=2.0, gain=80.0, version=2, extension=0))
        other, live = by_number(other), by_number(self.live)
        self.assertGreaterEqual(len(other.keys() & live.keys()), 2)
        for number in other.keys() & live.keys():
            ping, was = (messages.ping_of(messages.Stream().feed(one)[0]) for one in (other[number], live[number]))
            self.assertEqual((ping.range_m, ping.mode, ping.flags), (2.0, 2, 0x4F), "what it asked for, but for the beams")
            self.assertEqual((ping.ranges, ping.beams, ping.resolution_m), (was.ranges, was.beams, was.resolution_m))
            self.assertEqual([row[1::2] for row in ping.rows], was.rows)
        output = player.output()
        for difference in ("range 2.00 m requested, 5.00 m sent", "256 beams requested, 512 sent",
                           "1200 kHz requested, 750 kHz sent", "gain 80 % requested, 50 % sent"):
            self.assertIn(difference, output)

    # ---- sonard render

    def test_a_rendered_ping_has_the_samples_of_the_served_one(self):
        out = os.path.join(self.folder, "rendered")
        way = os.path.join(self.folder, "way.csv")
        with open(way, "w", encoding="utf-8") as file:
            file.write("t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n0.1,0,0,0,0,0,0,1\n")
        config = os.path.join(self.folder, "sonard.yaml")
        done = subprocess.run([self.sonard, "render", config, "--trajectory", way, "--out", out, "--range", "5", "--size", "64"],
                              capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        samples = numpy.load(os.path.join(out, "ping_000000.npy"))
        with open(os.path.join(out, "ping_000000.json"), encoding="utf-8") as file:
            sidecar = json.load(file)
        self.assertEqual((samples.shape, samples.dtype), ((874, 512), numpy.uint8))
        ping = messages.ping_of(messages.Stream().feed(self.live[0])[0])
        self.assertEqual(b"".join(ping.rows), samples.tobytes())
        self.assertAlmostEqual(sidecar["geometry"]["line_step_m"], ping.resolution_m)
        for bearing_rad, cdeg in zip(sidecar["geometry"]["bearings_rad"], ping.bearings_cdeg, strict=True):
            self.assertAlmostEqual(math.degrees(bearing_rad), -cdeg / 100)


if __name__ == "__main__":
    main()
