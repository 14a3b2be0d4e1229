#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A DVL A50 above the bed of a tank: its ways, the loops of its clients, clients that misbehave, and a wire that loses.

    head_test.py --programs DIR [Dvl.test_name ...]
"""

import glob
import json
import os
import re
import socket
import struct
import subprocess
import sys
import threading
import time

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "tests", "support")]
import head_case  # noqa: E402
from head_case import PATIENCE_S, main  # noqa: E402
from lab import HEAD_ADDRESS, Deadline, Lab  # noqa: E402

PORT = 16171
ALTITUDE_M = 4.0  # of the device above the bed
CONFIG = """
world: {{file: """ + os.path.join(SOURCE, "configs", "worlds", "tank.sdf") + """}}
poses:
  initial: {{position_m: [-1, -0.5, -4]}}
  udp: {{bind: 127.0.0.1:14600}}
{more}
heads:
{heads}
"""


class Client:
    """One connection, whose stream of lines is read as clients do."""

    def __init__(self, machine, address, receive_buffer=None):
        self.connection = machine.tcp_socket()
        if receive_buffer:
            self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.connection.settimeout(PATIENCE_S)
        self.connection.connect((address, PORT))
        self._rest = b""
        self._lines = []

    def say(self, command, **parameters):
        """Without a line end, as several clients do."""
        said = {"command": command, **({"parameters": parameters} if parameters else {})}
        self.connection.sendall(json.dumps(said).encode())

    def next(self):
        """The next message: every line is one object with a type, below 2048 bytes."""
        while not self._lines:
            data = self.connection.recv(4096)
            if not data:
                raise AssertionError("the device has closed the connection")
            *lines, self._rest = (self._rest + data).split(b"\r\n")
            self._lines += lines
        line = self._lines.pop(0)
        if len(line) >= 2048:
            raise AssertionError(f"{len(line)} bytes in a line")
        message = json.loads(line)
        if "type" not in message or "format" not in message:
            raise AssertionError(line)
        return message

    def wait(self, kind):
        while (message := self.next())["type"] != kind:
            pass
        return message

    def ask(self, command, **parameters):
        self.say(command, **parameters)
        response = self.wait("response")
        if response["response_to"] != command:
            raise AssertionError(response)
        return response

    def reports_for(self, seconds):
        """The velocity reports of this time."""
        deadline, reports = Deadline(seconds), []
        while not deadline.over():
            message = self.next()
            reports += [message] if message["type"] == "velocity" else []
        return reports

    def break_off(self):
        """Ends the connection by a reset."""
        self.connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.connection.close()


class HeadCase(head_case.HeadCase):
    CONFIG = CONFIG
    ADDRESS = "127.0.0.1"

    def client(self, **settings):
        client = Client(self.client_machine, self.ADDRESS, **settings)
        self.addCleanup(client.connection.close)
        return client

    def view(self, *arguments):
        """Runs sonarview; returns its reports and its summary as dictionaries."""
        viewer = self.start(os.path.join(self.PROGRAMS, "sonarview"), "dvl_a50", *arguments, "--log-pings", "--quiet",
                            machine=self.client_machine)
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        pairs = [dict(re.findall(r"(\w+)=(\S+)", line)) for line in viewer.output().splitlines()]
        return [pair for pair in pairs if "vx" in pair], pairs[-1]


class Dvl(HeadCase):
    HEADS = """
  - name: dvl
    type: dvl_a50
    tcp: {bind: 127.0.0.1:16171}
    pd6: {bind: 127.0.0.1:1037}
    pd4: {bind: 127.0.0.1:1038}
    http: {bind: 127.0.0.1:80}
    serial: {pty: [{link: FOLDER/tty}]}
    mount: {rpy_deg: [0, 90, 0]}
