#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A Sonar 3D-15 and its clients on two machines: the calls of the maker's library, images by multicast and unicast.

    head_test.py --programs DIR [Sonar3d15.test_name ...]
"""

import glob
import http.client
import json
import os
import re
import socket
import struct
import subprocess
import sys
import time

import numpy
import packets

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "tests", "support")]
from head_case import PATIENCE_S, HeadCase, main  # noqa: E402
from lab import CLIENT_ADDRESS, HEAD_ADDRESS, Lab  # noqa: E402

GROUP, PORT = "224.0.0.96", 4747
BASE = "/api/v1/integration/"
SPHERE_M = (3**2 + 2**2) ** 0.5 - 0.5  # the nearest point, ahead and to port


class Sonar3d15(HeadCase):
    HEADS = f"""
  - name: bow
    type: sonar3d15
    network: {{address: {HEAD_ADDRESS}, allow: [10.61.19.0/24]}}
"""

    @classmethod
    def make_machines(cls):
        cls.lab = Lab()
        cls.lab.__enter__()
        cls.addClassCleanup(cls.lab.__exit__)
        cls.machine = cls.lab.head
        cls.client_machine = cls.lab.client

    def setUp(self):
        self.addCleanup(self.set, "acoustics/enabled", False)
        self.addCleanup(self.set, "acoustics/mode", "low-frequency")

    def call(self, method, path, body=None):
        connection = http.client.HTTPConnection(HEAD_ADDRESS, timeout=PATIENCE_S)
        connection.sock = self.client_machine.tcp_socket()
        connection.sock.settimeout(PATIENCE_S)
        connection.sock.connect((HEAD_ADDRESS, 80))
        try:
            connection.request(method, path, None if body is None else json.dumps(body), {"Content-Type": "application/json"})
            reply = connection.getresponse()
            return reply.status, reply.read().decode()
        finally:
            connection.close()

    def get(self, path):
        status, body = self.call("GET", BASE + path)
        self.assertEqual(status, 200, body)
        return json.loads(body)

    def set(self, path, value):
        self.assertEqual(self.call("POST", BASE + path, value), (204, ""), path)

    def listen(self, group=True):
        made = self.client_machine.udp_socket("", PORT, reuse=True)
        made.settimeout(PATIENCE_S)
        if group:
            made.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                            socket.inet_aton(GROUP) + socket.inet_aton(CLIENT_ADDRESS))
        made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        self.addCleanup(made.close)
        return made

    def shot(self, images):
        """The two images of the next shot."""
        while True:
            datagram, sender = images.recvfrom(65536)
            self.assertEqual(sender[0], HEAD_ADDRESS)
            ranges = packets.decode(datagram)
            if ranges.kind == "RangeImage":
                break
        signal = packets.decode(images.recv(65536))
        self.assertEqual(signal.kind, "BitmapImageGreyscale8")
        self.assertEqual(ranges.header, signal.header)
        self.assertEqual(ranges.pixels.shape, signal.pixels.shape)
        self.assertTrue(((ranges.pixels > 0) == (signal.pixels > 0)).all())
        return ranges, signal

    def test_all_settings_read_back_as_set(self):
        about = self.get("about")
        self.assertEqual((about["product_name"], about["version_short"]), ("Sonar 3D-15", "1.8.0"))
        self.assertEqual(json.loads(self.call("GET", "/api/v1/about")[1]), about)
        self.assertIsInstance(self.get("temperature"), float)
        self.assertEqual(self.get("status")["api"]["status"], "ok")
        for path, values in {"acoustics/enabled": [True, False], "acoustics/mode": ["high-frequency", "low-frequency"],
                             "acoustics/range": [{"min": 2.0, "max": 3.0}, {"min": 0.3, "max": 15}],
                             "acoustics/salinity": ["fresh", "salt"], "acoustics/speed_of_sound": [1442.0, 0],
                             "output/imu-batch/enabled": [True, False],
                             "udp": [{"mode": "unicast", "unicast_destination_ip": CLIENT_ADDRESS,
                                      "unicast_destination_port": 5000},
                                     {"mode": "multicast", "unicast_destination_ip": "", "unicast_destination_port": 0}],
                             }.items():
            for value in values:
                self.set(path, value)
                self.assertEqual(self.get(path), value)
        self.assertEqual(self.call("POST", BASE + "acoustics/enabled", "enable")[0], 400)
        self.assertEqual(self.call("GET", BASE + "acoustics/colour")[0], 404)

    def test_images_come_by_multicast_while_acoustics_are_on(self):
        images, other = self.listen(), self.listen()
        self.set("acoustics/enabled", True)
        ranges, signal = self.shot(images)
        self.assertEqual((ranges.pixels.shape, ranges.fov_h, ranges.fov_v), ((64, 256), 90.0, 40.0))
        self.assertEqual((ranges.range, ranges.frequency), (15.0, 5))
        self.assertAlmostEqual(ranges.seconds, time.time(), delta=PATIENCE_S)
        self.assertEqual(self.shot(other)[0].sequence, ranges.sequence)
        following, _ = self.shot(images)
        self.assertEqual(following.sequence, ranges.sequence + 1)
        period = following.seconds - ranges.seconds + 1e-9 * (following.nanos - ranges.nanos)
        self.assertGreater(period, 0.19)
        self.assert_sphere(ranges, signal)
        self.set("acoustics/enabled", False)
        images.settimeout(0.7)
        with self.assertRaises(TimeoutError):
            for _ in range(12):
                images.recv(65536)

    def assert_sphere(self, ranges, signal):
        """The world has a sphere to port of the axis."""
        seen = packets.points(ranges)
        self.assertGreater(len(seen), 20)
        nearest = seen[numpy.linalg.norm(seen, axis=1).argmin()]
        self.assertAlmostEqual(numpy.linalg.norm(nearest), SPHERE_M * 1491 / 1500, delta=0.03)
        self.assertAlmostEqual(numpy.degrees(numpy.arctan2(nearest[1], nearest[0])), -33.7, delta=2)
        self.assertEqual(int((signal.pixels > 0).sum()), len(seen))

    def test_modes_and_range_and_speed(self):
        images = self.listen()
        self.set("acoustics/mode", "high-frequency")
        self.set("acoustics/range", {"min": 0.3, "max": 9.5})
        self.set("acoustics/speed_of_sound", 1450)
        self.addCleanup(self.set, "acoustics/speed_of_sound", 0)
        self.addCleanup(self.set, "acoustics/range", {"min": 0.3, "max": 15})
        self.set("acoustics/enabled", True)
        ranges, _ = self.shot(images)
        self.assertEqual((ranges.fov_h, ranges.fov_v, ranges.frequency), (40.0, 40.0, 20))
        self.assertEqual((ranges.range, ranges.speed), (9.5, 1450.0))
        self.assertLessEqual(ranges.pixels.max(), 9.5)

    def test_unicast_and_none(self):
        images = self.listen(group=False)
        self.addCleanup(self.set, "udp", {"mode": "multicast", "unicast_destination_ip": "", "unicast_destination_port": 0})
        self.set("udp", {"mode": "unicast", "unicast_destination_ip": CLIENT_ADDRESS, "unicast_destination_port": PORT})
        self.set("acoustics/enabled", True)
        self.shot(images)
        self.set("udp", {"mode": "disabled", "unicast_destination_ip": "", "unicast_destination_port": 0})
        images.settimeout(0.7)
        with self.assertRaises(TimeoutError):
            for _ in range(12):
                images.recv(65536)

    def test_imu_batches_follow_the_images(self):
        images = self.listen()
        self.set("output/imu-batch/enabled", True)
        self.addCleanup(self.set, "output/imu-batch/enabled", False)
        self.set("acoustics/enabled", True)
        self.shot(images)
        batch = packets.decode(images.recv(65536))
        self.assertEqual(batch[2], 20)
        force = numpy.array(struct.unpack("<60f", batch[4])).reshape(20, 3)
        numpy.testing.assert_allclose(force, [[0, 0, -9.81]] * 20, atol=0.05)

    def test_bad_requests_do_not_hurt(self):
        for bytes_sent, status in ((b"hello\r\n\r\n", b"400"), (b"POST / HTTP/1.1\r\n\r\n", b"411"),
                                   (b"POST / HTTP/1.1\r\nContent-Length: 1000000\r\n\r\n", b"413")):
            made = self.client_machine.tcp_socket()
            made.settimeout(PATIENCE_S)
            made.connect((HEAD_ADDRESS, 80))
            made.sendall(bytes_sent)
            self.assertIn(status, made.recv(200))
            made.close()
        self.get("status")

    def test_sonarview_gets_every_shot(self):
        out = os.path.join(self.folder, "out")
        viewer = self.start(os.path.join(self.PROGRAMS, "sonarview"), "sonar3d15", "--head", HEAD_ADDRESS, "--interface",
                            CLIENT_ADDRESS, "--pings", "5", "--out", out, "--log-pings", "--quiet",
                            machine=self.client_machine)
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        summary = dict(re.findall(r"(\w+)=(\S+)", viewer.output().splitlines()[-1]))
        self.assertEqual((summary["pings"], summary["packets_bad"], summary["unpaired"]), ("5", "0", "0"))
        self.assertGreater(os.path.getsize(os.path.join(out, "shot-last.png")), 1000)
        self.assertFalse(self.get("acoustics/enabled"))

    def test_rendered_offline(self):
        way = os.path.join(self.folder, "way.csv")
        with open(way, "w", encoding="utf-8") as file:
            file.write("t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n")
        out = os.path.join(self.folder, "rendered")
        subprocess.run([os.path.join(self.PROGRAMS, "sonard"), "render", self.configuration(), "--trajectory", way, "--out",
                        out, "--mcap", "--truth"], capture_output=True, timeout=120, check=True)
        frame = numpy.load(os.path.join(out, "ping_000000.npy"))
        self.assertEqual((frame.shape, frame.dtype), ((128, 256), numpy.float32))
        points = numpy.load(os.path.join(out, "ping_000000_points.npy"))
        self.assertEqual(len(points), int((frame[:64] > 0).sum()))
        with open(os.path.join(out, "ping_000000.ply"), "rb") as file:
            self.assertIn(f"element vertex {len(points)}\n".encode(), file.read(200))
        bodies = numpy.load(os.path.join(out, "ping_000000_bodies.npy"))
        self.assertEqual(bodies.shape, (64, 256))
        numpy.testing.assert_array_equal(bodies > 0, frame[:64] > 0)
        log, = glob.glob(os.path.join(out, "*.mcap"))
        said = subprocess.run([os.path.join(self.PROGRAMS, "sonard"), "info", log], capture_output=True, text=True, check=True)
        self.assertIn("Sonar 3D-15", said.stdout)


if __name__ == "__main__":
    main()
