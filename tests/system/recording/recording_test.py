#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the daemon's logs with the data that its clients received, with readers that share no code with the daemon.

    recording_test.py --programs DIR --npm DIR --slow-disk FILE [--kills N] [--seconds N] [TestCase.test_name ...]
"""

import argparse
import collections
import csv
import glob
import json
import math
import os
import random
import signal
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib

HERE = os.path.abspath(os.path.dirname(__file__))
SOURCE = os.path.join(HERE, "..", "..", "..")
sys.path[:0] = [os.path.join(HERE, "..", "gemini"), os.path.join(SOURCE, "tests", "support")]
import glf_reader  # noqa: E402
import pcapng_reader  # noqa: E402
import wire  # noqa: E402
from lab import HEAD_ADDRESS, REPORT_PORT, CLIENT_ADDRESS, Lab, need  # noqa: E402

WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
DISSECTORS = os.path.join(SOURCE, "clients", "wireshark")
PROGRAMS = None
NPM = None
SLOW_DISK = None
KILLS = 50
SECONDS = 10
# Data that a client received this long ago has left the recorder's queue even on a busy machine (docs/logs.md 5). A few
# milliseconds are usual.
QUEUE_S = 0.5
START_S = 60
PATIENCE_S = 60

CONFIG = """
log: {{level: debug}}
engine: cpu
world: {{file: {world}}}
poses:
  initial: {{position_m: [0, 0, 0]}}
  udp: {{bind: 127.0.0.1:14600}}
sampling: {{preset: grid, views: 3, columns_per_view: 64, rows: 32}}
recording: {{directory: {directory}{recording}}}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    network:
      alternate_address: {head}
      netmask: 255.255.255.0
      bind: {head}
      allow: [10.61.19.0/24]
    timing: {{min_ping_period_ms: 10, retry_hold_ms: 100, retry_hold_max_ms: 5000}}
    acoustics:
      seed: {seed}
      azimuth_pattern: ideal
      pulse: point
      physical: {{speckle: {speckle}, noise: {noise}, water_clutter: {{density_per_m3: 0}}}}
{more}"""

MICRON = """
  - name: stern
    type: micron
    acoustics: {{seed: {seed}}}
    serial:
      tcp: [{{bind: {head}:4001, allow: [10.61.19.0/24]}}]
      pty: [{{link: {folder}/micron}}]
