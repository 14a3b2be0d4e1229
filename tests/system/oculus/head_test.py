#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Heads and their clients: with configs/demo-oculus.yaml alone, and with both models beside a sphere.

    head_test.py --programs DIR [Demo.test_name ...]
"""

import math
import os
import re
import statistics
import struct
import time

import messages
from head import DEMO, PATIENCE_S, TOO_SLOW, Deadline, HeadCase, example, main
from messages import DUMMY, HIGH, LOW, PING, STANDBY, USER_CONFIG


class Demo(HeadCase):
    @classmethod
    def configuration(cls):
        return DEMO

    # ---- Our own client

    def test_sonarview_finds_the_head_and_draws_512_beams(self):
        output = self.view(5, "--log-pings", "--out", self.folder)
        self.assertRegex(output, r"summary .* messages_bad=0 bytes_dropped=0 images_written=2 ")
        self.assertRegex(output, r"ping id=\d+ mode=1 frequency_hz=750000 ranges=1165 beams=512 .* bits=8 ")
        for picture in ("fan-last.png", "polar-last.png"):
            with open(os.path.join(self.folder, picture), "rb") as file:
                self.assertEqual(file.read(4), b"\x89PNG")

    def test_sonarview_says_why_there_is_no_head(self):
        view = [os.path.join(self.PROGRAMS, "sonarview"), "oculus"]
        viewer = self.start(*view, "--wait", "1", "--status-port", "52103")
        self.assertEqual(viewer.wait(PATIENCE_S), 3, viewer.tail())
        self.assertIn("no status on port 52103 within 1.0 s", viewer.output())
        viewer = self.start(*view, "--wait", "3", "--head", "127.0.0.9")
        self.assertEqual(viewer.wait(PATIENCE_S), 3, viewer.tail())
        self.assertIn("cannot open tcp 127.0.0.9:52100 within 3.0 s: Connection refused; a status came from 127.0.0.3 "
                      "(to view one, use --head 127.0.0.3)", viewer.output())

    # ---- Status (6)

    def test_the_status_is_of_142_bytes_from_the_address_of_the_head_and_names_its_client(self):
        statuses = self.statuses()
        datagram, sender = statuses.recvfrom(2048)
        status = messages.status_of(datagram)
        self.assertEqual((status.address, status.mask, status.client), ("127.0.0.3", "255.0.0.0", "0.0.0.0"))
        self.assertEqual(sender[0], "127.0.0.3")
        self.assertEqual((status.word, status.part), (3, 1032))
        self.assertEqual(status.device_id, status.source)
        self.assertLess(max(status.temperatures), 30)
        client = self.client()
        begin = time.monotonic()
        while (status := messages.status_of(statuses.recv(2048))).client == "0.0.0.0":
            pass
        self.assertEqual(status.client, "127.0.0.1")
        self.assertLess(time.monotonic() - begin, 0.9, "at once")
        client.close()
        while (status := messages.status_of(statuses.recv(2048))).client != "0.0.0.0":
            pass

    def test_statuses_come_once_a_second(self):
        statuses = self.statuses()
        statuses.recv(2048)
        begin = time.monotonic()
        for _ in range(4):
            messages.status_of(statuses.recv(2048))
        self.assertAlmostEqual(time.monotonic() - begin, 4.0, delta=0.5)

    # ---- Clients and their checks (9)

    def test_ensta_driver_sets_standby_and_resumes(self):
        """The client's request loop: it fires until a ping has its settings, at most a hundred times. Then it sends standby,
        which a Dummy confirms within five seconds, and the last settings again, copied from a ping."""
        client = self.client()
        client.write(example("oculus", "fire_ensta"))
        wanted = struct.unpack("<d", bytes.fromhex("52b81e85eb510440"))[0]
        for _ in range(100):
            ping = client.ping(5)
            self.assertIsNotNone(ping, "it closes after five seconds without one")
            gain = (ping.gain - 40) / 0.6  # it undoes what firmware does at the high frequency
            if (ping.mode, ping.gamma, ping.flags, ping.range_m) == (HIGH, 0x7F, 0x0D, wanted) and abs(gain - 50) < 1e-9:
                break
        else:
            self.fail("its settings never came")
        self.assertEqual(ping.version, 1)
        self.assertEqual(ping.gains, ping.ranges * [1])
        client.write(example("oculus", "fire_ensta_standby"))
        self.assertIsNotNone(client.wait(DUMMY, 5))
        got = client.all_for(2.2)
        self.assertNotIn(PING, {message.id for message in got})
        self.assertEqual([message.id for message in got].count(DUMMY), 2)
        client.write(example("oculus", "fire_ensta_resume_v2"))
        self.assertEqual(client.ping(5).flags, 0x0D)

    def test_liboculus_fires_once_and_gets_its_width_of_samples(self):
        for name, width in (("fire_liboculus_8_bit", 1), ("fire_liboculus_32_bit", 4)):
            client = self.client()
            client.write(example("oculus", name))
            for _ in range(3):
                ping = client.ping()
                self.assertEqual((ping.version, ping.width, ping.beams), (2, width, 512))
                self.assertEqual(ping.extension, 0x200 if width == 4 else 0)
            client.close()

    def test_the_makers_code_fires_without_a_length_after_each_ping(self):
        client = self.client()
        said = self.times_too_slow()
        client.write(example("oculus", "fire_vendor"))
        times, ids = [], []
        for _ in range(12):
            ping = client.ping()
            client.write(example("oculus", "fire_vendor"))
            times.append(round(ping.start_s * 1e9))  # modulo 2^32
            ids.append(ping.id)
        self.assertEqual(ids, sorted(set(ids)))
        if ids[-1] - ids[0] >= len(ids):  # this machine kept the client waiting: the head must have said so
            self.daemon.wait_for_line(TOO_SLOW, PATIENCE_S, said + 1)
        # A ping may start late on a busy machine, and the next one then in time: their mean rate counts.
        took_s = sum((after - before) % 2 ** 32 for before, after in zip(times, times[1:])) * 1e-9
        self.assertGreater(took_s, 0.1 * (len(times) - 2), "no extra pings")
        client.write(messages.user_config())
        answer = client.wait(USER_CONFIG, 1.5)
        self.assertEqual(answer.body, bytes([127, 0, 0, 3, 255, 0, 0, 0, 0, 0, 0, 0]))

    def test_a_fire_may_come_in_any_pieces(self):
        client = self.client()
        stream = example("oculus", "fire_ensta") + messages.user_config() + example("oculus", "fire_vendor")
        for cut in range(1, len(stream)):
            client.write(stream[:cut])
            client.write(stream[cut:])
        for _ in range(len(stream) - 1):
            self.assertIsNotNone(client.wait(USER_CONFIG))
        self.assertEqual(client.ping().mode, LOW)

    def test_one_client_is_served_and_the_next_when_it_has_gone(self):
        first = self.client()
        first.write(messages.fire(flags=0x09, range_m=3.0))
        first.ping()
        second = self.client(greeted=False)
        self.assertTrue(second.is_closed(), "it is sent away")
        self.assertIsNotNone(first.ping(), "and the first goes on")
        first.close()
        third = self.client()
        self.assertEqual({message.id for message in third.all_for(1.5)}, {DUMMY}, "it has not fired")

    def test_who_speaks_nonsense_is_sent_away_or_skipped(self):
        client = self.client()
        client.write(b"GET / HTTP/1.1\r\n\r\n" + messages.header(0x15, 0, 5) + bytes(5) + messages.fire(range_m=2.0))
        self.assertIsNotNone(client.ping(), "fires are found behind what is none")
        client.write(messages.header(0x15, 0, 1 << 30))
        self.assertTrue(client.is_closed())

    # ---- A client that is too slow (7)

    def test_a_slow_reader_misses_whole_pings(self):
        client = self.client(receive_buffer=8192)
        client.write(messages.fire(mode=LOW, rate=1, flags=0x4B, range_m=20.0, speed=1500.0))  # 1.2 MB each, 15 a second
        self.daemon.wait_for_line("head=oculus: pings .* bits=16", PATIENCE_S)
        # The client does not read.
        self.daemon.wait_for_line(TOO_SLOW, PATIENCE_S)
        ids = []
        while len(ids) < 20 and (not ids or ids[-1] - ids[0] == len(ids) - 1):
            ping = client.ping()  # every message that begins is whole, or the parser would fail
            self.assertEqual((ping.ranges, ping.beams, ping.width), (1165, 512, 2))
            ids.append(ping.id)
        self.assertEqual(ids, sorted(set(ids)))
        self.assertGreater(ids[-1] - ids[0], len(ids) - 1, "numbers of those that were left out are missing")


BOTH = """
  - name: wide
    type: oculus
    network: {address: 127.0.0.3, netmask: 255.0.0.0, status: [127.0.0.1]}
  - name: fine
    type: oculus
    model: m1200d
    device_id: 8000
    network: {address: 127.0.0.4, netmask: 255.0.0.0, status: [127.0.0.1]}
    firmware: {most_ranges: 700}
