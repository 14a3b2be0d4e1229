#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clients/ros2 with stand-ins for rclpy, whose messages are as strict as those in ROS 2, against the daemon.

    ros2_test.py --programs DIR [TestCase.test_name ...]

The world is a sphere of 0.5 m at (3, 2, 0), tests/data/system/sphere_to_port.sdf.
"""

import argparse
import ast
import importlib.util
import math
import os
import re
import signal
import sys
import time
import unittest
import xml.etree.ElementTree
from types import SimpleNamespace

import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [HERE, os.path.join(SOURCE, "tests", "system", "gemini")]

from lab import OwnMachine, Program  # noqa: E402
from ros2_messages import CLASSES  # noqa: E402
from ros2_stand_ins import SENSOR_DATA, InvalidParameterTypeException, Time, ros  # noqa: E402
from sonard_client import Ping  # noqa: E402
from sonard_ros2 import messages, parameters, running  # noqa: E402
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
    def setUp(self):
        self.stamp = make("builtin_interfaces/Time", sec=5, nanosec=6)
        self.ping = Ping(samples=numpy.array([[1, 2, 3], [4, 5, 6]], numpy.uint8), ranges_m=numpy.array([0.5, 1.5]),
                         bearings_rad=numpy.radians([30, 0, -30]), transmit_us=7)
        self.wide = Ping(samples=self.ping.samples * numpy.uint16(256) + numpy.uint16(9), ranges_m=self.ping.ranges_m,
                         bearings_rad=self.ping.bearings_rad, transmit_us=7)

    def test_projected_sonar_image(self):
        message = messages.projected_sonar_image(self.ping, self.stamp, "beams", 1480)
        self.assertEqual((message.header.frame_id, message.header.stamp.sec), ("beams", 5))
        # Port, ahead, starboard; y is to starboard.
        for direction, expected in zip(message.beam_directions, ((0, -0.5, 0.8660), (0, 0, 1), (0, 0.5, 0.8660))):
            numpy.testing.assert_allclose((direction.x, direction.y, direction.z), expected, atol=1e-4)
        self.assertEqual(list(message.ranges), [0.5, 1.5])
        self.assertEqual((message.ping_info.sound_speed, message.ping_info.frequency), (1480, 720e3))
        numpy.testing.assert_allclose(message.ping_info.tx_beamwidths, [0.34907] * 3, atol=1e-5)
        numpy.testing.assert_allclose(message.ping_info.rx_beamwidths, [0.01745] * 3, atol=1e-5)
        self.assertEqual((message.image.dtype, message.image.beam_count, list(message.image.data)), (0, 3, [1, 2, 3, 4, 5, 6]))
        image = messages.projected_sonar_image(self.wide, self.stamp, "beams", 1480).image
        self.assertEqual((image.dtype, image.beam_count, image.is_bigendian), (2, 3, False))
        self.assertEqual(list(image.data), [9, 1, 9, 2, 9, 3, 9, 4, 9, 5, 9, 6])

    def test_frame_of_the_beams(self):
        transform = messages.beams_frame(self.stamp, "sonar", "sonar_beams")
        self.assertEqual((transform.header.frame_id, transform.child_frame_id), ("sonar", "sonar_beams"))
        for axis, expected in (((0, 0, 1), (1, 0, 0)), ((1, 0, 0), (0, 0, 1)), ((0, 1, 0), (0, -1, 0))):
            with self.subTest(axis):
                numpy.testing.assert_allclose(rotated(transform.transform.rotation, axis), expected, atol=1e-12)

    def test_image(self):
        message = messages.image(self.ping, self.stamp, "sonar")
        self.assertEqual((message.height, message.width, message.step, message.encoding), (2, 3, 3, "mono8"))
        self.assertEqual(list(message.data), [1, 2, 3, 4, 5, 6])
        message = messages.image(self.wide, self.stamp, "sonar")
        self.assertEqual((message.height, message.width, message.step, message.encoding), (2, 3, 6, "mono16"))
        self.assertEqual((message.is_bigendian, list(message.data[:4])), (0, [9, 1, 9, 2]))

    def test_line_scan(self):
        line = Ping(samples=self.ping.samples[:, :1], ranges_m=self.ping.ranges_m, bearings_rad=numpy.array([0.25]),
                    transmit_us=None)
        message = messages.line_scan(line, self.stamp, "sonar")
        self.assertEqual((message.angle_min, message.angle_max, message.angle_increment), (0.25, 0.25, 0))
        self.assertEqual((message.range_min, message.range_max), (0, 2))
        self.assertEqual((list(message.ranges), list(message.intensities)), ([0.5, 1.5], [1, 4]))


class Parameters(unittest.TestCase):
    def refused(self, node, expected, **values):
        ros.reset(**values)
        with self.assertRaisesRegex(ValueError, expected):
            node()

    def test_what_is_refused(self):
        self.refused(PoseBridge, "source is 'gps', expected odometry or pose or tf", source="gps")
        self.refused(PoseBridge, "axes is 'flu', expected enu_flu or ned_frd", axes="flu")
        self.refused(PoseBridge, "port is 0, expected a number from 1 to 65535", port=0)
        self.refused(SonarBridge, "type is 'oculus', expected gemini or micron", type="oculus")
        self.refused(SonarBridge, "device is 'oculus', expected gemini or micron", device="oculus")
        self.refused(SonarBridge, "range_m is far, expected a number from 1 to 150", range_m="far")
        self.refused(SonarBridge, "gain_percent is nan", gain_percent=math.nan)
        self.refused(SonarBridge, "bits is '12', expected 8 or 16", bits=12)
        ros.reset(world_frame=3)
        with self.assertRaises(InvalidParameterTypeException):
            PoseBridge()

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
        self.assertEqual(list(ros.published), ["scan"])

    def test_the_page_lists_them(self):
        with open(os.path.join(SOURCE, "docs", "simulators", "ros2.md"), encoding="utf-8") as file:
            rows = dict(re.findall(r"^\| `(\w+)` \| `?([^|`]*?)`? \|", file.read(), re.MULTILINE))
        expected = {parameter.name: str(parameter.default) or "empty"
                    for parameter in parameters.POSE_BRIDGE + parameters.SONAR_BRIDGE}
        self.assertEqual(rows, expected)


class Stamps(unittest.TestCase):
    def stamp(self, now_ns):
        """The stamp of a ping with its last bin at 15 m (20 ms there and back), if it is complete at `now_ns`."""
        ros.reset(type="micron")
        node = SonarBridge()
        self.addCleanup(node.destroy_node)
        node.get_clock = lambda: SimpleNamespace(now=lambda: Time(nanoseconds=now_ns))
        ping = Ping(samples=numpy.zeros((2, 1), numpy.uint8), ranges_m=numpy.array([5.0, 15.0]),
                    bearings_rad=numpy.array([0.0]), transmit_us=None)
        stamp = node._transmit_stamp(ping)
        return stamp.sec, stamp.nanosec

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
                             {name: name for name in ros.declared})
            for name, default in ros.declared.items():
                self.assertEqual(arguments.pop(name), str(default))
                self.assertEqual(values[name].value_type, str if isinstance(default, str) else None)
        self.assertEqual(arguments, {}, "of no node")

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
        for folder in ("sonard_ros2", "launch"):
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
        self.assertEqual(used - own, named - {"python3-numpy"})


class Ros2(OwnMachine):
    """Nodes in this process, and sonard as a second process."""

    def start(self, head=GEMINI):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=WORLD) + head)
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
        turn = ros.wait(lambda: ros.published["scan"][50:250] if len(ros.published["scan"]) >= 250 else None, 2 * PATIENCE_S)
        steps = numpy.diff([line.angle_min for line in turn]) % (2 * math.pi)
        self.assertLess(abs(steps - (2 * math.pi - math.radians(1.8))).max(), 1e-5, "clockwise")
        brightest = max(turn, key=lambda line: max(line.intensities))
        self.assertEqual((len(brightest.ranges), brightest.angle_increment, brightest.header.frame_id), (300, 0, "sonar"))
        self.assertAlmostEqual(brightest.range_max, 6, delta=0.1)
        self.assertAlmostEqual(brightest.ranges[int(numpy.argmax(brightest.intensities))], math.hypot(3, 2) - 0.5, delta=0.1)
        self.assertAlmostEqual(brightest.angle_min, math.atan2(2, 3), delta=math.radians(9))

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

    def test_a_micron_comes_back(self):
        self.comes_back(MICRON, "scan", type="micron")

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
        program = self.node("sonar_bridge", "type=oculus")
        self.assertEqual(program.wait(PATIENCE_S), 1)
        self.assertEqual(program.output(), "parameter type is 'oculus', expected gemini or micron")


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard")
    options, rest = parser.parse_known_args()
    PROGRAMS = os.path.abspath(options.programs)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