"""


COMPLAINTS = ("_ws.malformed || gemini_sonar.malformed || gemini_sonar.bad_value || gemini_sonar.bad_line || "
              "micron_sonar.malformed || micron_sonar.bad_value || micron_sonar.no_frame")


def key_values(line):
    return dict(item.split("=", 1) for item in line.split() if "=" in item)


def crc_text(data):
    return f"{zlib.crc32(data):08x}"


def rle_decode(data, beams):
    """protocol/gemini/README.md 6.8"""
    out, at = bytearray(), 0
    while at < len(data) and len(out) < beams:
        if data[at] == 0:
            out += bytes(data[at + 1])
            at += 2
        else:
            out.append(0 if data[at] == 1 else data[at])
            at += 1
    return bytes(out[:beams]) + bytes(beams - len(out[:beams]))


class WirePing:
    """A ping from its datagrams, of any width and coding (protocol/gemini/README.md 6)."""

    def __init__(self, head, time_ns):
        self.head = wire.Ping(head)
        self.time_ns = time_ns
        self.eight_bit = bool(self.head.ext_mode & 4)
        self.coded = head[44] >= 3 and self.eight_bit
        self.lines = {}

    def add(self, datagram):
        if datagram[9] == self.head.id & 0xFF:
            line = struct.unpack_from("<H", datagram, 10)[0] & 0x7FFF
            data = datagram[16:]
            self.lines[line] = rle_decode(data, 256) if self.coded else data[:256 if self.eight_bit else 512]

    def complete(self):
        return len(self.lines) == self.head.count

    def samples(self):
        return b"".join(self.lines[i] for i in range(self.head.count))

    def pixels(self):
        return self.samples() if self.eight_bit else self.samples()[::2]  # the high byte comes first


def pings_of(packets):
    """Every complete ping of a capture, in order."""
    pings = []
    for packet in packets:
        if packet.protocol != "udp" or packet.target[1] != REPORT_PORT:
            continue
        kind = wire.message_type(packet.payload)
        if kind == wire.PING_HEAD and not struct.unpack_from("<H", packet.payload, 8)[0] & 0x100:  # not a repetition
            pings.append(WirePing(packet.payload, packet.time_ns))
        elif kind == wire.PING_LINE and pings:
            pings[-1].add(packet.payload)
    return [ping for ping in pings if ping.complete()]


def collect(packets):
    """The head and the lines of every ping, by ping ID, of a capture of less than 256 pings that may have lost, duplicated
    and reordered datagrams."""
    heads, lines = {}, collections.defaultdict(dict)
    for packet in packets:
        kind = wire.message_type(packet.payload)
        if packet.protocol != "udp" or packet.target[1] != REPORT_PORT:
            continue
        if kind == wire.PING_HEAD:
            heads[struct.unpack_from("<H", packet.payload, 8)[0] & 0xFF] = wire.Ping(packet.payload)
        elif kind == wire.PING_LINE:
            number = struct.unpack_from("<H", packet.payload, 10)[0] & 0x7FFF
            data = packet.payload[16:16 + 256]
            assert lines[packet.payload[9]].setdefault(number, data) == data, "one line with two contents"
    return heads, lines


class RecordingTest(unittest.TestCase):
    def setUp(self):
        need("ip")
        self.folder = tempfile.TemporaryDirectory(prefix="sonard-recording-")
        self.addCleanup(self.folder.cleanup)
        self.logs = os.path.join(self.folder.name, "logs")
        self.lab = Lab()
        self.lab.__enter__()
        self.addCleanup(self.lab.__exit__)

    # ---- Set-up ----

    def start_daemon(self, recording="", seed=513, noisy=True, more="", play=None, wrapper=()):
        """Runs the configuration, or replays a log with it."""
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=WORLD, directory=self.logs, recording=recording, head=HEAD_ADDRESS, seed=seed,
                                     speckle="per_ping" if noisy else "off", noise="true" if noisy else "false",
                                     more=more.format(head=HEAD_ADDRESS, folder=self.folder.name,
                                                      seed=seed)))
        task = ["run", path] if play is None else ["replay", play, "--config", path]
        daemon = self.lab.start(self.lab.head, *wrapper, os.path.join(PROGRAMS, "sonard"), *task)
        daemon.wait_for_line("sonard ready", START_S)
        return daemon

    def start_viewer(self, *options, range_m=4):
        return self.lab.start(self.lab.client, os.path.join(PROGRAMS, "sonarview"), "--client-address", CLIENT_ADDRESS,
                              "--head", HEAD_ADDRESS, "--log-pings", "--quiet", "--wait", str(PATIENCE_S), "--ping-wait",
                              str(PATIENCE_S), "--range", str(range_m), *options)

    def start_scan(self, raw, *options, way=None):
        """A client of the Micron; writes its received lines to a file."""
        way = way or ["--tcp", f"{HEAD_ADDRESS}:4001"]
        where = self.lab.client if way[0] == "--tcp" else self.lab.head
        return self.lab.start(where, os.path.join(PROGRAMS, "sonarview"), "micron", *way, "--raw", raw, "--quiet", "--wait",
                              "30", *options)

    def scanned(self, raw):
        """The lines that the client received."""
        with open(raw, encoding="utf-8") as file:
            return [json.loads(text) for text in file]

    def end_daemon(self, daemon):
        code, _ = daemon.terminate(30)
        self.assertEqual(code, 0, daemon.tail())

    def received(self, viewer):
        """The complete pings in the client's log."""
        pings = [key_values(line) for line in viewer.output().splitlines() if line.startswith("ping ")]
        return [ping for ping in pings if ping["lines_lost"] == "0" and "crc32" in ping]

    # ---- The logs ----

    def files(self, suffix):
        return sorted(glob.glob(os.path.join(self.logs, "*" + suffix)))

    def check_folder(self):
        """All files are closed, and there are no other files."""
        for name in os.listdir(self.logs):
            self.assertRegex(name, r"^log_\d{4}-\d\d-\d\d-\d{6}(_bow)?(-\d+)?\.(glf|mcap|pcapng)$")

    def glf_images(self):
        images = []
        for path in self.files(".glf"):
            subprocess.run(["unzip", "-tqq", path], check=True, capture_output=True)
            images += glf_reader.read(path).images
        return images

    def mcap_files(self):
        """The messages of each file."""
        output = subprocess.run(["node", "--max-old-space-size=1500", "read_mcap.js", *self.files(".mcap")], cwd=NPM,
                                check=True, capture_output=True).stdout
        return [file["messages"] for file in json.loads(output)]

    def mcap_messages(self):
        """The messages of all files, by kind."""
        by_kind = collections.defaultdict(list)
        for message in sum(self.mcap_files(), []):
            by_kind[message["kind"]].append(message)
        return by_kind

    def frames_with(self, condition):
        """Numbers of the frames that match in tshark."""
        scripts = [f"-Xlua_script:{os.path.join(DISSECTORS, name)}" for name in ("sonard_gemini.lua", "sonard_micron.lua")]
        # From 4.4 on, Wireshark runs no scripts for root.
        as_nobody = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"] if os.geteuid() == 0 else []
        with open(self.files(".pcapng")[0], "rb") as log:
            done = subprocess.run([*as_nobody, "tshark", *scripts, "-r", "-", "-Y", condition, "-T", "fields", "-e",
                                   "frame.number"], stdin=log, capture_output=True, text=True, timeout=100 + 3 * SECONDS,
                                  env={**os.environ, "HOME": "/nonexistent"})
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout.split()

    def packets(self):
        return [packet for path in self.files(".pcapng") for packet in pcapng_reader.read(path)]