"""
SPHERE_BEARING = -math.degrees(math.atan2(2, 3))  # to port
SPHERE_RANGE_M = math.sqrt(13) - 0.5


class Attitude(HeadCase):
    """Two heads of a vehicle that is yawed, pitched and rolled, 20 m below the surface."""

    WORLD = """<?xml version="1.0"?>
<sdf version="1.9" xmlns:sonard="https://sonard.dev/sdf">
  <world name="w">
    <sonard:water_surface_z>0</sonard:water_surface_z>
    <model name="wall"><pose>8 0 -20 0 0 0</pose><static>true</static><link name="l"><visual name="v">
      <geometry><box><size>0.2 20 20</size></box></geometry></visual></link></model>
  </world>
</sdf>
"""
    CONFIG = """
engine: cpu
world: {{file: {world}}}
water: {{temperature_c: 7, depth_m: 5}}
poses: {{initial: {{position_m: [0, 0, -20], rpy_deg: [3, 5, 30]}}}}
sampling: {{preset: fast}}
heads:
  - name: nose
    type: oculus
    network: {{address: 127.0.0.3, netmask: 255.0.0.0, status: [127.0.0.1]}}
    mount: {{rpy_deg: [0, 10, 0]}}
  - name: hull
    type: oculus
    device_id: 8000
    network: {{address: 127.0.0.4, netmask: 255.0.0.0, status: [127.0.0.1]}}
    mount: {{position_m: [0, 0, 2], rpy_deg: [180, 0, 0]}}
    firmware: {{heading: counter_clockwise, pitch: nose_down, roll: port_down, pressure: gauge, reports_version_1: false}}