"""
    MORE = "recording: {directory: FOLDER/logs}"

    def lines_of(self, port, count):
        """The first bytes that a port sends by itself."""
        with self.client_machine.tcp_socket() as connection:
            connection.settimeout(PATIENCE_S)
            connection.connect((self.ADDRESS, port))
            data = b""
            while len(data) < count:
                data += connection.recv(4096)
            return data

    def test_sonarview_shows_the_altitude(self):
        reports, summary = self.view("--tcp", "127.0.0.1:16171", "--pings", "10", "--reset")
        self.assertEqual((len(reports), summary["valid"], summary["unreadable"]), (10, "10", "0"))
        for report in reports:
            self.assertAlmostEqual(float(report["altitude_m"]), ALTITUDE_M, delta=0.03)
            self.assertAlmostEqual(float(report["vx"]), 0.0, delta=0.01)

    def test_pd6_and_pd4_have_the_same_altitude(self):
        lines = self.lines_of(1037, 600).decode().split("\r\n")
        self.assertEqual([line[:3] for line in lines[:10]], [":SA", ":TS", ":WI", ":WS", ":WE", ":WD", ":BI", ":BS", ":BE", ":BD"])
        self.assertAlmostEqual(float(lines[9].split(",")[4]), ALTITUDE_M, delta=0.03)
        packet = self.lines_of(1038, 47)[:47]
        self.assertEqual(packet[:5], bytes.fromhex("7d002d00a3"))
        self.assertEqual(sum(packet[:45]) % 65536, int.from_bytes(packet[45:], "little"))
        for place in range(13, 21, 2):
            self.assertAlmostEqual(int.from_bytes(packet[place:place + 2], "little") / 100, ALTITUDE_M / 0.92388, delta=0.05)

    def test_the_serial_line_speaks_in_sentences(self):
        with open(os.path.join(self.folder, "tty"), "r+b", buffering=0) as line:
            line.write(b"wcp,3\r\n")
            data, deadline = b"", Deadline(PATIENCE_S)
            while not all(kind in data for kind in (b"wra*", b"wrz,", b"wru,3,", b"wrp,")):
                self.assertFalse(deadline.over(), data)
                data += line.read(4096)
        for sentence in data.decode().split("\r\n")[1:-1]:
            text, checksum = sentence.split("*")
            self.assertEqual(crc8(text), int(checksum, 16), sentence)

    def test_vehicle_software_finds_it_by_http(self):
        def fetch(path):
            command = [sys.executable, "-c", "import sys, urllib.request as r; print(r.urlopen(sys.argv[1], timeout=10).read().decode())",
                       f"http://{self.ADDRESS}{path}"]
            return subprocess.run(self.client_machine.command(*command), capture_output=True, text=True, check=False)

        self.assertIn("DVL", json.loads(fetch("/api/v1/about").stdout)["product_name"])
        self.assertEqual(json.loads(fetch("/api/v1/about/status").stdout), {"temperature": 30.0})
        self.assertIn("404", fetch("/settings").stderr)

    def test_the_loop_of_the_makers_script(self):
        """It says nothing, reads 4096 bytes at a time, splits at CR LF and keeps the types that it knows."""
        client = self.client()
        kinds = [client.next()["type"] for _ in range(30)]
        self.assertEqual(set(kinds), {"velocity", "position_local"})
        reports = [client.wait("velocity") for _ in range(5)]
        for before, after in zip(reports, reports[1:]):
            spacing_ms = (after["time_of_transmission"] - before["time_of_transmission"]) / 1000
            self.assertAlmostEqual(after["time"], spacing_ms, delta=2.0)

    def test_the_loop_of_a_client_without_line_ends(self):
        """It reads 2048 bytes at a time; it sets all six values, gets them, and resets dead reckoning."""
        client = self.client()
        wanted = {"speed_of_sound": 1475, "acoustic_enabled": True, "dark_mode_enabled": False, "mounting_rotation_offset": 0,
                  "range_mode": "auto", "periodic_cycling_enabled": False}
        self.assertTrue(client.ask("set_config", **wanted)["success"])
        self.assertEqual(client.ask("get_config")["result"], wanted)
        self.assertTrue(client.ask("reset_dead_reckoning")["success"])
        self.assertAlmostEqual(client.wait("position_local")["x"], 0.0, delta=0.01)
        self.assertEqual(len([client.wait("velocity") for _ in range(25)]), 25)
        self.assertFalse(client.ask("set_config", speed_of_sound=900)["success"])
        client.connection.sendall(b'{"command":"get_config"}{"command":"get_ver')
        self.assertEqual(client.wait("response")["response_to"], "get_config")
        client.connection.sendall(b'sion_info"}')
        self.assertEqual(client.wait("response")["response_to"], "get_version_info")

    def test_a_recording_is_replayed(self):
        live, _ = self.view("--tcp", "127.0.0.1:16171", "--pings", "10")
        log, = glob.glob(os.path.join(self.folder, "logs", "*.mcap"))
        player = self.start(os.path.join(self.PROGRAMS, "sonard"), "replay", log)
        place = player.wait_for_line(r"serves tcp (\S+)", PATIENCE_S).split("serves tcp ")[1].split()[0]
        played, _ = self.view("--tcp", place, "--pings", "5")
        for report in played:
            self.assertAlmostEqual(float(report["altitude_m"]), float(live[0]["altitude_m"]), delta=0.03)
        player.terminate(10)


class NearTheBed(HeadCase):
    """Where the device reports 15 times a second."""

    CONFIG = CONFIG.replace("[-1, -0.5, -4]", "[-1, -0.5, -7.6]")
    HEADS = """
  - name: dvl
    type: dvl_a50
    tcp: {bind: 127.0.0.1:16171}
    initial: {periodic_cycling_enabled: false}
    mount: {rpy_deg: [0, 90, 0]}
