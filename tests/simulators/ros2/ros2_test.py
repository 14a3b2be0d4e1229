#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clients/ros2 with stand-ins for rclpy, whose messages are as strict as those in ROS 2, against the daemon.

    ros2_test.py --programs DIR [TestCase.test_name ...]

The world is a sphere of 0.5 m at (3, 2, 0), tests/data/system/sphere_to_port.sdf.
"""

import argparse
import ast
import dataclasses
import glob
import importlib.util
import math
import os
import re
import shutil
import signal
import sys
import time
import unittest
import xml.etree.ElementTree
from types import SimpleNamespace

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [HERE, os.path.join(SOURCE, "tests", "system", "gemini"), os.path.join(SOURCE, "tests", "support")]

import pcapng_reader  # noqa: E402
import wire_pings  # noqa: E402
from lab import OwnMachine, Program  # noqa: E402
from ros2_messages import CLASSES  # noqa: E402
from ros2_stand_ins import SENSOR_DATA, Time, ros  # noqa: E402
from sonard_client import Ping, Shot, Sounding  # noqa: E402
from sonard_client import ros2_messages as contents  # noqa: E402
from sonard_client.turn import TurnCollector  # noqa: E402
from sonard_ros2 import parameters, running  # noqa: E402
from sonard_ros2.messages import message  # noqa: E402
from sonard_ros2.pose_bridge import PoseBridge  # noqa: E402
from sonard_ros2.sonar_bridge import SonarBridge  # noqa: E402

PACKAGE = os.path.join(SOURCE, "clients", "ros2")
WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
PROGRAMS = None  # folder of the programs under test
START_S = 60
PATIENCE_S = 30

CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{udp: {{bind: 127.0.0.1:14600}}}}
heads:
  - name: bow
"""
GEMINI = """
    type: gemini_720i
    sonar_id: 513
    network: {alternate_address: 127.0.0.2, netmask: 255.0.0.0, status: [127.0.0.1]}
"""
MICRON = """
    type: micron
    serial: {tcp: [{bind: 127.0.0.1:4001}]}
"""
OCULUS = """
    type: oculus
    model: m750d
    network: {address: 127.0.0.3, netmask: 255.0.0.0, status: [127.0.0.1]}
"""
PING360 = """
    type: ping360
    udp: [{bind: 127.0.0.1:12345}]
"""
PING1D = """
    type: ping1d
    udp: [{bind: 127.0.0.1:9090}]
    mount: {rpy_deg: [0, 0, 33.69]}    # towards the sphere
"""
SONAR3D15 = """
    type: sonar3d15
    network: {address: 127.0.0.5, http_port: 8080}
    device: {width: 128, height: 32}
"""
HEADS = {"gemini": GEMINI, "oculus": OCULUS, "micron": MICRON, "ping360": PING360}


def make(full_name, **fields):
    return CLASSES[full_name](**fields)