"""

    @classmethod
    def configuration(cls):
        world, path = (os.path.join(cls.folder, name) for name in ("water.sdf", "sonard.yaml"))
        with open(world, "w", encoding="utf-8") as file:
            file.write(cls.WORLD)
        with open(path, "w", encoding="utf-8") as file:
            file.write(cls.CONFIG.format(world=world))
        return path

    def ping_of(self, address, version):
        client = self.client(address)
        client.write(messages.fire(mode=LOW, flags=0x19, range_m=10.0, speed=1500.0, version=version,
                                   extension=0 if version == 2 else None))
        ping = client.ping()
        client.close()
        return ping

    def assert_angles(self, attitude, *wanted):
        for angle, right in zip(attitude, wanted, strict=True):
            self.assertAlmostEqual((angle - right + 180) % 360, 180, delta=1e-3)

    def test_a_ping_has_the_attitude_of_the_head_by_its_mount_and_the_pressure_of_its_depth(self):
        """Truth: the product of the rotation matrices of vehicle and mount, computed by hand."""
        ping = self.ping_of("127.0.0.3", 2)
        self.assert_angles(ping.attitude_deg, 59.461, -14.986, 3.094)
        self.assertAlmostEqual(ping.pressure_bar, 1.013 + 0.1 * 20, delta=1e-6)
        self.assertEqual(ping.temperature_c, 7)

    def test_signs_are_those_of_the_configuration_also_upside_down(self):
        ping = self.ping_of("127.0.0.4", 2)  # its mount is 2 m up the tilted vehicle
        self.assert_angles(ping.attitude_deg, 300, 5, 177)
        height_m = 2 * math.cos(math.radians(3)) * math.cos(math.radians(5))
        self.assertAlmostEqual(ping.pressure_bar, 0.1 * (20 - height_m), delta=1e-6)

    def test_a_fire_of_version_0_is_answered_with_version_1_unless_told_not_to(self):
        self.assertEqual(self.ping_of("127.0.0.3", 0).version, 1)
        self.assertEqual(self.ping_of("127.0.0.3", 1).version, 1)
        self.assertEqual(self.ping_of("127.0.0.4", 0).version, 0)
        self.assertAlmostEqual(self.ping_of("127.0.0.3", 0).pressure_bar, 3.013, delta=1e-6)

    def test_a_status_has_the_pressure_too(self):
        statuses = self.statuses()
        deadline = Deadline(PATIENCE_S)
        while not deadline.over():
            status = messages.status_of(statuses.recv(2048))
            if status.device_id == 7892:
                self.assertAlmostEqual(status.pressure_bar, 3.013, delta=1e-6)
                return
        self.fail("no status")


class Sphere(HeadCase):
    """A ball of steel, 3 m ahead and 2 m to port."""

    HEADS = BOTH

    def test_two_heads_tell_of_themselves_on_one_port(self):
        statuses = self.statuses()
        found = {}
        deadline = Deadline(PATIENCE_S)
        while len(found) < 2 and not deadline.over():
            status = messages.status_of(statuses.recv(2048))
            found[status.device_id] = (status.address, status.part)
        self.assertEqual(found, {7892: ("127.0.0.3", 1032), 8000: ("127.0.0.4", 1042)})

    def test_the_ball_is_where_it_is_at_both_frequencies_with_any_number_of_beams(self):
        """At the high frequency of an M750d it is near the edge of the fan; of an M1200d, outside of the fan."""
        for address, mode, sees in (("127.0.0.3", LOW, True), ("127.0.0.3", HIGH, True), ("127.0.0.4", LOW, True),
                                    ("127.0.0.4", HIGH, False)):
            for beams_flag, beams in ((0x40, 512), (0, 256)):
                with self.subTest(address=address, mode=mode, beams=beams):
                    client = self.client(address)
                    client.write(messages.fire(mode=mode, flags=0x09 | beams_flag, range_m=5.0, gamma=255, speed=1500.0))
                    ping = client.ping()
                    client.close()
                    self.assertEqual((ping.beams, ping.speed_used), (beams, 1500.0))
                    self.check_ball(ping, sees)

    def check_ball(self, ping, sees):
        first = int(2.0 / ping.resolution_m)
        row, beam = max(((row, beam) for row in range(first, ping.ranges) for beam in range(ping.beams)),
                        key=lambda at: ping.rows[at[0]][at[1]])
        strongest = ping.rows[row][beam]
        if not sees:
            self.assertLess(strongest, 60, "nothing but noise")
            return
        self.assertGreater(strongest, 120)
        self.assertAlmostEqual((row + 0.5) * ping.resolution_m, SPHERE_RANGE_M, delta=0.06)
        self.assertAlmostEqual(ping.bearings_cdeg[beam] / 100, SPHERE_BEARING, delta=2.0)

    def test_a_level_head_that_looks_east_has_a_heading_of_90_degrees_and_the_water_of_the_configuration(self):
        client = self.client()
        client.write(messages.fire(mode=LOW, flags=0x09, range_m=5.0, speed=1500.0, version=2, extension=0))
        ping = client.ping()
        self.assertAlmostEqual(ping.pressure_bar, 1.013 + 0.1 * 10, delta=1e-9)
        self.assertEqual(ping.temperature_c, 18)
        for angle, right in zip(ping.attitude_deg, (90, 0, 0), strict=True):
            self.assertAlmostEqual(angle, right, delta=1e-9)

    def test_samples_of_all_widths_and_gammas_are_of_one_picture(self):
        """Two pings have the same noise only by chance, so the ball is compared."""
        strongest = {}
        for width, flags, extension in ((1, 0x49, None), (2, 0x4B, None), (4, 0x4B, 0x200)):
            client = self.client()
            client.write(messages.fire(mode=LOW, flags=flags, range_m=5.0, gamma=255, gain=20.0, speed=1500.0,
                                       version=2 if extension else 0, extension=extension))
            ping = client.ping()
            client.close()
            self.assertEqual(ping.width, width)
            peak = max(int.from_bytes(row[at:at + width], "little") for row in ping.rows[600:]
                       for at in range(0, len(row), width))
            strongest[width] = peak / 256 ** width
        self.assertAlmostEqual(strongest[1], strongest[2], delta=0.15)
        self.assertAlmostEqual(strongest[2], strongest[4], delta=0.15)

    def test_the_table_of_bearings_is_that_of_a_recorded_head(self):
        """4.5, for an M1200d at its high frequency with 256 beams."""
        client = self.client("127.0.0.4")
        client.write(messages.fire(flags=0x19, range_m=2.0, speed=1490.658551265436))
        ping = client.ping()
        half = math.radians(30)
        table = [int(100 * math.degrees(math.asin(math.sin(half) * (2 * i / 255 - 1)))) for i in range(256)]
        table[0], table[-1] = -3000, 3000
        self.assertEqual(ping.bearings_cdeg, table)
        self.assertEqual((ping.bearings_cdeg[127], ping.bearings_cdeg[128]), (-11, 11))
        self.assertAlmostEqual(ping.frequency_hz, 2098880.597)
        self.assertAlmostEqual(ping.resolution_m, 2 * 0.002842188971, delta=1e-9)  # 703 rows are more than it may have
        self.assertEqual(ping.ranges, 351)

    def test_rates_are_kept(self):
        """Within the rendering speed of this machine: no rate is exceeded, and the slow rates are reached."""
        for code, hertz in ((0, 10), (1, 15), (2, 40), (3, 5), (4, 2)):
            with self.subTest(hertz=hertz):
                client = self.client()
                client.write(messages.fire(rate=code, flags=0x09, range_m=2.0, speed=1500.0, version=2, extension=0))
                starts = [client.ping().start_s for _ in range(5 if hertz < 10 else 20)]
                client.close()
                # The median: a busy machine makes single pings late.
                interval_s = statistics.median(b - a for a, b in zip(starts, starts[1:]))
                self.assertGreater(interval_s, 0.9 / hertz)
                if hertz <= 5:
                    self.assertLess(interval_s, 1.1 / hertz)

    def test_standby_is_kept_by_a_client_that_has_never_pinged(self):
        client = self.client()
        client.write(messages.fire(rate=STANDBY))
        self.assertEqual({message.id for message in client.all_for(2.5)}, {DUMMY})


if __name__ == "__main__":
    main()
