#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clients/python with the daemon, on a machine of its own (a network namespace).

    python_client_test.py --programs DIR [TestCase.test_name ...]

Pings are compared by CRC-32 with the renderer's output, and by range and bearing with the world: a sphere of 0.5 m at
(3, 2, 0), tests/data/system/sphere_to_port.sdf.
"""

import argparse
import csv
import glob
import math
import os
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import warnings
import zlib

import numpy

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, *folder) for folder in (("tests", "system", "gemini"), ("tests", "support"),
                                                             ("clients", "python"))]
from example_messages import example, messages  # noqa: E402
from lab import OwnMachine, Program  # noqa: E402
from sonard_client import (DamagedLog, Gemini, Micron, MovingBody, NoHead, NoPing, Oculus, Ping1D, Ping360,  # noqa: E402
                           PosePublisher, Sonar3D15)
from sonard_client import gemini, micron, oculus, ping360, ping_head, read_log, read_sonar_file, sonar3d15  # noqa: E402

WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
PROGRAMS = None  # folder of the programs under test
START_S = 60

CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: {position}}}}}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    dump: {{directory: {folder}}}
    network: {{alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}}
{link}
"""


def start(case, config, **values):
    """A daemon that ends with the case."""
    path = os.path.join(case.folder.name, "sonard.yaml")
    with open(path, "w", encoding="utf-8") as file:
        file.write(config.format(world=WORLD, folder=case.folder.name, **values))
    daemon = Program([os.path.join(PROGRAMS, "sonard"), "run", path], "sonard")
    case.addCleanup(daemon.kill)
    daemon.wait_for_line("sonard ready", START_S)
    return daemon