def header(frame_id="world", time_ns=None):
    time_ns = time.time_ns() if time_ns is None else time_ns
    return make("std_msgs/Header", frame_id=frame_id,
                stamp=make("builtin_interfaces/Time", sec=time_ns // 10**9, nanosec=time_ns % 10**9))


def turned(yaw_deg):
    return make("geometry_msgs/Quaternion", w=math.cos(math.radians(yaw_deg) / 2), z=math.sin(math.radians(yaw_deg) / 2))


def pose(x, y, z, orientation):
    return make("geometry_msgs/Pose", position=make("geometry_msgs/Point", x=float(x), y=float(y), z=float(z)),
                orientation=orientation)


def odometry(x, y, yaw_deg, **of_header):
    message = make("nav_msgs/Odometry", header=header(**of_header), child_frame_id="base_link")
    message.pose.pose = pose(x, y, 0, turned(yaw_deg))
    return message


def rotated(quaternion, vector):
    """v rotated by the unit quaternion: v + 2 q x (q x v + w v)."""
    axis = numpy.array([quaternion.x, quaternion.y, quaternion.z])
    return vector + 2 * numpy.cross(axis, numpy.cross(axis, vector) + quaternion.w * numpy.array(vector))


class StandIns(unittest.TestCase):
    """The stand-ins reject the same values as rosidl's classes."""

    def test_unknown_fields(self):
        with self.assertRaises(AttributeError):
            make("sensor_msgs/Image").rows = 3
        with self.assertRaises(AssertionError):
            make("geometry_msgs/Vector3", w=0.0)

    def test_wrong_types(self):
        for name, field, value in (("sensor_msgs/Image", "height", 3.0), ("sensor_msgs/Image", "height", -1),
                                   ("sensor_msgs/Image", "height", numpy.int64(3)), ("sensor_msgs/Image", "is_bigendian", 256),
                                   ("sensor_msgs/Image", "data", [256]), ("sensor_msgs/LaserScan", "angle_min", 1),
                                   ("sensor_msgs/LaserScan", "ranges", numpy.zeros(2, numpy.float32)),
                                   ("std_msgs/Header", "frame_id", b"sonar"), ("std_msgs/Header", "stamp", 3),
                                   ("marine_acoustic_msgs/SonarImageData", "is_bigendian", 0)):
            with self.subTest(name, field=field, value=value), self.assertRaises(AssertionError):
                setattr(make(name), field, value)


class Messages(unittest.TestCase):
    TIME_NS = 5 * 10**9 + 6

    def setUp(self):
        self.ping = Ping(samples=numpy.array([[1, 2, 3], [4, 5, 6]], numpy.uint8), ranges_m=numpy.array([0.5, 1.5]),
                         bearings_rad=numpy.radians([30, 0, -30]), transmit_us=7, sound_speed_mps=1480, frequency_hz=720e3,
                         beamwidth_rad=math.radians(1), vertical_beamwidth_rad=math.radians(20))
        self.wide = dataclasses.replace(self.ping, samples=self.ping.samples * numpy.uint16(256) + numpy.uint16(9))

    def made(self, maker, ping, *more):
        return message(maker(ping, self.TIME_NS, "sonar", *more))

    def test_projected_sonar_image(self):
        message = self.made(contents.projected_sonar_image, self.ping)
        self.assertEqual((message.header.frame_id, message.header.stamp.sec, message.header.stamp.nanosec), ("sonar_beams", 5, 6))
        # Port, ahead, starboard; y is to starboard.
        for direction, expected in zip(message.beam_directions, ((0, -0.5, 0.8660), (0, 0, 1), (0, 0.5, 0.8660))):
            numpy.testing.assert_allclose((direction.x, direction.y, direction.z), expected, atol=1e-4)
        self.assertEqual(list(message.ranges), [0.5, 1.5])
        self.assertEqual((message.ping_info.sound_speed, message.ping_info.frequency), (1480, 720e3))
        numpy.testing.assert_allclose(message.ping_info.tx_beamwidths, [0.34907] * 3, atol=1e-5)
        numpy.testing.assert_allclose(message.ping_info.rx_beamwidths, [0.01745] * 3, atol=1e-5)
        self.assertEqual((message.image.dtype, message.image.beam_count, list(message.image.data)), (0, 3, [1, 2, 3, 4, 5, 6]))
        image = self.made(contents.projected_sonar_image, self.wide).image
        self.assertEqual((image.dtype, image.beam_count, image.is_bigendian), (2, 3, False))
        self.assertEqual(list(image.data), [9, 1, 9, 2, 9, 3, 9, 4, 9, 5, 9, 6])

    def test_what_is_not_known_is_left_out(self):
        info = self.made(contents.projected_sonar_image, Ping(self.ping.samples, self.ping.ranges_m, self.ping.bearings_rad, None)).ping_info
        self.assertEqual((info.frequency, info.sound_speed, len(info.tx_beamwidths), len(info.rx_beamwidths)), (0, 0, 0, 0))

    def test_frame_of_the_beams(self):
        transform = message(contents.beams_transform(self.TIME_NS, "sonar"))
        self.assertEqual((transform.header.frame_id, transform.child_frame_id), ("sonar", "sonar_beams"))
        for axis, expected in (((0, 0, 1), (1, 0, 0)), ((1, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, -1, 0))):
            with self.subTest(axis):
                numpy.testing.assert_allclose(rotated(transform.transform.rotation, axis), expected, atol=1e-12)

    def test_a_mount_turns_as_in_the_configuration(self):
        """docs/frames-and-units.md: pitch down, yaw to port, roll with starboard down, in the order Rz Ry Rx."""
        for rpy_deg, axis, expected in (((0, 20, 0), (1, 0, 0), (0.9397, 0, -0.3420)), ((0, 0, 90), (1, 0, 0), (0, 1, 0)),
                                        ((90, 0, 0), (0, -1, 0), (0, 0, -1)), ((90, 0, 90), (0, 1, 0), (0, 0, 1)),
                                        ((0, 90, 90), (0, 0, 1), (0, 1, 0)), ((30, 40, 50), (1, 0, 0), (0.4924, 0.5868, -0.6428))):
            with self.subTest(rpy_deg):
                x, y, z, w = contents.quaternion_xyzw(rpy_deg)
                numpy.testing.assert_allclose(rotated(make("geometry_msgs/Quaternion", x=x, y=y, z=z, w=w), axis), expected, atol=1e-4)

    def test_image(self):
        message = self.made(contents.image, self.ping)
        self.assertEqual((message.height, message.width, message.step, message.encoding), (2, 3, 3, "mono8"))
        self.assertEqual(list(message.data), [1, 2, 3, 4, 5, 6])
        message = self.made(contents.image, self.wide)
        self.assertEqual((message.height, message.width, message.step, message.encoding), (2, 3, 6, "mono16"))
        self.assertEqual((message.is_bigendian, list(message.data[:4])), (0, [9, 1, 9, 2]))

    def test_calibration(self):
        message = self.made(contents.calibration, self.ping)
        self.assertEqual((message.height, message.width, message.distortion_model, message.k[0]), (2, 3, "sonar_polar", 0))
        numpy.testing.assert_allclose(message.d, [0.5, 1, 1480, 720e3, *self.ping.bearings_rad])

    def test_range(self):
        sounding = Sounding(samples=numpy.zeros((4, 1), numpy.uint8), ranges_m=numpy.array([1.25, 1.75, 2.25, 2.75]),
                            bearings_rad=numpy.zeros(1), transmit_us=None, beamwidth_rad=0.5, distance_m=2.125,
                            confidence_percent=80)
        message = self.made(contents.distance, sounding)
        self.assertEqual((message.radiation_type, message.field_of_view, message.min_range, message.max_range, message.range),
                         (0, 0.5, 1, 3, 2.125))
        self.assertEqual(self.made(contents.distance, dataclasses.replace(sounding, confidence_percent=0)).range, math.inf)

    def test_points(self):
        message = self.made(contents.points, self.ping, contents.EchoFilter(100 * 2 / 255, 1.0))
        self.assertEqual([(field.name, field.offset, field.datatype, field.count) for field in message.fields],
                         [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("intensity", 12, 7, 1)])
        self.assertEqual((message.height, message.width, message.point_step, message.row_step), (1, 3, 16, 48))
        self.assertEqual((message.is_bigendian, message.is_dense), (False, True))
        points = numpy.frombuffer(message.data, "<f4").reshape(-1, 4)
        side, ahead = 1.5 * 0.5, 1.5 * math.sqrt(0.75)
        numpy.testing.assert_allclose(points, [(ahead, side, 0, 4), (1.5, 0, 0, 5), (ahead, -side, 0, 6)], atol=1e-6)
        self.assertEqual(self.made(contents.points, self.ping, contents.EchoFilter(100 * 2 / 255, 0.0)).width, 5)
        zeros = dataclasses.replace(self.ping, samples=0 * self.ping.samples)
        self.assertEqual(self.made(contents.points, zeros, contents.EchoFilter(0.0, 0.0)).width, 0)

    SHOT = Shot(ranges_m=numpy.array([[0, 2.0], [4.0, 6.0]]), signals=numpy.array([[0, 9], [20, 255]], numpy.uint8),
                bearings_rad=numpy.radians([45, -45]), elevations_rad=numpy.radians([-20, 20]), number=3, time_ns=4, range_m=15,
                sound_speed_mps=1480)

    def test_points_of_a_shot(self):
        message = self.made(contents.shot_points, self.SHOT)
        self.assertEqual((message.height, message.width, message.point_step, message.row_step), (1, 3, 16, 48))
        side, up = math.cos(math.radians(20)) * math.sqrt(0.5), math.sin(math.radians(20))
        numpy.testing.assert_allclose(numpy.frombuffer(message.data, "<f4").reshape(-1, 4),
                                      [(2 * side, -2 * side, -2 * up, 9), (4 * side, 4 * side, 4 * up, 20),
                                       (6 * side, -6 * side, 6 * up, 255)], rtol=1e-6)

    def test_images_of_a_shot(self):
        message = self.made(contents.range_image, self.SHOT)
        self.assertEqual((message.height, message.width, message.step, message.encoding), (2, 2, 8, "32FC1"))
        numpy.testing.assert_array_equal(numpy.frombuffer(message.data, "<f4"), [4, 6, math.nan, 2])
        message = self.made(contents.signal_image, self.SHOT)
        self.assertEqual((message.height, message.width, message.step, message.encoding), (2, 2, 2, "mono8"))
        self.assertEqual(list(message.data), [20, 255, 0, 9])
        message = self.made(contents.shot_calibration, self.SHOT)
        self.assertEqual((message.height, message.width, message.distortion_model), (2, 2, "sonar_directions"))
        numpy.testing.assert_allclose(message.d, [1480, *numpy.radians([45, -45, 20, -20])])

    def test_scan(self):
        samples = numpy.array([[9, 9, 0, 9], [1, 7, 2, 0], [5, 6, 0, 0]], numpy.uint8)
        turn = dataclasses.replace(self.ping, samples=samples, ranges_m=numpy.array([0.5, 1.5, 2.5]),
                                   bearings_rad=numpy.radians([180, 90, 0, -90]))
        message = self.made(contents.scan, turn, contents.EchoFilter(100 * 2 / 255, 1.0), 8.5)
        numpy.testing.assert_allclose((message.angle_min, message.angle_max, message.angle_increment),
                                      (-math.pi / 2, math.pi, math.pi / 2))
        self.assertEqual((message.range_min, message.range_max, message.scan_time), (1, 3, 8.5))
        self.assertEqual((list(message.ranges), list(message.intensities)), ([math.inf, 1.5, 1.5, 2.5], [0, 2, 7, 5]))

    def test_lines_become_turns(self):
        for step_deg, columns, bearings_deg in ((90, 4, [180, 90, 0, -90]), (120, 3, [120, 0, -120])):
            with self.subTest(step_deg):
                collector = TurnCollector(math.radians(step_deg))
                lines = [dataclasses.replace(self.ping, samples=numpy.full((2, 1), 1 + number, numpy.uint8),
                                             bearings_rad=numpy.radians([-number * step_deg + 1]))
                         for number in range(columns)]
                turns = [collector.add(line) for line in lines]
                self.assertEqual(turns[:-1], [None] * (columns - 1))
                numpy.testing.assert_allclose(numpy.degrees(turns[-1].bearings_rad), bearings_deg)
                for number in range(columns):
                    column = min(range(columns), key=lambda one: abs(
                        (math.radians(-number * step_deg) - turns[-1].bearings_rad[one] + 1) % math.tau - 1))
                    self.assertEqual(turns[-1].samples[:, column].tolist(), [1 + number] * 2)


class Parameters(unittest.TestCase):
    def refused(self, node, expected, **values):
        ros.reset(**values)
        with self.assertRaisesRegex(ValueError, expected):
            node()

    def test_what_is_refused(self):
        self.refused(PoseBridge, "source is 'gps', expected odometry or pose or tf", source="gps")
        self.refused(PoseBridge, "axes is 'flu', expected enu_flu or ned_frd", axes="flu")
        self.refused(PoseBridge, "^parameter port, UDP port .*: 0 is not within 1 to 65535", port=0)
        self.refused(SonarBridge, "type is 'sidescan', expected gemini or micron or oculus or ping1d or ping360 or sonar3d15", type="sidescan")
        self.refused(SonarBridge, "device is 'sidescan', expected gemini or micron or oculus or ping1d or ping360 or sonar3d15", device="sidescan")
        self.refused(SonarBridge, "^parameter range_m, range .* metres: 0.5 is not within 1 to 150", range_m=0.5)
        self.refused(SonarBridge, "range_m is 151, expected a number from 1 to 150", range_m=151)
        self.refused(SonarBridge, "mount_rpy_deg is .0, 20., expected 3 numbers", mount_rpy_deg=[0, 20])
        self.refused(SonarBridge, "mount_rpy_deg is .*, expected 3 numbers", mount_rpy_deg=[0, 20, math.nan])
        self.refused(SonarBridge, "mount_rpy_deg is 20, expected 3 numbers", mount_rpy_deg=20)
        self.refused(SonarBridge, "range_m is far, expected a number from 1 to 150", range_m="far")
        self.refused(SonarBridge, "gain_percent is nan", gain_percent=math.nan)
        self.refused(SonarBridge, "bits is '12', expected 8 or 16", bits=12)
        self.refused(PoseBridge, "^parameter world_frame, the frame of sonard's world: ", world_frame=3)

    def test_descriptors(self):
        ros.reset()
        for node in (PoseBridge(), SonarBridge()):
            self.addCleanup(node.destroy_node)
        for parameter in parameters.POSE_BRIDGE + parameters.SONAR_BRIDGE:
            with self.subTest(parameter.name):
                descriptor = ros.descriptors[parameter.name]
                self.assertEqual((descriptor.description, descriptor.read_only), (parameter.meaning, True))
                limits = [(one.from_value, one.to_value) for one in [*descriptor.floating_point_range, *descriptor.integer_range]]
                self.assertEqual(limits, [(parameter.lowest, parameter.highest)] if parameter.lowest is not None else [])
                self.assertEqual(len(descriptor.integer_range), limits != [] and type(parameter.default) is int)
        self.assertEqual(ros.descriptors["type"].additional_constraints, "gemini or micron or oculus or ping1d or ping360 or sonar3d15")

    def test_a_whole_number_for_one_with_decimals(self):
        ros.reset(range_m=30, type="micron")
        node = SonarBridge()
        self.addCleanup(node.destroy_node)
        self.assertIs(type(node._options.range_m), float)

    def test_the_former_name_of_type(self):
        ros.reset(device="micron")
        node = SonarBridge()
        self.addCleanup(node.destroy_node)
        self.assertIn(("warning", "parameter device is now type: use type:=micron"), ros.log)
        self.assertIn("scan", ros.published)

    def test_the_page_lists_them(self):
        with open(os.path.join(SOURCE, "docs", "simulators", "ros2.md"), encoding="utf-8") as file:
            rows = dict(re.findall(r"^\| `(\w+)` \| `?([^|`]*?)`? \|", file.read(), re.MULTILINE))
        expected = {parameter.name: parameter.default_text() or "empty"
                    for parameter in (parameters.USE_SIM_TIME, *parameters.POSE_BRIDGE, *parameters.SONAR_BRIDGE)}
        self.assertEqual(rows, expected)


class Stamps(unittest.TestCase):
    def stamp(self, now_ns):
        """The stamp of a ping with a last range of 15 m (20 ms there and back), if it is complete at `now_ns`."""
        ros.reset(type="micron")
        node = SonarBridge()
        self.addCleanup(node.destroy_node)
        node.get_clock = lambda: SimpleNamespace(now=lambda: Time(nanoseconds=now_ns))
        return divmod(node._transmit_ns(15.0), 10**9)

    def test_when_it_was_sent(self):
        self.assertEqual(self.stamp(7_000_000_000), (6, 980_000_000))

    def test_simulated_time_that_has_just_begun(self):
        self.assertEqual(self.stamp(1_000_000), (0, 0))


class PackageFiles(unittest.TestCase):
    def test_launch_file(self):
        spec = importlib.util.spec_from_file_location("launch_file", os.path.join(PACKAGE, "launch", "sonard.launch.py"))
        module = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(module)
        entities = module.generate_launch_description().entities
        arguments = {entity.name: entity.default_value for entity in entities if hasattr(entity, "default_value")}
        nodes = [entity for entity in entities if hasattr(entity, "executable")]
        self.assertEqual([(node.package, node.executable) for node in nodes],
                         [("sonard_ros2", "pose_bridge"), ("sonard_ros2", "sonar_bridge")])
        # Each node gets all its parameters from arguments with the node's own defaults.
        for node, kind in zip(nodes, (PoseBridge, SonarBridge)):
            ros.reset(type="micron")
            kind().destroy_node()
            (values,) = node.parameters
            self.assertEqual({name: value.value.variable_name for name, value in values.items()},
                             {name: name for name in ["use_sim_time", *ros.declared]})
            self.assertEqual((arguments["use_sim_time"], values["use_sim_time"].value_type), ("false", None))
            for name, default in ros.declared.items():
                self.assertEqual(arguments.pop(name), str(default).lower() if isinstance(default, bool) else str(default))
                self.assertEqual(values[name].value_type, str if isinstance(default, str) else None)
        self.assertEqual(list(arguments), ["use_sim_time"], "of no node")

    def test_package_xml_and_setup(self):
        root = xml.etree.ElementTree.parse(os.path.join(PACKAGE, "package.xml")).getroot()
        self.assertEqual((root.tag, root.get("format"), root.findtext("name")), ("package", "3", "sonard_ros2"))
        self.assertEqual(root.findtext("export/build_type"), "ament_python")
        for name in ("version", "description", "maintainer", "license"):
            self.assertTrue(root.findtext(name), name)
        self.assertRegex(root.find("maintainer").get("email"), "@")
        with open(os.path.join(PACKAGE, "setup.py"), encoding="utf-8") as file:
            text = file.read()
        setup = {keyword.arg: ast.literal_eval(keyword.value) for node in ast.walk(ast.parse(text))
                 if isinstance(node, ast.Call) for keyword in node.keywords}
        self.assertEqual((setup["name"], setup["version"]), (root.findtext("name"), root.findtext("version")))
        self.assertEqual({package.replace(".", os.sep) for package in setup["packages"]},
                         {os.path.relpath(os.path.dirname(file), PACKAGE) for file in
                          glob.glob(os.path.join(PACKAGE, "sonard_ros2", "**", "__init__.py"), recursive=True)})
        for _, files in setup["data_files"]:
            for file in files:
                self.assertTrue(os.path.isfile(os.path.join(PACKAGE, file)), file)
        for script in setup["entry_points"]["console_scripts"]:
            name, module, function = re.fullmatch(r"(\w+) = sonard_ros2\.(\w+):(\w+)", script).groups()
            self.assertEqual((name, function), (module, "main"))
            self.assertTrue(callable(importlib.import_module("sonard_ros2." + module).main))

    def test_what_is_imported_is_named_in_package_xml(self):
        root = xml.etree.ElementTree.parse(os.path.join(PACKAGE, "package.xml")).getroot()
        named = {element.text for element in root.findall("exec_depend")}
        used = set()
        for folder in ("sonard_ros2", os.path.join("sonard_ros2", "heads"), "launch"):
            for name in os.listdir(os.path.join(PACKAGE, folder)):
                if name.endswith(".py"):
                    with open(os.path.join(PACKAGE, folder, name), encoding="utf-8") as file:
                        tree = ast.parse(file.read())
                    for node in ast.walk(tree):
                        if isinstance(node, ast.ImportFrom) and node.level == 0:
                            used.add(node.module.split(".")[0])
                        elif isinstance(node, ast.Import):
                            used.update(alias.name.split(".")[0] for alias in node.names)
        own = {"sonard_ros2", "sonard_client"} | set(sys.stdlib_module_names)
        self.assertEqual(used - own, named - {"python3-numpy"} | {"numpy"})


class Ros2(OwnMachine):
    """Nodes in this process, and sonard as a second process."""

    def start(self, head=GEMINI, more="", has_pose=False):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            text = more + CONFIG.format(world=WORLD) + head
            file.write(text.replace("poses: {", "poses: {initial: {position_m: [0, 0, 0]}, ") if has_pose else text)
        daemon = Program([os.path.join(PROGRAMS, "sonard"), "run", path], "sonard")
        self.addCleanup(daemon.kill)
        daemon.wait_for_line("sonard ready", START_S)
        return daemon

    def nodes(self, *kinds, **values):
        ros.reset(**values)
        for kind in kinds:
            self.addCleanup(kind().destroy_node)

    def expect_sphere(self, send, distance_m, bearing_deg):
        """The brightest sample of a ping is on the near side of the sphere, whose centre is `distance_m` away. Positive
        bearings are to port. `send` publishes the pose once."""
        seen = None
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            send()
            count = len(ros.published["sonar"])
            ros.wait(lambda: len(ros.published["sonar"]) > count, PATIENCE_S)
            message = ros.published["sonar"][-1]
            samples = numpy.frombuffer(message.image.data, numpy.uint8).reshape(-1, message.image.beam_count)
            row, beam = numpy.unravel_index(samples.argmax(), samples.shape)
            direction = message.beam_directions[beam]
            seen = message.ranges[row], math.degrees(math.atan2(-direction.y, direction.z)), samples.max()
            if abs(seen[0] - (distance_m - 0.5)) < 0.1 and abs(seen[1] - bearing_deg) < 9:
                return message
        self.fail(f"expected the sphere at {distance_m - 0.5} m, {bearing_deg} degrees, saw {seen}; {ros.log}")

    def errors(self):
        return [text for level, text in ros.log if level == "error"]

    def test_odometry(self):
        self.start()
        self.nodes(PoseBridge, SonarBridge, range_m=6.0, topic="/rov/odometry")
        self.assertEqual(ros.subscriptions["/rov/odometry"][2], SENSOR_DATA)
        for x, y, yaw_deg, distance_m, bearing_deg in ((1, 0, 0, math.sqrt(8), 45), (1, 4, 0, math.sqrt(8), -45),
                                                       (3, -1, 90, 3, 0)):
            with self.subTest(x=x, y=y, yaw_deg=yaw_deg):
                self.expect_sphere(lambda: ros.publish("/rov/odometry", odometry(x, y, yaw_deg)), distance_m, bearing_deg)

    def test_what_a_gemini_publishes(self):
        self.start()
        self.nodes(PoseBridge, SonarBridge, range_m=6.0, frame_id="bow", compression=0)
        begin_ns = time.time_ns()
        message = self.expect_sphere(lambda: ros.publish("/odom", odometry(1, 0, 0)), math.sqrt(8), 45)
        # 120 degrees, evenly in the sine: the outermost beams are half a step inside.
        outermost = 255 / 256 * math.sin(math.radians(60))
        first, last = message.beam_directions[0], message.beam_directions[-1]
        numpy.testing.assert_allclose((first.x, first.y, last.y), (0, -outermost, outermost), atol=1e-9)
        self.assertAlmostEqual(first.z, math.sqrt(1 - outermost**2))
        line_m = 1500 / (2 * 90422)
        self.assertEqual(len(message.ranges), 723)
        self.assertAlmostEqual(message.ranges[0], line_m / 2, places=6)
        self.assertAlmostEqual(message.ranges[-1], 722.5 * line_m, places=5)
        self.assertEqual((message.image.beam_count, len(message.image.data)), (256, 723 * 256))
        self.assertEqual(message.header.frame_id, "bow_beams")
        stamp_ns = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        self.assertTrue(begin_ns - 10**9 < stamp_ns < time.time_ns())
        image = ros.wait(lambda: [one for one in ros.published["image"] if
                                  one.header.stamp.nanosec == message.header.stamp.nanosec], PATIENCE_S)[0]
        self.assertEqual((image.header.frame_id, image.height, image.width), ("bow", 723, 256))
        self.assertEqual(image.data, message.image.data)
        transform, = ros.published["/tf_static"]
        self.assertEqual((transform.header.frame_id, transform.child_frame_id), ("bow", "bow_beams"))

    def test_the_distance_of_a_ping1d(self):
        self.start(PING1D, has_pose=True)
        self.nodes(SonarBridge, type="ping1d", interval_s=0.05, frame_id="altimeter")
        message = ros.wait(lambda: [one for one in ros.published["range"] if math.isfinite(one.range)][10:], PATIENCE_S)[0]
        self.assertAlmostEqual(message.range, math.hypot(3, 2) - 0.5, delta=0.03)
        self.assertEqual(message.header.frame_id, "altimeter")
        numpy.testing.assert_allclose((message.min_range, message.max_range), (0, 5), atol=1e-6)
        self.assertAlmostEqual(message.field_of_view, math.radians(30), places=6)
        self.assertEqual(len(ros.published["sonar"][-1].ranges), 200)

    def test_messages_are_what_was_on_the_wire(self):
        for kind, head in HEADS.items():
            with self.subTest(kind):
                self.compare_with_the_wire(kind, head)

    def compare_with_the_wire(self, kind, head):
        shutil.rmtree(os.path.join(self.folder.name, "logs"), ignore_errors=True)
        daemon = self.start(head, "recording: {directory: logs}\n", has_pose=True)
        ros.reset(type=kind, range_m=6, step_deg=7.2, threshold_percent=20, min_range_m=0.8)
        node, is_scanning = SonarBridge(), kind in ("micron", "ping360")
        try:
            ros.wait(lambda: len(ros.published["image"]) >= 2, 2 * PATIENCE_S)
        finally:
            node.destroy_node()
        daemon.terminate(PATIENCE_S)
        capture, = glob.glob(os.path.join(self.folder.name, "logs", "*.pcapng"))
        wire = {}
        for ping in wire_pings.PINGS[kind](pcapng_reader.read(capture)):
            wire[ping.bearings_rad[0], ping.data()] = ping
        for sonar, points in zip(ros.published["sonar"], ros.published["points"]):
            bearings_rad = [math.atan2(-one.y, one.z) for one in sonar.beam_directions]
            ping = min((one for (_, data), one in wire.items() if data == bytes(sonar.image.data)),
                       key=lambda one: abs(one.bearings_rad[0] - bearings_rad[0]))
            numpy.testing.assert_allclose(bearings_rad, ping.bearings_rad, atol=1e-6)
            numpy.testing.assert_allclose(sonar.ranges, (numpy.arange(len(ping.rows)) + 0.5) * ping.row_m, rtol=1e-6)
            self.assertEqual((sonar.image.beam_count, sonar.ping_info.sound_speed), (len(ping.rows[0]), 1500))
            self.assertEqual(points.header.stamp.nanosec, sonar.header.stamp.nanosec)
            self.compare_points(points, ping)
        self.compare_turn(wire.values()) if is_scanning else self.compare_image()

    def compare_points(self, points, ping):
        expected = [(r * math.cos(bearing), r * math.sin(bearing), 0, sample) for row, samples in enumerate(ping.rows)
                    for bearing, sample in zip(ping.bearings_rad, samples)
                    if sample >= 51 and (r := (row + 0.5) * ping.row_m) >= 0.8]
        numpy.testing.assert_allclose(numpy.frombuffer(points.data, "<f4").reshape(-1, 4), numpy.reshape(expected, (-1, 4)),
                                      atol=1e-5)

    def compare_image(self):
        sonar, image, calibration = (ros.published[topic][-1] for topic in ("sonar", "image", "calibration"))
        self.assertEqual(bytes(image.data), bytes(sonar.image.data))
        self.expect_calibration(calibration, image, sonar.ranges)
        numpy.testing.assert_allclose(calibration.d[4:], [math.atan2(-one.y, one.z) for one in sonar.beam_directions])

    def compare_turn(self, wire):
        """The first turn has each line of the wire in the column of its bearing. A line seen twice is as likely the first."""
        image, scan, calibration = (ros.published[topic][0] for topic in ("image", "scan", "calibration"))
        self.expect_calibration(calibration, image, ros.published["sonar"][0].ranges)
        pixels = numpy.frombuffer(image.data, numpy.uint8).reshape(image.height, image.width)
        self.assertEqual(image.width, 50)
        numpy.testing.assert_allclose(numpy.diff(calibration.d[4:]), -math.radians(7.2))
        numpy.testing.assert_allclose(scan.angle_min + scan.angle_increment * numpy.arange(50), calibration.d[4:][::-1], atol=1e-6)
        for column, bearing_rad in enumerate(calibration.d[4:]):
            lines = [ping for ping in wire if abs(math.remainder(ping.bearings_rad[0] - bearing_rad, math.tau)) < 1e-6]
            line, = [ping for ping in lines if ping.data() == pixels[:, column].tobytes()][:1]
            echoes = [(sample[0], -row) for row, sample in enumerate(line.rows) if sample[0] >= 51 and (row + 0.5) * line.row_m >= 0.8]
            strongest, row = max(echoes, default=(0, -math.inf))
            self.assertEqual(scan.intensities[49 - column], strongest)
            self.assertAlmostEqual(scan.ranges[49 - column], (0.5 - row) * line.row_m, places=5)
        self.assertAlmostEqual(scan.ranges[int(numpy.argmax(scan.intensities))], math.hypot(3, 2) - 0.5, delta=0.1)

    def expect_calibration(self, calibration, image, ranges):
        self.assertEqual((calibration.height, calibration.width, calibration.header.frame_id), (image.height, image.width, "sonar"))
        first_m, step_m, sound_speed_mps, frequency_hz = calibration.d[:4]
        numpy.testing.assert_allclose(first_m + step_m * numpy.arange(image.height), ranges, rtol=1e-5)
        self.assertEqual((sound_speed_mps, frequency_hz), (1500, ros.published["sonar"][0].ping_info.frequency))
        self.assertEqual(len(ros.published["calibration"]), 1, "it did not change")
        self.assertEqual(ros.qualities["calibration"].durability, "TRANSIENT_LOCAL")

    def test_shots_of_a_sonar_3d_15(self):
        self.start(SONAR3D15, has_pose=True)
        self.nodes(SonarBridge, type="sonar3d15", range_m=6, min_range_m=0.5)
        for topic in ("points", "range_image", "image"):
            ros.wait(lambda topic=topic: len(ros.published[topic]) > 1, PATIENCE_S)
        self.assertNotIn("sonar", ros.published)
        points, ranges, signals, (calibration,) = (ros.published[topic] for topic in ("points", "range_image", "image", "calibration"))
        self.assertEqual((ranges[0].height, ranges[0].width, ranges[0].header.frame_id), (32, 128, "sonar"))
        seen = numpy.frombuffer(points[0].data, "<f4").reshape(-1, 4)
        metres = numpy.frombuffer(ranges[0].data, "<f4")
        self.assertEqual(numpy.isfinite(metres).sum(), len(seen))
        self.assertEqual(numpy.count_nonzero(signals[0].data), len(seen))
        x, y, z, _ = seen[numpy.linalg.norm(seen[:, :3], axis=1).argmin()]
        self.assertAlmostEqual(math.hypot(x, y, z), math.hypot(3, 2) - 0.5, delta=0.02)
        self.assertAlmostEqual(math.atan2(y, x), math.atan2(2, 3), delta=math.radians(2))
        row, column = divmod(int(numpy.nanargmin(metres)), 128)
        self.assertAlmostEqual(calibration.d[1 + column], math.atan2(2, 3), delta=math.radians(2))
        self.assertAlmostEqual(calibration.d[129 + row], 0, delta=math.radians(3))

    def test_nothing_is_made_for_nobody(self):
        self.start(OCULUS, has_pose=True)
        ros.reset(type="oculus", range_m=2)
        ros.ignored = {"sonar", "image"}
        self.addCleanup(SonarBridge().destroy_node)
        ros.wait(lambda: len(ros.published["points"]) > 2, PATIENCE_S)
        self.assertEqual((ros.published["sonar"], ros.published["image"]), ([], []))

    def test_transforms(self):
        self.nodes(PoseBridge, SonarBridge, publish_tf=True, base_frame="rov", parent_frame="rov", mount_position_m=[1, 2, 3],
                   mount_rpy_deg=[0, 0, 90.0])
        beams, mount = ros.published["/tf_static"]
        self.assertEqual((mount.header.frame_id, mount.child_frame_id, beams.header.frame_id), ("rov", "sonar", "sonar"))
        place = mount.transform.translation
        self.assertEqual((place.x, place.y, place.z), (1, 2, 3))
        numpy.testing.assert_allclose(rotated(mount.transform.rotation, (1, 0, 0)), (0, 1, 0), atol=1e-12)
        ros.publish("/odom", odometry(4, 5, 90, time_ns=7 * 10**9 + 8))
        ros.publish("/odom", odometry(4, 5, 90, frame_id="odom"))
        vehicle, = ros.published["/tf"]
        self.assertEqual((vehicle.header.frame_id, vehicle.child_frame_id, vehicle.header.stamp.sec), ("world", "rov", 7))
        self.assertEqual((vehicle.transform.translation.x, vehicle.transform.translation.y), (4, 5))
        numpy.testing.assert_allclose(rotated(vehicle.transform.rotation, (1, 0, 0)), (0, 1, 0), atol=1e-12)

    def test_simulated_time(self):
        self.start(OCULUS, has_pose=True)
        ros.reset(type="oculus", range_m=2, use_sim_time=True)
        ros.simulated_ns = 90 * 10**9
        self.addCleanup(SonarBridge().destroy_node)
        stamp = ros.wait(lambda: ros.published["sonar"][:1], PATIENCE_S)[0].header.stamp
        self.assertEqual(stamp.sec, 89)
        self.assertAlmostEqual(1e9 - stamp.nanosec, 2 * 2 / 1500 * 1e9, delta=1e5)

    def test_sixteen_bits(self):
        self.start()
        self.nodes(PoseBridge, SonarBridge, range_m=6.0, bits=16, compression=2)
        ros.publish("/odom", odometry(1, 0, 0))
        image = ros.wait(lambda: ros.published["image"][:1], PATIENCE_S)[0]
        self.assertEqual((image.encoding, image.height, image.step), ("mono16", 180, 512))
        self.assertEqual(ros.published["sonar"][0].image.dtype, 2)

    def test_pose_stamped(self):
        self.start()
        self.nodes(PoseBridge, SonarBridge, range_m=6.0, source="pose", topic="/rov/pose", world_frame="map")
        self.expect_sphere(lambda: ros.publish("/rov/pose", make("geometry_msgs/PoseStamped", header=header("map"),
                                                                 pose=pose(3, -1, 0, turned(90)))), 3, 0)

    def test_ned(self):
        """North is y of sonard's world and east x; without rotation, the nose points north."""
        self.start()
        self.nodes(PoseBridge, SonarBridge, range_m=6.0, source="pose", topic="/pose", world_frame="world_ned", axes="ned_frd")
        self.expect_sphere(lambda: ros.publish("/pose", make("geometry_msgs/PoseStamped", header=header("world_ned"),
                                                             pose=pose(0, 1, 0, turned(0)))), math.sqrt(8), -45)

    def test_tf(self):
        self.start()
        self.nodes(PoseBridge, SonarBridge, range_m=6.0, source="tf", world_frame="map", base_frame="rov", rate_hz=20)
        (period_s, on_timer), = ros.timers
        self.assertEqual(period_s, 0.05)
        on_timer()
        self.assertIn("no pose is sent: \"rov\" is not connected to \"map\"", self.errors())

        def send():
            transform = make("geometry_msgs/TransformStamped", header=header("map"), child_frame_id="rov")
            transform.transform.translation = make("geometry_msgs/Vector3", x=3.0, y=-1.0)
            transform.transform.rotation = turned(90)
            ros.transforms["map", "rov"] = transform
            on_timer()

        self.expect_sphere(send, 3, 0)

    def test_poses_that_are_not_sent(self):
        self.nodes(PoseBridge)
        for expected, message in (("frame_id is 'odom', expected 'world' .parameter world_frame.", odometry(0, 0, 0, frame_id="odom")),
                                  ("the stamp is 0: its publisher must fill in the time", odometry(0, 0, 0, time_ns=0)),
                                  ("position_m is .nan", odometry(math.nan, 0, 0))):
            ros.publish("/odom", message)
            self.assertRegex(self.errors()[-1], "^no pose is sent: " + expected)
        count = len(self.errors())
        ros.publish("/odom", odometry(0, 0, 0, time_ns=-10**9))
        self.assertEqual(len(self.errors()), count, "times before 1970 are times")

    def test_tf_sends_a_time_once(self):
        sent = []
        self.nodes(PoseBridge, source="tf")
        ros.transforms["world", "base_link"] = make("geometry_msgs/TransformStamped", header=header())
        (_, on_timer), = ros.timers
        on_timer.__self__._poses.send = lambda *arguments: sent.append(arguments)
        on_timer()
        on_timer()
        ros.transforms["world", "base_link"] = make("geometry_msgs/TransformStamped", header=header())
        on_timer()
        self.assertEqual(len(sent), 2)

    def test_micron(self):
        self.start(MICRON)
        self.nodes(PoseBridge, SonarBridge, type="micron", range_m=6, bins=300)
        ros.publish("/odom", odometry(0, 0, 0))
        turn = ros.wait(lambda: ros.published["sonar"][50:250] if len(ros.published["sonar"]) >= 250 else None, 2 * PATIENCE_S)

        def bearing_rad(line):
            direction, = line.beam_directions
            return math.atan2(-direction.y, direction.z)

        steps = numpy.diff([bearing_rad(line) for line in turn]) % (2 * math.pi)
        self.assertLess(abs(steps - (2 * math.pi - math.radians(1.8))).max(), 1e-5, "clockwise")
        brightest = max(turn, key=lambda line: max(line.image.data))
        self.assertEqual((len(brightest.ranges), brightest.image.beam_count, brightest.header.frame_id), (300, 1, "sonar_beams"))
        self.assertAlmostEqual(brightest.ranges[-1], 6, delta=0.1)
        self.assertAlmostEqual(brightest.ranges[int(numpy.argmax(brightest.image.data))], math.hypot(3, 2) - 0.5, delta=0.1)
        self.assertAlmostEqual(bearing_rad(brightest), math.atan2(2, 3), delta=math.radians(9))

    def comes_back(self, head, topic, **values):
        daemon = self.start(head)
        self.nodes(PoseBridge, SonarBridge, range_m=6.0, **values)
        ros.publish("/odom", odometry(1, 0, 0))
        ros.wait(lambda: ros.published[topic], PATIENCE_S)
        daemon.kill()
        ros.wait(lambda: any(text.startswith("no ping is published: ") for text in self.errors()), PATIENCE_S)
        self.start(head)
        count = len(ros.published[topic])
        ros.publish("/odom", odometry(1, 0, 0))
        ros.wait(lambda: len(ros.published[topic]) > count + 3, PATIENCE_S)

    def test_a_gemini_comes_back(self):
        self.comes_back(GEMINI, "sonar")

    def test_an_oculus_comes_back(self):
        self.comes_back(OCULUS, "sonar", type="oculus")

    def test_a_ping360_comes_back(self):
        self.comes_back(PING360, "sonar", type="ping360")

    def test_a_micron_comes_back(self):
        self.comes_back(MICRON, "points", type="micron")

    def test_no_head(self):
        self.nodes(SonarBridge)
        ros.wait(lambda: [text for text in self.errors() if "that the head is on" in text], PATIENCE_S)

    def node(self, *arguments):
        program = Program([sys.executable, "-B", os.path.join(HERE, "ros2_node.py"), *arguments], arguments[0])
        self.addCleanup(program.kill)
        return program

    def expect_end(self, program, number=signal.SIGINT):
        begin = time.monotonic()
        program.signal(number)
        self.assertEqual(program.wait(PATIENCE_S), 0, program.tail())
        self.assertLess(time.monotonic() - begin, 2)
        self.assertNotIn("Traceback", program.output())

    def test_end_without_a_head(self):
        for arguments in (["pose_bridge"], ["sonar_bridge"], ["sonar_bridge", "type=micron"]):
            with self.subTest(arguments):
                program = self.node(*arguments)
                if arguments[0] == "pose_bridge":
                    program.wait_for_line("poses of /odom go to 127.0.0.1:14600", PATIENCE_S)
                elif len(arguments) == 2:
                    program.wait_for_line("cannot connect to 127.0.0.1:4001", PATIENCE_S)
                else:
                    time.sleep(2)  # in the middle of its wait for a status
                self.expect_end(program)

    def test_end_while_the_node_is_made(self):
        def make_node():
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(PATIENCE_S)
        self.addCleanup(signal.signal, signal.SIGINT, signal.getsignal(signal.SIGINT))
        self.addCleanup(signal.signal, signal.SIGTERM, signal.getsignal(signal.SIGTERM))
        self.addCleanup(ros.reset)
        self.assertEqual(running.run(make_node), 0)

    def test_end_while_it_pings_and_while_none_comes(self):
        self.start()
        for signal_number, has_pose in ((signal.SIGTERM, False), (signal.SIGINT, True)):
            program = self.node("sonar_bridge", "range_m=6")
            program.wait_for_line("pings of Gemini 513 at 127.0.0.2", PATIENCE_S)
            if has_pose:
                self.nodes(PoseBridge)
                ros.publish("/odom", odometry(1, 0, 0))
            time.sleep(1)
            self.expect_end(program, signal_number)

    def test_a_wrong_parameter_ends_it(self):
        program = self.node("sonar_bridge", "type=sidescan")
        self.assertEqual(program.wait(PATIENCE_S), 1)
        self.assertEqual(program.output(), "parameter type is 'sidescan', expected gemini or micron or oculus or ping1d or ping360 or sonar3d15")


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard")
    options, rest = parser.parse_known_args()
    PROGRAMS = os.path.abspath(options.programs)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