"""

    def assert_rate(self, reports, seconds):
        self.assertTrue(all(report["velocity_valid"] for report in reports[10:]))
        self.assertGreater(len(reports), 0.9 * 15 * seconds, "15 reports a second")

    def test_who_never_reads_is_closed_and_costs_the_others_nothing(self):
        reader, other = self.client(), self.client()
        reader.reports_for(2)  # until it has found the bottom
        deaf = self.client(receive_buffer=4096)
        for _ in range(40):  # the answers fill its buffers
            deaf.connection.sendall(b'{"command":"get_config"}' * 50)
        found = {}
        sink = threading.Thread(target=lambda: found.update(other=other.reports_for(15)))
        sink.start()
        reports = reader.reports_for(15)
        sink.join()
        self.assert_rate(reports, 15)
        self.assert_rate(found["other"], 15)
        port = deaf.connection.getsockname()[1]
        self.daemon.wait_for_line(rf"client 127\.0\.0\.1:{port} is gone", PATIENCE_S)  # after 10 s without a message taken
        self.daemon.wait_for_line(r"messages were dropped: the client reads too slowly", PATIENCE_S)
        self.assertTrue(reader.ask("get_config")["success"])

    def test_clients_that_break_off_in_the_middle_of_a_message(self):
        reader = self.client()
        reader.reports_for(2)
        stop, rounds = threading.Event(), []

        def disturb():
            while not stop.is_set():
                rounds.append(1)
                client = self.client(receive_buffer=4096)
                client.connection.sendall(b'{"command":"get_config"}' * 200)
                client.connection.recv(100)
                client.break_off()
                time.sleep(0.05)

        disturber = threading.Thread(target=disturb)
        disturber.start()
        reports = reader.reports_for(6)
        stop.set()
        disturber.join()
        self.assert_rate(reports, 6)
        self.assertGreater(len(rounds), 10)
        self.daemon.wait_for_line(r"client 127\.0\.0\.1:\d+ is gone", PATIENCE_S)


class InSimulatedTime(HeadCase):
    """A simulation that runs four times as fast as real time."""

    CONFIG = CONFIG.replace("poses:", "poses:\n  clock: simulated")
    HEADS = """
  - name: dvl
    type: dvl_a50
    tcp: {bind: 127.0.0.1:16171}
    mount: {rpy_deg: [0, 90, 0]}
"""

    def test_dead_reckoning_adds_up_simulated_time(self):
        way = os.path.join(self.folder, "way.csv")
        with open(way, "w", encoding="utf-8") as file:
            file.write("t,x,y,z,qx,qy,qz,qw\n0,-3,0,-4,0,0,0,1\n8,1,0,-4,0,0,0,1\n")
        client = self.client()
        cast = self.start(os.path.join(self.PROGRAMS, "posecast"), way, "--to", "127.0.0.1:14600", "--stamps", "file",
                          "--speed", "4", "--hold", "1")
        client.wait("velocity")
        self.assertTrue(client.ask("reset_dead_reckoning")["success"])
        self.assertEqual(cast.wait(PATIENCE_S), 0, cast.tail())
        end_s = time.time()
        while (position := client.wait("position_local"))["ts"] < end_s:
            pass
        self.assertAlmostEqual(position["x"], 4.0, delta=0.2)
        self.assertAlmostEqual(position["y"], 0.0, delta=0.2)


class TwoMachines(HeadCase):
    """On two machines, with a wire that loses bursts: TCP sends them again."""

    ADDRESS = HEAD_ADDRESS
    HEADS = f"""
  - name: dvl
    type: dvl_a50
    tcp: {{bind: "{HEAD_ADDRESS}:16171", allow: [10.61.19.0/24]}}
    mount: {{rpy_deg: [0, 90, 0]}}
"""

    @classmethod
    def make_machines(cls):
        cls.lab = Lab()
        cls.lab.__enter__()
        cls.addClassCleanup(cls.lab.__exit__)
        cls.machine, cls.client_machine = cls.lab.head, cls.lab.client

    def dropped(self):
        shown = subprocess.run(["tc", "-netns", self.machine.name, "-s", "-j", "qdisc", "show", "dev", "eth0"],
                               capture_output=True, text=True, check=True)
        return json.loads(shown.stdout)[0]["drops"]

    def test_over_a_wire_that_loses_every_message_that_comes_is_whole_and_in_order(self):
        client = self.client()
        client.reports_for(1)
        self.lab.tc(self.machine, "qdisc", "add", "dev", "eth0", "root", "tbf", "rate", "400kbit", "burst", "2kb", "limit", "4kb")
        try:
            for _ in range(20):
                client.connection.sendall(b'{"command":"get_config"}' * 20)
                time.sleep(0.1)
            reports, answers = [], 0
            while answers < 400 or len(reports) < 20:  # each line is parsed
                message = client.next()
                answers += message["type"] == "response"
                reports += [message] if message["type"] == "velocity" else []
        finally:
            dropped = self.dropped()
            self.lab.tc(self.machine, "qdisc", "del", "dev", "eth0", "root")
        self.assertGreater(dropped, 0, "the wire lost nothing")
        sent = [report["time_of_transmission"] for report in reports]
        self.assertEqual(sent, sorted(set(sent)))
        self.assertTrue(all(report["velocity_valid"] for report in reports))


def crc8(text):
    """Polynomial 0x07, initial value 0."""
    crc = 0
    for byte in text.encode():
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 7) & 0xFF if crc & 0x80 else crc << 1
    return crc


if __name__ == "__main__":
    main()