class PythonClient(OwnMachine):
    def start(self, link="", position=(0, 0, 0)):
        return start(self, CONFIG, position=list(position), link=link)

    def expect_rendered(self, ping):
        """The renderer's output, bit by bit."""
        with open(os.path.join(self.folder.name, "bow.csv"), encoding="utf-8") as file:
            rendered = {int(row["transmit_us"]): row["crc32"] for row in csv.DictReader(file)}
        samples = ping.samples if ping.samples.dtype == numpy.uint8 else ping.samples.astype(">u2")
        self.assertEqual(ping.missing, 0)
        self.assertEqual(f"{zlib.crc32(samples.tobytes()):08x}", rendered[ping.transmit_us])

    def test_five_lines_see_the_sphere(self):
        self.start()
        with Gemini() as sonar:
            ping = sonar.ping(range_m=6)
        self.expect_rendered(ping)
        row, beam = numpy.unravel_index(ping.samples.argmax(), ping.samples.shape)
        self.assertAlmostEqual(ping.ranges_m[row], math.hypot(3, 2) - 0.5, delta=0.1)
        self.assertAlmostEqual(ping.bearings_rad[beam], math.atan2(2, 3), delta=math.radians(9))
        self.assertGreater(ping.bearings_rad[beam], 0, "port is positive")

    def test_readme_in_a_virtual_environment(self):
        self.start()
        # Building writes files into the source folder, so it uses a copy.
        shutil.copytree(os.path.join(SOURCE, "clients", "python"), os.path.join(self.folder.name, "source"))
        venv = os.path.join(self.folder.name, "venv")
        for command in ([sys.executable, "-m", "venv", "--system-site-packages", venv],
                        [venv + "/bin/pip", "install", "--quiet", "--no-index", "--no-build-isolation", "--no-deps",
                         os.path.join(self.folder.name, "source")]):
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        with open(os.path.join(SOURCE, "clients", "python", "README.md"), encoding="utf-8") as file:
            example = file.read().split("```python\n")[1].split("```")[0]
        done = subprocess.run([venv + "/bin/python", "-c", example], cwd=self.folder.name, capture_output=True, text=True)
        self.assertRegex(done.stdout, r"^\(2411, 256\) 19\.99\d* \[ 1\.04\d* -1\.04\d*\]$", done.stderr)

    def test_forms_of_samples(self):
        self.start()
        with Gemini(sonar_id=513) as sonar:
            for options, dtype, rows in (({}, numpy.uint8, 723), ({"bits": 16}, numpy.uint16, 723),
                                         ({"compression": 2}, numpy.uint8, 180)):
                with self.subTest(options=options):
                    ping = sonar.ping(range_m=6, **options)
                    self.assertEqual((ping.samples.dtype, ping.samples.shape), (dtype, (rows, 256)))
                    self.assertAlmostEqual(ping.ranges_m[-1], 6, delta=0.05)
                    self.expect_rendered(ping)

    def test_pings_come_by_themselves_over_a_link_that_loses(self):
        self.start("    link: {to_client: {loss: 0.05}, from_client: {loss: 0.05}}")
        with Gemini() as sonar:
            pings = sonar.pings(interval_s=0.1, range_m=6)
            for _ in range(20):
                self.expect_rendered(next(pings))

    def test_logs_have_what_the_client_received(self):
        daemon = self.start("    mount: {position_m: [0.5, 0, 0]}\nrecording: {directory: logs}")
        with Gemini() as sonar:
            pings = [sonar.ping(range_m=6) for _ in range(3)]
        log, = glob.glob(os.path.join(self.folder.name, "logs", "*.mcap"))
        end = time.monotonic() + START_S
        while len(list(read_log(log))) < 2:  # of a log that is being written
            self.assertLess(time.monotonic(), end)
            time.sleep(0.1)
        daemon.terminate(START_S)
        logged = list(read_log(log))
        self.assertEqual(len(logged), 3)
        for ping, kept in zip(pings, logged):
            numpy.testing.assert_array_equal(ping.samples, kept.samples)
            numpy.testing.assert_allclose(ping.ranges_m, kept.ranges_m, atol=1e-6)
            numpy.testing.assert_allclose(ping.bearings_rad, kept.bearings_rad, atol=1e-6)
            self.assertEqual(kept.head, "bow")
            self.assertEqual(list(kept.sonar_position_m), [0.5, 0, 0])
            self.assertEqual(list(kept.sonar_quaternion_xyzw), [0, 0, 0, 1])
        self.assertAlmostEqual((logged[2].time_ns - logged[0].time_ns) / 1e3,
                               pings[2].transmit_us - pings[0].transmit_us, delta=1000)
        glf, = glob.glob(os.path.join(self.folder.name, "logs", "*.glf"))
        kept = list(read_log(glf))
        self.assertEqual([ping.head for ping in kept], ["513"] * 3)
        for ping, kept_in_mcap, kept_in_glf in zip(pings, logged, kept):
            numpy.testing.assert_array_equal(ping.samples, kept_in_glf.samples)
            numpy.testing.assert_allclose(ping.ranges_m, kept_in_glf.ranges_m, rtol=1e-4)  # whole hertz
            numpy.testing.assert_allclose(ping.bearings_rad, kept_in_glf.bearings_rad, atol=1e-6)
            self.assertAlmostEqual(kept_in_mcap.time_ns, kept_in_glf.time_ns, delta=2e6)
        with self.assertRaisesRegex(ValueError, "sonard.yaml is not a .mcap, .glf or .dat log"):
            next(read_log(os.path.join(self.folder.name, "sonard.yaml")))
        written = {ping.samples.tobytes() for ping in pings}
        self.assertEqual(len(written), 3)
        self.expect_damage(glf, written, most_lost=1)
        self.expect_damage(log, written, most_lost=3)  # they share a chunk

    def expect_damage(self, log, written, most_lost):
        """The largest loss for a log with a wrong bit; the reader must warn of any loss."""
        with open(log, "rb") as file:
            whole = file.read()
        for at in [*range(0, 200, 3), *range(200, len(whole) - 400, len(whole) // 40), *range(len(whole) - 400, len(whole), 5)]:
            path = os.path.join(self.folder.name, "damaged" + os.path.splitext(log)[1])
            with open(path, "wb") as file:
                file.write(whole[:at] + bytes([whole[at] ^ (1 << at % 8)]) + whole[at + 1:])
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                read = [ping.samples.tobytes() for ping in read_log(path)]
            lost = len(written.difference(read))
            self.assertLessEqual(lost, most_lost, at)
            if lost or len(read) < 3:
                self.assertTrue(any(issubclass(one.category, DamagedLog) for one in caught), at)
            for one in caught:
                self.assertIn(path, str(one.message))

    def test_a_head_that_is_silent(self):
        with self.assertRaisesRegex(NoHead, "that the head is on"):
            Gemini(patience_s=0.5)
        self.start(position=(0, 0, 0))
        with self.assertRaisesRegex(NoHead, "of head 600"):
            Gemini(sonar_id=600, patience_s=2.5)

    def test_no_pose_no_ping(self):
        self.start()
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, encoding="utf-8") as file:
            text = file.read().replace("poses: {initial: {position_m: [0, 0, 0]}}", "poses: {udp: {bind: 127.0.0.1:14600}}") \
                .replace("127.0.0.2", "127.0.0.5").replace("513", "514")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        daemon = Program([os.path.join(PROGRAMS, "sonard"), "run", path], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", START_S)
        with Gemini(sonar_id=514) as sonar, self.assertRaisesRegex(NoPing, "check that the head has a pose"):
            sonar.ping()


MICRON_CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
heads:
  - name: bow
    type: micron
    dump: {{directory: {folder}}}
    serial: {{tcp: [{{bind: 127.0.0.1:4001}}]}}
    device: {{duplex: {duplex}}}
"""


class GeminiBytes(unittest.TestCase):
    """Uses the worked examples of protocol/gemini/README.md 10 (tests/data/gemini/messages.json)."""

    def test_a_configuration_is_that_of_an_early_client(self):
        theirs = example("gemini", "ping_config")
        ours = gemini._ping_config(601, 4.0, 50, 1499.2, 0, 8, None)
        self.assertEqual(ours[:24] + theirs[24:28] + ours[28:], theirs, "all but the time between pings")

    def test_a_ping_has_the_fields_and_samples_of_its_datagrams(self):
        head, line = (messages("gemini")[name] for name in ("ping_head", "ping_line"))
        fields = head["fields"]["ping_head"]
        ping = gemini._Arriving(head["bytes"])
        self.assertEqual((ping.ping_id, ping.transmit_us, ping.beams, ping.rle, ping.compression, ping.count),
                         (fields["ping_id"], fields["transmit_time_us"], fields["beams"], fields["rle_threshold"],
                          fields["range_compression"], head["wireshark"]["ping_head.lines"]))
        ping.add(line["bytes"])
        self.assertEqual(ping.gaps(), [(1, ping.count - 1)])
        self.assertEqual(ping.samples()[0].tobytes().hex(), "".join(line["fields"]["ping_line"]["data"]))
        self.assertFalse(ping.tail)
        ping.add(example("gemini", "ping_tail"))
        self.assertTrue(ping.tail)


class MicronBytes(unittest.TestCase):
    """Uses frames that public drivers sent and read (tests/data/micron/messages.json)."""

    def test_commands_are_those_of_public_drivers(self):
        self.assertEqual(micron._frame(micron._SEND_VERSION), example("micron", "send_version"))
        self.assertEqual(micron._frame(micron._SEND_USER_BLOCKS), example("micron", "send_bb_user"))
        self.assertEqual(micron._frame(micron._SEND_DATA, b"\0\0\0\0"), example("micron", "send_data"))

    def test_parameters_lie_where_a_public_driver_has_them(self):
        theirs = example("micron", "head_command_ros")
        fields = messages("micron")["head_command_ros"]["fields"]["head_command"]
        sector = [math.tau * (3200 - fields[limit]) / 6400 for limit in ("left_limit", "right_limit")]
        ours = micron._frame(micron._HEAD_COMMAND, Micron._parameters(
            fields["ad_interval"], fields["bins"], fields["step"] * 360 / 6400, 50, 10, sector))
        self.assertEqual(len(ours), len(theirs))
        self.assertEqual(ours[:14], theirs[:14])
        self.assertEqual(ours[37:41], theirs[37:41], "limits")
        self.assertEqual(ours[49:55], theirs[49:55], "motor time, step, interval, bins")

    def test_frames_are_found_in_a_noisy_stream(self):
        frame = example("micron", "head_data")
        stream = bytearray(b"\x40\x40junk" + frame + b"\x0a@0008" + frame[:20])
        self.assertEqual(list(micron._frames(stream)), [frame])
        stream += frame[20:]
        self.assertEqual(list(micron._frames(stream)), [frame])

    def test_lines_have_their_bins(self):
        for line in [message for message in messages("micron").values() if message["message"] == "head_data"]:
            data = "".join(line["fields"]["data"])
            self.assertEqual(Micron._bins(line["bytes"]).tobytes().hex(), data, line["name"])


class MicronClient(OwnMachine):
    def start(self, duplex="full"):
        start(self, MICRON_CONFIG, duplex=duplex)

    def test_a_turn_sees_the_sphere(self):
        self.start()
        with Micron() as sonar:
            turn = sonar.turn(range_m=6, bins=300)
        self.assertEqual(turn.samples.shape, (300, 200))
        self.assertAlmostEqual(turn.ranges_m[-1], 6, delta=0.1)
        steps = numpy.diff(turn.bearings_rad) % (2 * math.pi)
        self.assertLess(abs(steps - (2 * math.pi - math.radians(1.8))).max(), 1e-9, "clockwise, all round")
        row, line = numpy.unravel_index(turn.samples.argmax(), turn.samples.shape)
        self.assertAlmostEqual(turn.ranges_m[row], math.hypot(3, 2) - 0.5, delta=0.1)
        self.assertAlmostEqual(turn.bearings_rad[line], math.atan2(2, 3), delta=math.radians(9))

    def test_a_sector_in_half_duplex(self):
        self.start("half")
        with Micron() as sonar:
            lines = sonar.lines(range_m=6, bins=200, sector_rad=(math.radians(60), 0.0))
            bearings = [math.degrees(next(lines).bearings_rad[0]) for _ in range(80)]
        self.assertLess(max(bearings), 60.1)
        self.assertGreater(min(bearings), -0.1)
        self.assertGreater(max(bearings) - min(bearings), 59)

    def test_a_head_that_is_not_there(self):
        with self.assertRaisesRegex(NoHead, "cannot connect to 127.0.0.1:4001"):
            Micron()


OCULUS_CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
heads:
  - name: bow
    type: oculus
    model: m750d
    network: {{address: 127.0.0.3, netmask: 255.0.0.0, status: [127.0.0.1]}}
"""
PING360_CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
heads:
  - name: bow
    type: ping360
    udp: [{{bind: 127.0.0.1:12345}}]
"""


class OculusBytes(unittest.TestCase):
    """Uses fires that public clients sent, and pings that they read (tests/data/oculus/messages.json)."""

    def test_a_fire_is_that_of_a_public_client(self):
        theirs = example("oculus", "fire_liboculus_8_bit")
        ours = oculus._fire(4.0, 50.0, 0.0, high_frequency=True, beams=512, bits=8, rate=0)
        self.assertEqual(ours[:19] + theirs[19:21] + ours[21:45] + theirs[45:], theirs, "all but gamma, flags and salinity")
        self.assertEqual(theirs[20] & ~0x04, ours[20], "this client adds a gain to each row")

    def test_pings_have_the_fields_of_their_messages(self):
        for version, start_us in ((1, 123456), (2, 12345678)):
            with self.subTest(version):
                message = messages("oculus")[f"ping_result_v{version}"]
                result = message["fields"][f"result_v{version}"]
                ping = oculus._ping(message["bytes"])
                self.assertEqual(ping.samples.shape, (result["nRanges"], result["nBeams"]))
                self.assertEqual(ping.samples.itemsize, 1 + result["dataSize"])
                self.assertEqual((ping.frequency_hz, ping.sound_speed_mps), (result["frequency"], result["speedOfSoundUsed"]))
                self.assertAlmostEqual(ping.ranges_m[-1], (result["nRanges"] - 0.5) * result["rangeResolution"])
                bearings_cdeg = numpy.frombuffer(bytes.fromhex(message["fields"]["bearings"]), "<i2")
                numpy.testing.assert_allclose(ping.bearings_rad, -numpy.radians(bearings_cdeg / 100))
                rows = numpy.frombuffer(bytes.fromhex(message["fields"]["image"]), numpy.uint8).reshape(3, -1)
                self.assertEqual(ping.samples.tobytes(), rows[:, 4 * (version == 1):].tobytes(), "version 1 has gains")
                self.assertEqual(ping.transmit_us, start_us)
                self.assertRaises(ValueError, oculus._ping, message["bytes"][:-1])

    def test_beams_are_those_of_the_model(self):
        message = bytearray(messages("oculus")["ping_result_v1"]["bytes"])
        for part, mode, width_deg in ((1032, 1, 1.0), (1042, 2, 0.4), (2203, 2, 0.4), (2658, 1, 0.6), (1041, 1, 2.0),
                                      (1041, 2, 2.0), (4713, 1, 1.4), (4713, 2, 0.9)):
            message[14:16] = struct.pack("<H", part)
            message[16] = mode
            self.assertAlmostEqual(math.degrees(oculus._ping(bytes(message)).beamwidth_rad), width_deg)


class OculusClient(OwnMachine):
    def test_it_sees_the_sphere(self):
        start(self, OCULUS_CONFIG)
        with Oculus() as sonar:
            self.assertEqual(sonar.host, "127.0.0.3")
            for settings, dtype, beams in (({}, numpy.uint8, 512), ({"bits": 16, "beams": 256}, numpy.uint16, 256)):
                with self.subTest(settings):
                    ping = sonar.ping(range_m=6, **settings)
                    self.assertEqual((ping.samples.dtype, ping.samples.shape[1]), (dtype, beams))
                    self.assertAlmostEqual(ping.ranges_m[-1], 6, delta=0.05)
                    self.assertEqual((ping.frequency_hz, ping.sound_speed_mps), (750e3, 1500))
                    row, beam = numpy.unravel_index(ping.samples.argmax(), ping.samples.shape)
                    self.assertAlmostEqual(ping.ranges_m[row], math.hypot(3, 2) - 0.5, delta=0.1)
                    self.assertAlmostEqual(ping.bearings_rad[beam], math.atan2(2, 3), delta=math.radians(9))
            ping = sonar.ping(range_m=6, high_frequency=True)
            self.assertEqual((ping.frequency_hz, ping.bearings_rad[0]), (1.2e6, math.radians(35)))

    def test_a_head_that_is_not_there(self):
        with self.assertRaisesRegex(NoHead, "no status on UDP port 52102 within 0.5 s"):
            Oculus(patience_s=0.5)
        with self.assertRaisesRegex(NoHead, "cannot connect to 127.0.0.3:52100"):
            Oculus("127.0.0.3")


class MovingBodies(OwnMachine):
    SPEED_MPS = 1.0

    def publish(self, ended):
        """The vehicle at rest, and the sphere on the x axis, from 2 m on: 2 poses per second."""
        with PosePublisher() as poses:
            begin = time.monotonic()
            while not ended.wait(0.5 - (time.monotonic() - begin) % 0.5):
                passed_s = time.monotonic() - begin
                poses.send(time.monotonic_ns(), (0, 0, 0), (0, 0, 0, 1), bodies=[
                    MovingBody("sphere", (2 + self.SPEED_MPS * passed_s, 0, 0), (0, 0, 0, 1), (self.SPEED_MPS, 0, 0))])

    def test_a_sphere_at_two_poses_per_second_does_not_step(self):
        start(self, OCULUS_CONFIG.replace(
            "poses: {{", "poses: {{udp: {{bind: 127.0.0.1:14600}}, extrapolation_limit_ms: 1000, "))
        ended = threading.Event()
        publisher = threading.Thread(target=self.publish, args=(ended,))
        publisher.start()
        self.addCleanup(publisher.join)
        self.addCleanup(ended.set)
        time.sleep(1.5)
        with Oculus() as sonar:
            pings = [ping for ping, _ in zip(sonar.pings(0.1, range_m=8), range(30))]
        times_s = numpy.array([ping.transmit_us for ping in pings]) * 1e-6
        ranges_m = numpy.array([ping.ranges_m[numpy.unravel_index(ping.samples.argmax(), ping.samples.shape)[0]]
                                for ping in pings])
        speed_mps, start_m = numpy.polyfit(times_s, ranges_m, 1)
        self.assertAlmostEqual(speed_mps, self.SPEED_MPS, delta=0.05)
        # Steps of 0.5 m would differ by up to 0.25 m from the line. Ranges have rows of 7 mm, stamps a delay of a few ms.
        self.assertLess(numpy.abs(ranges_m - start_m - speed_mps * times_s).max(), 0.06)


class Ping360Bytes(unittest.TestCase):
    """Uses frames that public clients sent and read (tests/data/ping360/messages.json)."""

    def test_frames(self):
        theirs = example("ping360", "transducer")
        self.assertEqual(ping_head.frame(ping360._TRANSDUCER, theirs[8:-2]), theirs)
        answer = example("ping360", "device_data")
        stream = bytearray(b"BBRxx\0\0" + answer + b"junkB" + answer[:9])
        self.assertEqual(list(ping_head.frames(stream)), [(2300, answer[8:-2])])
        stream += answer[9:]
        self.assertEqual(list(ping_head.frames(stream)), [(2300, answer[8:-2])])
        damaged = bytearray(answer)
        damaged[12] ^= 1
        self.assertEqual(list(ping_head.frames(damaged)), [])

    def test_only_an_answer_with_these_settings_is_one(self):
        payload = example("ping360", "device_data")[8:-2]
        self.assertTrue(ping360._answers(payload, (1, 200, 11, 88, 750, 8)))
        self.assertFalse(ping360._answers(payload, (1, 202, 11, 88, 750, 8)))
        self.assertFalse(ping360._answers(payload[:-1], (1, 200, 11, 88, 750, 8)))


class Ping360Client(OwnMachine):
    def test_a_turn_sees_the_sphere(self):
        start(self, PING360_CONFIG)
        with Ping360() as sonar:
            turn = sonar.turn(range_m=6, bins=600, step_deg=3.6)
            lines = sonar.lines(range_m=6, step_deg=0.1, gain_percent=100)
            self.assertAlmostEqual(math.degrees(sum(next(lines).bearings_rad[0] for _ in range(2))), -0.9)
            with self.assertRaisesRegex(ValueError, "refuses message 2601: gain_setting out of range"):
                next(sonar.lines(gain_percent=150))
        self.assertEqual(turn.samples.shape, (600, 100))
        self.assertAlmostEqual(turn.ranges_m[-1], 6, delta=0.1)
        steps = numpy.diff(turn.bearings_rad) % (2 * math.pi)
        self.assertLess(abs(steps - (2 * math.pi - math.radians(3.6))).max(), 1e-9, "clockwise, all round")
        far = turn.samples[100:]  # behind its own ringing
        row, line = numpy.unravel_index(far.argmax(), far.shape)
        self.assertAlmostEqual(turn.ranges_m[100 + row], math.hypot(3, 2) - 0.5, delta=0.1)
        self.assertAlmostEqual(turn.bearings_rad[line], math.atan2(2, 3), delta=math.radians(9))

    def test_a_head_that_is_not_there(self):
        with self.assertRaisesRegex(NoHead, "no answer from 127.0.0.1:12345 within 0.5 s"):
            Ping360(patience_s=0.5)


PING1D_CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
heads:
  - name: altimeter
    type: ping1d
    model: ping2
    udp: [{{bind: 127.0.0.1:9090}}]
    mount: {{rpy_deg: [0, 0, 33.69]}}    # towards the sphere
    link: {{seed: 1, to_client: {{duplicate: 0.5}}}}
"""


class Ping1DClient(OwnMachine):
    def test_the_distance_of_the_sphere(self):
        start(self, PING1D_CONFIG)
        with Ping1D() as sonar:
            self.assertEqual(sonar.revision, 2)
            pings = sonar.pings(range_m=5, start_m=0.5, gain=4, interval_s=0.02)
            soundings = [next(pings) for _ in range(30)]
            with self.assertRaisesRegex(ValueError, "refuses message 1005: gain_setting out of range"):
                sonar.ping(range_m=5, gain=7)
            automatic = sonar.pings(interval_s=0.02)
            self.assertAlmostEqual([next(automatic) for _ in range(20)][-1].distance_m, math.hypot(3, 2) - 0.5, delta=0.02)
        for sounding in soundings:
            self.assertEqual(sounding.samples.shape, (200, 1))
            self.assertAlmostEqual(sounding.ranges_m[0], 0.5 + 0.0125)
            self.assertAlmostEqual(sounding.ranges_m[-1], 5.5 - 0.0125)
            self.assertAlmostEqual(sounding.distance_m, math.hypot(3, 2) - 0.5, delta=0.02)
            self.assertGreater(sounding.confidence_percent, 50)
        numbers = [sounding.number for sounding in soundings]
        self.assertEqual(numbers, sorted(set(numbers)), "copies of a ping do not count")

    def test_a_head_that_is_not_there(self):
        with self.assertRaisesRegex(NoHead, "no answer from 127.0.0.1:9090 within 0.5 s"):
            Ping1D(patience_s=0.5)


class Sonar3D15Bytes(unittest.TestCase):
    """Uses packets that public clients read (tests/data/sonar3d15/messages.json)."""

    # x ahead, y to port, z up, as the maker's library has them but for the signs of y and z
    POINTS = ((0.907, 0.243, -0.342), (1.815, -0.486, -0.684), (1.993, -1.993, -1.026), (2.657, 2.657, 1.368),
              (4.538, 1.216, 1.710), (3.987, -3.987, 2.052))

    def test_both_images_are_a_shot(self):
        for name in ("range_image", "range_image_compressed"):
            shot, = sonar3d15.shots([example("sonar3d15", name), example("sonar3d15", "signal_image")])
            numpy.testing.assert_allclose(shot.points_m(), self.POINTS, atol=6e-4)
            self.assertEqual(shot.signals.tolist(), [[0, 20, 40, 60], [80, 100, 0, 170]])
            numpy.testing.assert_allclose(shot.strengths(), [48, 75, 119, 189, 300, 1504], atol=0.6)
            self.assertEqual((shot.number, shot.time_ns, shot.range_m, shot.sound_speed_mps),
                             (7, 1_767_225_600_250_000_000, 15, 1491))

    def test_readings_of_the_motion_sensor(self):
        batch = sonar3d15.decode(example("sonar3d15", "imu_batch"))
        self.assertEqual((batch.number, batch.times_ns.tolist()), (3, [1_767_225_600_000_000_000, 1_767_225_600_010_000_000]))
        numpy.testing.assert_allclose(batch.specific_force_mps2, [[0.1, 0, -9.8]] * 2, atol=1e-6)
        numpy.testing.assert_allclose(batch.rate_of_turn_radps, [[0, 0, 0.5]] * 2)

    def test_packed_blocks(self):
        """Copies of each kind, one that overlaps itself, and a literal with a length byte (Snappy's description of its format)."""
        for elements, plain in ((b"\x04ab\x09\x02", b"abababab"), (b"\x08abc\x0a\x03\x00", b"abcabc"),
                                (b"\x08abc\x0b\x03\x00\x00\x00", b"abcabc"), (b"\xf0\x3c" + b"x" * 61, b"x" * 61)):
            self.assertEqual(sonar3d15._unpacked(bytes([len(plain)]) + elements), plain)
            with self.assertRaisesRegex(ValueError, "packed wrongly"):
                sonar3d15._unpacked(bytes([len(plain) + 1]) + elements)
        with self.assertRaisesRegex(ValueError, "packed wrongly"):
            sonar3d15._unpacked(b"\x04\x00a\x01\x02")  # a copy from before the start

    def test_wrong_bytes_are_refused(self):
        whole = example("sonar3d15", "range_image_compressed")
        for place in range(len(whole)):
            with self.assertRaises(ValueError, msg=place):
                sonar3d15.decode(whole[:place] + bytes([whole[place] ^ 1]) + whole[place + 1:])
            with self.assertRaises(ValueError, msg=place):
                sonar3d15.decode(whole[:place])

    def test_a_recording_is_read_behind_damage(self):
        with tempfile.NamedTemporaryFile(suffix=".sonar") as file:
            pair = example("sonar3d15", "range_image") + example("sonar3d15", "signal_image")
            file.write(pair + b"RIP2 rubbish" + example("sonar3d15", "imu_batch") + pair[:-1] + pair)
            file.flush()
            self.assertEqual([shot.number for shot in read_sonar_file(file.name)], [7, 7])


SONAR3D15_CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
recording: {{directory: {folder}/logs}}
heads:
  - name: bow
    type: sonar3d15
    network: {{address: 127.0.0.5, http_port: 8080}}
    device: {{width: 128, height: 32}}
"""


class Sonar3D15Client(OwnMachine):
    def test_it_sees_the_sphere_and_a_recording_has_the_same(self):
        daemon = start(self, SONAR3D15_CONFIG)
        with Sonar3D15() as sonar:
            received = sonar.shots(range_m=6, sound_speed_mps=1500)
            seen = [next(received) for _ in range(3)]
            self.assertEqual(sonar.get("acoustics/range"), {"min": 0.3, "max": 6})
            self.assertTrue(sonar.get("acoustics/enabled"))
            with self.assertRaisesRegex(ValueError, "refuses POST acoustics/range .*status 400"):
                sonar.shot(range_m=60)
            inspected = sonar.shot(range_m=5, high_frequency=True)
            self.assertAlmostEqual(inspected.bearings_rad[0], math.radians(20))
            self.assertEqual(inspected.range_m, 5)
        self.assertFalse(Sonar3D15().get("acoustics/enabled"))
        self.assertEqual([shot.number for shot in seen], list(range(seen[0].number, seen[0].number + 3)))
        for shot in seen:
            self.assertEqual((shot.ranges_m.shape, shot.signals.dtype), ((32, 128), numpy.uint8))
            points = shot.points_m()
            distances = numpy.linalg.norm(points, axis=1)
            self.assertAlmostEqual(distances.min(), math.hypot(3, 2) - 0.5, delta=0.02)
            x, y, z = points[distances.argmin()]
            self.assertAlmostEqual(math.atan2(y, x), math.atan2(2, 3), delta=math.radians(2))
            self.assertAlmostEqual(z, 0, delta=0.15)
        daemon.signal(signal.SIGTERM)
        daemon.wait(START_S)
        log, = glob.glob(os.path.join(self.folder.name, "logs", "*_bow.sonar"))
        recorded = {shot.number: shot for shot in read_sonar_file(log)}
        for shot in seen:
            numpy.testing.assert_array_equal(recorded[shot.number].ranges_m, shot.ranges_m)
            numpy.testing.assert_array_equal(recorded[shot.number].signals, shot.signals)

    def test_a_recording_is_served_again(self):
        daemon = start(self, SONAR3D15_CONFIG)
        with Sonar3D15() as sonar:
            shots = sonar.shots(range_m=6)
            for _ in range(5):
                next(shots)
        daemon.signal(signal.SIGTERM)
        daemon.wait(START_S)
        log, = glob.glob(os.path.join(self.folder.name, "logs", "*_bow.sonar"))
        recorded = list(read_sonar_file(log))
        text = subprocess.run([os.path.join(PROGRAMS, "sonard"), "info", log], capture_output=True, text=True, check=True).stdout
        self.assertIn("Sonar 3D-15", text)
        self.assertRegex(text, rf"\b{len(recorded)} pings")
        served = Program([os.path.join(PROGRAMS, "sonard"), "replay", log], "replay")
        self.addCleanup(served.kill)
        served.wait_for_line("sonard ready", START_S)
        with Sonar3D15("127.0.0.2", 80) as sonar:
            again = sonar.shot(range_m=6)
        numpy.testing.assert_array_equal(again.ranges_m, recorded[0].ranges_m)
        numpy.testing.assert_array_equal(again.signals, recorded[0].signals)

    def test_a_head_that_is_not_there(self):
        with self.assertRaisesRegex(NoHead, "no answer from 127.0.0.5:8080 within 0.5 s"):
            Sonar3D15(patience_s=0.5)


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard")
    options, rest = parser.parse_known_args()
    PROGRAMS = os.path.abspath(options.programs)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