class Logs(RecordingTest):
    def check_pings(self, viewer, daemon, count):
        """Every received ping is in every log, once, with its pixels, bearings, times and pose."""
        received = self.received(viewer)
        self.assertEqual(len(received), count)
        images, messages = self.glf_images(), self.mcap_messages()
        captured = pings_of(self.packets())
        self.assertGreaterEqual(len(images), count)
        self.assertEqual(len({crc_text(ping.samples()) for ping in captured}), len(captured))

        by_crc = {crc_text(ping.samples()): ping for ping in captured}
        glf = {image.header.time_s: image for image in images}
        self.assertEqual(len(glf), len(images))
        mcap = {crc["crc32"]: crc for crc in messages["image"]}
        glf_by_crc = {zlib.crc32(image.pixels): image for image in images}
        logged = {int(key_values(line)["transmit_us"]): line for line in daemon.output().splitlines()
                  if " ping number=" in line}
        first = None
        for ping in received:
            self.assertIn(ping["crc32"], by_crc, "not in the capture")
            on_wire = by_crc[ping["crc32"]]
            self.assertEqual(on_wire.head.transmit_us, int(ping["transmit_us"]))
            pixels = on_wire.pixels()
            self.assertIn(zlib.crc32(pixels), glf_by_crc, "not in the .glf")
            self.assertIn(zlib.crc32(pixels), mcap, "not in the MCAP file")
            image, message = glf_by_crc[zlib.crc32(pixels)], mcap[zlib.crc32(pixels)]
            self.assertEqual(image.pixels, pixels)
            self.assertEqual(message["size"], len(pixels))
            self.assertEqual((image.lines, image.beams), (int(ping["lines"]), 256))
            self.assertEqual((message["lines"], message["beams"]), (image.lines, 256))
            self.check_geometry(image, message, on_wire)
            first = first or (int(ping["transmit_us"]), image.header.time_s)
            self.check_times(image, message, on_wire, int(ping["transmit_us"]), first)
            self.check_pose(message, logged[int(ping["transmit_us"])])
        return images, messages

    def check_geometry(self, image, message, on_wire):
        self.assertEqual((image.header.device_id, image.header.node_id, message["device_id"]), (513, 100, 513))
        self.assertEqual(image.range_compression, on_wire.head.compression)
        step_m = wire.line_step_m(1500.0) * (1 << on_wire.head.compression)
        self.assertAlmostEqual(image.metres_per_line * image.lines, step_m * image.lines, delta=0.001)
        self.assertAlmostEqual(message["metres_per_line"], step_m, delta=1e-9)
        self.assertEqual((image.sound_speed_mps, message["sound_speed_mps"], image.gain_percent), (1500, 1500, 50))
        self.assertAlmostEqual(message["gain_percent"], 50, delta=0.5)
        self.assertEqual(image.ping_flags, 0x8000)
        self.assertEqual(len(image.bearings_rad), 256)
        for beam in range(256):  # positive to port in both: minus the wire's
            self.assertAlmostEqual(image.bearings_rad[beam], -wire.bearing_rad(beam), delta=1e-12)
            self.assertAlmostEqual(message["bearings_rad"][beam], -wire.bearing_rad(beam), delta=1e-12)

    def check_times(self, image, message, on_wire, transmit_us, first):
        self.assertEqual(image.transmit_time_s, image.header.time_s)
        unix_ns = int(message["transmit_ns"])
        self.assertEqual(message["publish_time"], message["transmit_ns"])
        self.assertAlmostEqual(image.header.unix_s, unix_ns / 1e9, delta=2e-6)
        self.assertAlmostEqual(image.header.time_s - first[1], (transmit_us - first[0]) / 1e6, delta=3e-6)
        self.assertLess(abs(time.time() - unix_ns / 1e9), 120 + 2 * SECONDS)
        # The head of a ping leaves after the pulse, and its time in the log is when it left.
        self.assertGreaterEqual(on_wire.time_ns, unix_ns)
        self.assertLess(on_wire.time_ns - unix_ns, 2e9)

    def check_pose(self, message, logged):
        """The pose in the daemon's log is the rendered one."""
        position = [float(part) for part in logged.split("position_m=[")[1].split("]")[0].split(", ")]
        for said, rendered in zip(message["sonar"], position):
            self.assertAlmostEqual(said, rendered, delta=0.00051)
        self.assertIsNotNone(message["vehicle"])

    def test_every_ping_is_in_every_log(self):
        daemon = self.start_daemon(recording=", rotate_mib: 8")
        trajectory = os.path.join(self.folder.name, "ahead.csv")
        with open(trajectory, "w", encoding="utf-8") as file:
            file.write("t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n60,2,0,0,0,0,0,1\n")
        caster = self.lab.start(self.lab.head, os.path.join(PROGRAMS, "posecast"), trajectory, "--seconds", "60")
        viewer = self.start_viewer("--pings", "120", "--continuous", "40")
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        caster.kill()
        self.end_daemon(daemon)
        self.check_folder()
        self.assertGreater(len(self.files(".mcap")), 2, "the logs have not been rotated")
        self.assertEqual(len(self.files(".mcap")), len(self.files(".pcapng")))
        _, messages = self.check_pings(viewer, daemon, 120)
        moved = [message["vehicle"] for message in messages["image"]]
        self.assertGreater(math.dist(moved[0], moved[-1]), 0.01, "the vehicle did not move")
        posed = {message["time"]: message["vehicle"] for message in messages["pose"]}
        for image in messages["image"]:
            self.assertEqual(posed[image["transmit_ns"]], image["vehicle"])
        self.assertIn("dropped_images=0 dropped_wire_pieces=0", daemon.output())
        # Both directions have the same bytes in MCAP and capture.
        self.assertEqual(
            [(message["to_client"], message["log_time"], message["crc32"]) for message in messages["wire"]],
            [(packet.target[1] == REPORT_PORT, str(packet.time_ns), zlib.crc32(packet.payload))
             for packet in self.packets()])
        self.assertGreater(sum(not message["to_client"] for message in messages["wire"]), 1)
        for message in messages["wire"]:
            self.assertIn(message["peer"].split(":")[0], (CLIENT_ADDRESS, "255.255.255.255"))

    def test_what_is_compressed_coded_or_of_16_bits(self):
        for number, options in enumerate((["--compression", "2"], ["--rle", "60"], ["--bits", "16"])):
            with self.subTest(options=options):
                self.logs = os.path.join(self.folder.name, f"logs{number}")
                daemon = self.start_daemon()
                viewer = self.start_viewer("--pings", "8", *options)
                self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
                self.end_daemon(daemon)
                self.check_folder()
                self.check_pings(viewer, daemon, 8)

    def test_target_to_port_is_on_the_port_side(self):
        """A sphere of radius 0.5 m at (3, 2) m, x forward and y to port: 33.69 degrees to port, 8 degrees to either side."""
        daemon = self.start_daemon(noisy=False)
        viewer = self.start_viewer("--pings", "2", "--gain", "100")
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        self.end_daemon(daemon)
        image = self.glf_images()[0]
        message = self.mcap_messages()["image"][0]
        lit = [beam for beam in range(256) if any(image.row(line)[beam] for line in range(image.lines))]
        self.assertTrue(lit)
        self.assertEqual(zlib.crc32(image.pixels), message["crc32"])
        for table in (image.bearings_rad, message["bearings_rad"]):
            for beam in lit:
                self.assertAlmostEqual(math.degrees(table[beam]), 33.69, delta=9)

    def test_an_mcap_file_without_wire_bytes_that_is_compressed(self):
        """It has every ping, sonard reads it, and its replay gives a client the same images."""
        daemon = self.start_daemon(recording=", mcap_wire_bytes: false, mcap_compression: zstd")
        viewer = self.start_viewer("--pings", "6")
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        self.end_daemon(daemon)
        path, = self.files(".mcap")
        with open(path, "rb") as file:
            content = file.read()
        self.assertIn(b"zstd", content)
        self.assertNotIn(b"/bow/wire", content)
        said = json.loads(subprocess.run([os.path.join(PROGRAMS, "sonard"), "info", path, "--json"], capture_output=True,
                                         text=True, timeout=60, check=True).stdout)
        self.assertTrue(said["closed"])
        live = [line for line in viewer.output().splitlines() if "crc32=" in line]
        daemon = self.start_daemon(play=path)
        replayed = self.start_viewer("--pings", "6")
        self.assertEqual(replayed.wait(PATIENCE_S), 0, replayed.tail())
        self.end_daemon(daemon)
        again = [line for line in replayed.output().splitlines() if "crc32=" in line]
        checksums = [[line.split("crc32=")[1].split()[0] for line in lines] for lines in (live, again)]
        self.assertEqual(len(checksums[0]), 6)
        self.assertEqual(checksums[0], checksums[1])

    def test_a_micron_on_tcp_and_on_a_terminal(self):
        daemon = self.start_daemon(more=MICRON)
        link = os.path.join(self.folder.name, "micron")
        raw = [os.path.join(self.folder.name, f"raw{i}") for i in range(2)]
        for path, way, options in zip(raw, (None, ["--tty", link]), ([], ["--four-bit"])):
            viewer = self.start_scan(path, "--bins", "300", "--lines", "25", *options, way=way)
            self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        self.end_daemon(daemon)
        messages = self.mcap_messages()
        recorded = {(line["bits"], line["bins"], round(line["bearing_rad"], 6)) for line in messages["line"]}
        for path, bits in zip(raw, (8, 4)):
            lines = self.scanned(path)
            self.assertGreaterEqual(len(lines), 25)
            for line in lines:
                turn = (line["bearing"] - 3200) * math.pi / 3200  # to starboard of ahead, 1/16 gradian
                turn = math.atan2(math.sin(turn), math.cos(turn))
                ways_round = {round(-turn, 6), round(turn, 6)} if abs(abs(turn) - math.pi) < 1e-9 else {round(-turn, 6)}
                bins = line["bins"][:600]  # an odd number of nibbles is filled up
                self.assertTrue(any((bits, bins, bearing) in recorded for bearing in ways_round), line["number"])
        transports = {message["transport"] for message in messages["wire"] if "/stern/" in message["topic"]}
        self.assertEqual(transports, {"TRANSPORT_TCP", "TRANSPORT_SERIAL"})
        # Capture and MCAP file have the same streams.
        for transport, port, server in (("TRANSPORT_TCP", 4001, HEAD_ADDRESS), ("TRANSPORT_SERIAL", 4001, "192.0.2.1")):
            said = "".join(message["data"] for message in messages["wire"]
                           if message["transport"] == transport and message["to_client"])
            stream, expected = b"", None
            for packet in self.packets():
                if packet.protocol == "tcp" and packet.source == (server, port):
                    self.assertIn(expected, (None, packet.sequence))
                    expected = packet.sequence + len(packet.payload) + bool(packet.flags & 3)
                    stream += packet.payload
            self.assertEqual(stream.hex(), said)
            self.assertGreater(len(stream), 25 * 100)

    def test_tshark_finds_nothing_malformed(self):
        need("tshark")
        daemon = self.start_daemon(more=MICRON)
        viewer = self.start_viewer("--pings", "5")
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        scan = self.start_scan(os.path.join(self.folder.name, "raw"), "--lines", "10")
        self.assertEqual(scan.wait(PATIENCE_S), 0, scan.tail())
        self.end_daemon(daemon)
        self.assertEqual(self.frames_with(COMPLAINTS), [])
        self.assertEqual(len(self.frames_with("gemini_sonar.ping_head.end_range")), 5)
        self.assertGreaterEqual(len(self.frames_with("micron_sonar.head_data.bearing")), 10)

    def test_a_run_of_both_heads(self):
        """A run of any length: all received data is in the logs, and every reader accepts them."""
        need("tshark")
        daemon = self.start_daemon(more=MICRON)
        raw = os.path.join(self.folder.name, "raw")
        seconds = ["--seconds", str(SECONDS)]
        viewer = self.start_viewer("--continuous", "40", "--compression", "4", *seconds)
        scan = self.start_scan(raw, "--gain", "100", *seconds)
        for client in (viewer, scan):
            self.assertEqual(client.wait(SECONDS + PATIENCE_S), 0, client.tail())
        self.end_daemon(daemon)
        self.check_folder()
        self.assertIn("dropped_images=0 dropped_wire_pieces=0", daemon.output())
        pings, lines = self.received(viewer), self.scanned(raw)
        self.assertGreater(len(pings), 10 * SECONDS)
        self.assertGreater(len(lines), 5 * SECONDS)
        images, messages = self.check_pings(viewer, daemon, len(pings))
        self.assertEqual(len(images), len(messages["image"]))
        self.assertEqual([line["bins"] for line in messages["line"]][:len(lines)], [line["bins"] for line in lines])
        self.assertEqual(self.frames_with(COMPLAINTS), [])
        print(f"{SECONDS} s: {len(pings)} pings and {len(lines)} lines received; .glf {len(images)} pings, .mcap "
              f"{ {kind: len(said) for kind, said in messages.items()} }, .pcapng {len(self.packets())} packets; bytes "
              f"{ {name.rsplit('.')[-1]: os.path.getsize(os.path.join(self.logs, name)) for name in os.listdir(self.logs)} }")

    def test_two_daemons_do_not_share_a_folder(self):
        self.start_daemon()
        second = self.lab.start(self.lab.client, os.path.join(PROGRAMS, "sonard"), "run",
                                os.path.join(self.folder.name, "sonard.yaml"))
        self.assertEqual(second.wait(START_S), 2, second.tail())
        self.assertRegex(second.output(), r"sonard.yaml:\d+:\d+: recording.directory: another daemon records into ")


class Replays(RecordingTest):
    """A log of both heads is replayed as both heads, and recorded again."""

    SAME = ("bins", "bits", "bearing_rad", "metres_per_bin", "gain_percent", "device_id", "wire_line")
    ON_THE_WIRE = ("bearing", "bins", "range_scale", "control", "sweep", "gain", "ad_span", "ad_low", "ad_interval",
                   "left_limit", "right_limit", "step", "status")

    def record(self, number, scan_options, pings=0, play=None):
        """Serves and records until the clients are done. Returns the daemon, the Micron client's lines, the logs' messages."""
        self.logs = os.path.join(self.folder.name, f"logs{number}")
        raw = os.path.join(self.folder.name, f"raw{number}")
        daemon = self.start_daemon(more=MICRON, play=play)
        viewer = self.start_viewer("--pings", str(pings)) if pings else None
        scan = self.start_scan(raw, *scan_options)
        self.assertEqual(scan.wait(PATIENCE_S), 0, scan.tail())
        if viewer:
            self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        if play:
            self.assertEqual(daemon.wait(PATIENCE_S), 0, daemon.tail())
            self.assertIn("the recording has ended", daemon.output())
        else:
            self.end_daemon(daemon)
        return daemon, self.scanned(raw), self.mcap_messages()

    def check_same(self, first, again):
        lines, played = first["line"], again["line"]
        self.assertEqual([[line[key] for key in self.SAME] for line in played],
                         [[line[key] for key in self.SAME] for line in lines])
        self.assertEqual([image["crc32"] for image in again["image"]], [image["crc32"] for image in first["image"]])
        # On time, except for the delays of a busy machine.
        shifts_ms = sorted((int(now["transmit_ns"]) - int(then["transmit_ns"])) / 1e6 for now, then in zip(played, lines))
        self.assertLess(shifts_ms[len(shifts_ms) // 4] - shifts_ms[0], 10)

    def on_the_wire(self, lines):
        return [[line[key] for key in self.ON_THE_WIRE] for line in lines]

    def test_both_heads_are_played_and_recorded_again(self):
        options = ["--bins", "300", "--sector", "-20", "60", "--gain", "40"]
        _, heard, first = self.record(1, [*options, "--lines", "60"], pings=10)
        count = len(first["line"])
        self.assertGreaterEqual(count, 60)
        daemon, heard_again, again = self.record(2, [*options, "--lines", str(count)], pings=10, play=self.files(".mcap")[0])
        self.check_same(first, again)
        self.assertEqual(self.on_the_wire(heard_again[:len(heard)]), self.on_the_wire(heard))
        self.assertIn(2, {line["sweep"] for line in heard}, "it has not turned back at the right limit")
        self.assertNotIn("head=stern: differs", daemon.output())

    def test_four_bits_for_a_client_with_another_gain(self):
        options = ["--bins", "301", "--four-bit", "--ad-low", "10", "--ad-span", "30"]
        _, heard, first = self.record(1, [*options, "--gain", "40", "--lines", "20"])
        count = len(first["line"])
        daemon, heard_again, again = self.record(2, [*options, "--gain", "60", "--lines", str(count)],
                                                 play=self.files(".mcap")[0])
        self.check_same(first, again)
        self.assertEqual(self.on_the_wire(heard_again[:len(heard)]), self.on_the_wire(heard))
        self.assertEqual(daemon.output().count("head=stern: differs from the recording: gain 48.0 dB requested, 32.0 dB sent"),
                         1, daemon.tail())
        self.assertIn(f"pings that differ from the request: gain={count}", daemon.output())


class Faults(RecordingTest):
    LINK = """    link:
      seed: 7
      to_client: {{loss: 0.02, duplicate: 0.02, reorder: 0.02, delay_ms: 2, jitter_ms: 1}}
      from_client: {{loss: 0.05, duplicate: 0.05, reorder: 0.05, delay_ms: 2, jitter_ms: 1}}
    dump: {{directory: {folder}}}
"""

    def rendered(self):
        """CRC-32 of every ping as the renderer handed it over, by its number."""
        with open(os.path.join(self.folder.name, "bow.csv"), encoding="utf-8") as file:
            return {int(row["number"]): int(row["crc32"], 16) for row in csv.DictReader(file)}

    def test_a_poor_link_and_a_client_that_vanishes_and_comes_back(self):
        daemon = self.start_daemon(more=self.LINK)
        received = []
        vanished = (0.1, 4.0, 0.0)  # the second time for longer than a head waits for its client
        for pause_s in vanished:
            viewer = self.start_viewer("--continuous", "40")
            viewer.wait_for_line("^ping .*lines_lost=0 ", PATIENCE_S, count=15)  # over such a link not every ping is whole
            time.sleep(0.015)  # in the middle of a ping
            viewer.signal(signal.SIGKILL)
            viewer.wait(10)
            time.sleep(pause_s)
            received += [int(ping["crc32"], 16) for ping in self.received(viewer)]
        self.end_daemon(daemon)
        self.check_folder()
        rendered, images, messages = self.rendered(), self.glf_images(), self.mcap_messages()
        head = key_values(next(line for line in daemon.lines if "head=bow: ended " in line))
        recorder = key_values(next(line for line in daemon.lines if "recording: ended" in line))

        # The daemon counts every ping that began; each client left at most one unfinished.
        count = len(messages["image"])
        self.assertEqual(int(recorder["images"]), count)
        self.assertEqual(recorder["dropped_images"], "0")
        self.assertGreaterEqual(count, int(head["pings_sent"]))
        self.assertLessEqual(count, int(head["pings_sent"]) + len(vanished))
        self.assertGreater(int(head["lines_resent"]), 100)
        self.assertEqual(head["client_timeouts"], "1")

        numbers = [int(message["number"]) for message in messages["image"]]
        self.assertLess(numbers[-1], 256)
        self.assertEqual([message["crc32"] for message in messages["image"]], [rendered[number] for number in numbers])
        self.assertEqual([zlib.crc32(image.pixels) for image in images], [rendered[number] for number in numbers])
        self.assertLessEqual(set(received), {rendered[number] for number in numbers})

        heads, lines = collect(self.packets())
        whole = set()
        for number, image in zip(numbers, images):
            for line, data in lines[number].items():
                self.assertEqual(data, image.row(line))
            if len(lines[number]) == image.lines:
                whole.add(rendered[number])
        self.assertLessEqual(set(heads), set(numbers))
        # The link loses one head in twenty. A client that has gone requests no lost head again, and a connected client may lose
        # the repeated head until the next ping begins. So nearly all pings were compared above.
        self.assertGreaterEqual(len(heads), 0.9 * count)
        self.assertLessEqual(set(received), whole)
        self.assertGreaterEqual(len(received), 45)


class Kills(RecordingTest):
    def end_lives(self, live, lives, daemon_options):
        """kill -9 at random times from a seed. The daemon of the next life recovers the logs, and is killed itself, also
        while it recovers and packs. `live` starts a life and waits until there is something to kill. It returns the daemon,
        a client, and a function that returns the client's data."""
        moments = random.Random(20261120)
        seen = []
        for life in range(lives):
            daemon, client, received = live(life)
            life_s = moments.uniform(0.0, 4 * QUEUE_S)
            time.sleep(max(0.0, life_s - QUEUE_S))
            long_before = len(received()) if life_s > QUEUE_S else 0
            time.sleep(min(life_s, QUEUE_S))
            daemon.signal(signal.SIGKILL)
            daemon.wait(10)
            time.sleep(0.01)  # what it sent last arrives
            client.signal(signal.SIGKILL)
            client.wait(10)
            seen.append((received(), long_before))
        self.end_daemon(self.start_daemon(seed=lives + 1, **daemon_options))
        self.check_folder()
        self.assertGreater(sum(long_before for _, long_before in seen), 3 * lives)
        return seen

    def check_kept(self, kind, recorded, seen):
        """A log of this kind holds the beginning of every life, at least up to the data that a client had long before."""
        recorded = set(recorded)
        lost = []
        for life, (pings, long_before) in enumerate(seen):
            kept = [ping in recorded for ping in pings]
            lost.append(kept.count(False))
            self.assertEqual(kept, sorted(kept, reverse=True), f"{kind} of life {life}: one is lost in the middle")
            self.assertGreaterEqual(kept.count(True), long_before, f"{kind} of life {life}, which saw {len(pings)}")
        print(f"{kind}: {len(recorded)}, lost of a life: {collections.Counter(lost)}")

    def test_every_log_opens_and_holds_every_ping_but_those_in_the_queue(self):
        """From before the first ping to about 30 pings later."""
        def live(life):
            viewer = self.start_viewer("--continuous", "15", "--compression", "2")  # hears the first status
            daemon = self.start_daemon(seed=life + 1)  # so that no two lives make one image
            if life % 10 != 9:
                viewer.wait_for_line("^ping ", PATIENCE_S)
            return daemon, viewer, lambda: [ping["crc32"] for ping in self.received(viewer)]

        seen = self.end_lives(live, KILLS, {})
        for kind, recorded in (("glf", [crc_text(image.pixels) for image in self.glf_images()]),
                               ("mcap", [f"{image['crc32']:08x}" for image in self.mcap_messages()["image"]]),
                               ("pcapng", [crc_text(ping.pixels()) for ping in pings_of(self.packets())])):
            self.assertEqual(len(set(recorded)), len(recorded), f"a ping is in {kind} twice")
            self.check_kept(kind, recorded, seen)

    def test_every_log_opens_and_holds_every_line_but_those_in_the_queue(self):
        """From before the first line of a Micron to tens of lines later."""
        def live(life):
            raw = os.path.join(self.folder.name, f"raw{life}")
            daemon = self.start_daemon(seed=life + 1, more=MICRON)
            scan = self.start_scan(raw, "--bins", "200", "--range", "5", "--gain", "100", "--log-lines")
            if life % 10 != 9:
                scan.wait_for_line("^line ", PATIENCE_S)
            return daemon, scan, lambda: [line["bins"] for line in self.scanned(raw)] if os.path.exists(raw) else []

        seen = self.end_lives(live, (KILLS + 1) // 2, {"more": MICRON})  # a head takes two seconds to find its centre
        files = [[message["bins"] for message in messages if message["kind"] == "line"] for messages in self.mcap_files()]
        for life, (lines, long_before) in enumerate(seen):
            self.assertTrue(any(kept[:long_before] == lines[:long_before] for kept in files), f"MCAP file of life {life}")
        self.check_kept("mcap", sum(files, []), seen)
        streams = collections.defaultdict(bytes)
        for packet in self.packets():
            if packet.protocol == "tcp" and packet.source == (HEAD_ADDRESS, 4001):
                streams[packet.target] += packet.payload
        captured = b"".join(streams.values())
        self.check_kept("pcapng", [bins for lines, _ in seen for bins in lines if bytes.fromhex(bins) in captured], seen)


class FullDisk(RecordingTest):
    def mount(self, mebibytes):
        os.makedirs(self.logs, exist_ok=True)
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={mebibytes}m", "tmpfs", self.logs], check=True)
        self.addCleanup(subprocess.run, ["umount", "-l", self.logs], check=False)

    def pings_per_s(self, viewer, seconds):
        before = len(self.received(viewer))
        time.sleep(seconds)
        return (len(self.received(viewer)) - before) / seconds

    def test_neither_stops_nor_slows_serving(self):
        self.mount(64)
        daemon = self.start_daemon(recording=", rotate_min: 0.1")
        viewer = self.start_viewer("--continuous", "50")
        viewer.wait_for_line("^ping ", PATIENCE_S, count=5)
        with_room = self.pings_per_s(viewer, 2)
        deadline = time.monotonic() + 60
        while "recording: cannot" not in daemon.output() and time.monotonic() < deadline:
            time.sleep(0.1)
        self.assertIn("No space left on device", daemon.output())
        without_room = self.pings_per_s(viewer, 2)
        print(f"pings per second: {with_room:.1f} with room, {without_room:.1f} without")
        self.assertGreater(without_room, 0.5 * with_room)  # other jobs change both; waiting for the disk would end the pings
        daemon.wait_for_line("has no space for new logs", 60)
        self.assertEqual(daemon.output().count("has no space for new logs"), 1, "it is said once")
        viewer.signal(signal.SIGINT)
        viewer.wait(10)
        self.assertEqual([ping for ping in self.received(viewer) if ping["lines_lost"] != "0"], [])
        code, _ = daemon.terminate(30)
        self.assertEqual(code, 0, daemon.tail())
        ends = key_values(daemon.wait_for_line("recording: ended", 5))
        self.assertGreater(int(ends["logs_failed"]), 0)
        self.assertGreater(int(ends["images_lost"]), 0)

        # When there is room again, the next daemon finishes the files of this one.
        subprocess.run(["mount", "-o", "remount,size=400m", self.logs], check=True)
        self.end_daemon(self.start_daemon())
        self.check_folder()
        images = {crc_text(image.pixels) for image in self.glf_images()}
        first = [ping["crc32"] for ping in self.received(viewer)[:20]]
        self.assertEqual([crc for crc in first if crc not in images], [])
        self.assertGreater(len(self.mcap_messages()["image"]), 20)
        self.assertGreater(len(pings_of(self.packets())), 20)


class SlowDisk(RecordingTest):
    def end_with_a_disk_of(self, bytes_per_s, deadline_s):
        """@return the daemon, and how long it took to end"""
        # Without this option of ASan, its own library would have to be the first.
        wrapper = ["env", f"LD_PRELOAD={SLOW_DISK}", f"SLOW_DISK_BYTES_PER_S={bytes_per_s}",
                   "ASAN_OPTIONS=verify_asan_link_order=0"]
        daemon = self.start_daemon(f", stop_deadline_s: {deadline_s}", wrapper=wrapper)
        viewer = self.start_viewer("--continuous", "60", range_m=20)
        viewer.wait_for_line("^ping ", PATIENCE_S, count=100)
        code, took_s = daemon.terminate(PATIENCE_S)
        self.assertEqual(code, 0, daemon.tail())
        print(f"SIGTERM with a disk of {bytes_per_s} bytes per second and a deadline of {deadline_s} s: {took_s:.2f} s")
        self.assertLess(took_s, deadline_s + 5.0, "promised: the deadline and 1 s, on a machine that has nothing else to do")
        viewer.kill()
        return daemon

    def test_the_daemon_ends_after_its_deadline_though_the_disk_is_slow(self):
        daemon = self.end_with_a_disk_of(500_000, deadline_s=1)
        self.assertRegex(daemon.output(), r"the disk is too slow to end within stop_deadline_s=1.*, not on the disk: images=[1-9]")
        self.assertNotIn("slow disk: exit()", daemon.output(), "the recorder's thread uses what exit() destroys")
        self.end_daemon(self.start_daemon())
        self.check_folder()

    def test_a_disk_that_is_fast_enough_gets_everything(self):
        # On a busy machine, compression may lag by seconds.
        daemon = self.end_with_a_disk_of(1_000_000_000, deadline_s=PATIENCE_S)
        self.assertNotIn("not on the disk", daemon.output())
        self.assertIn("slow disk: exit()", daemon.output(), "it ends as programs do")


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True)
    parser.add_argument("--npm", required=True, help="folder with read_mcap.js and its node_modules")
    parser.add_argument("--slow-disk", required=True, help="the library of tests/support/slow_disk.cpp")
    parser.add_argument("--kills", type=int, default=KILLS)
    parser.add_argument("--seconds", type=int, default=SECONDS, help="of test_a_run_of_both_heads")
    options, rest = parser.parse_known_args()
    PROGRAMS, NPM, KILLS, SECONDS = os.path.abspath(options.programs), options.npm, options.kills, options.seconds
    SLOW_DISK = os.path.abspath(options.slow_disk)
    unittest.main(argv=[sys.argv[0], *rest])
