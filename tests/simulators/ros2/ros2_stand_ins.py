# SPDX-License-Identifier: Apache-2.0
"""The names of rclpy, tf2_ros, launch and launch_ros that clients/ros2 uses. Import this before sonard_ros2.

One "ROS" for the process: `ros.parameters` are the start parameters of a node, `ros.published` the published messages by
topic, `ros.log` the log lines. publish() passes a message to the subscribers of a topic.
"""

import inspect
import os
import signal
import sys
import threading
import time
from types import ModuleType, SimpleNamespace

from ros2_messages import CLASSES

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "clients", "ros2"), os.path.join(SOURCE, "clients", "python")]


class ExternalShutdownException(Exception):
    pass


class TransformException(Exception):
    pass


class ParameterException(Exception):
    pass


class InvalidParameterTypeException(ParameterException):
    pass


class InvalidParameterValueException(ParameterException):
    pass


class Policy:
    """The names of a policy of quality of service."""

    def __init__(self, *names):
        self.__dict__.update({name: name for name in names})


Durability, Reliability = Policy("TRANSIENT_LOCAL", "VOLATILE"), Policy("RELIABLE", "BEST_EFFORT")


class QoSProfile:
    def __init__(self, *, depth, reliability, durability):
        self.depth, self.reliability, self.durability = depth, reliability, durability


class Ros:
    def __init__(self):
        self.news = threading.Condition()
        self.stopped = threading.Event()
        self.echo = False  # log lines are printed, too
        self.reset()

    def reset(self, **parameters):
        self.parameters = parameters
        self.published, self.log, self.subscriptions, self.timers, self.transforms = {}, [], {}, [], {}
        self.qualities = {}  # of the published topics
        self.ignored = set()  # published topics without a subscriber
        self.simulated_ns = 0  # of /clock, for use_sim_time
        self.live_nodes = 0
        self.declared, self.descriptors = {}, {}
        self.stopped.clear()

    def add(self, topic, message):
        with self.news:
            self.published.setdefault(topic, []).append(message)
            self.news.notify_all()

    def say(self, level, text):
        with self.news:
            self.log.append((level, text))
            self.news.notify_all()
        if self.echo:
            print(f"[{level}] {text}", flush=True)

    def wait(self, condition, seconds):
        """Waits until condition() is true and returns its value; fails after `seconds`."""
        with self.news:
            if not self.news.wait_for(condition, seconds):
                raise AssertionError(f"nothing within {seconds} s; the log has {self.log}, "
                                     f"topics have {({topic: len(all_) for topic, all_ in self.published.items()})}")
            return condition()

    def publish(self, topic, message):
        kind, callback, _ = self.subscriptions[topic]
        assert isinstance(message, kind), f"{topic} is of {kind}"
        callback(message)


ros = Ros()


class Time:
    def __init__(self, *, nanoseconds=0):
        assert isinstance(nanoseconds, int)
        if nanoseconds < 0:
            raise ValueError("nanoseconds must not be negative")
        self.nanoseconds = nanoseconds

    def to_msg(self):
        return CLASSES["builtin_interfaces/Time"](sec=self.nanoseconds // 10**9, nanosec=self.nanoseconds % 10**9)


class Publisher:
    def __init__(self, kind, topic):
        self._kind, self._topic = kind, topic

    def get_subscription_count(self):
        return int(self._topic not in ros.ignored)

    def publish(self, message):
        assert not ros.stopped.is_set(), "publish() after shutdown"
        assert isinstance(message, self._kind), f"{self._topic} is of {self._kind}"
        ros.add(self._topic, message)


class Logger:
    def info(self, text):
        ros.say("info", text)

    def warning(self, text):
        ros.say("warning", text)

    def error(self, text, *, throttle_duration_sec=None):
        ros.say("error", text)


class Node:
    def __init__(self, name):
        self.name = name
        self.context = SimpleNamespace(ok=lambda: not ros.stopped.is_set())
        ros.live_nodes += 1

    def declare_parameter(self, name, default, descriptor):
        assert isinstance(descriptor, CLASSES["rcl_interfaces/ParameterDescriptor"])
        assert name not in ros.declared, f"{name} is declared twice"
        ros.declared[name] = default
        ros.descriptors[name] = descriptor
        value = ros.parameters.get(name, default)
        if type(value) is not type(default) and not descriptor.dynamic_typing:
            raise InvalidParameterTypeException(f"{name} is {value!r}, expected {type(default)}")
        for limits in {int: descriptor.integer_range, float: descriptor.floating_point_range}.get(type(value), ()):
            if value < limits.from_value or value > limits.to_value:  # NaN passes, as in rclpy
                raise InvalidParameterValueException(f"{value} is not within {limits.from_value:g} to {limits.to_value:g}")
        return SimpleNamespace(value=value)

    def create_subscription(self, kind, topic, callback, qos):
        ros.subscriptions[topic] = (kind, callback, qos)

    def create_publisher(self, kind, topic, qos):
        ros.published.setdefault(topic, [])
        ros.qualities[topic] = qos
        return Publisher(kind, topic)

    def create_timer(self, period_s, callback):
        ros.timers.append((period_s, callback))

    def get_clock(self):
        simulated = ros.parameters.get("use_sim_time", False)
        return SimpleNamespace(now=lambda: Time(nanoseconds=ros.simulated_ns if simulated else time.time_ns()))

    def get_logger(self):
        return Logger()

    def destroy_node(self):
        ros.live_nodes -= 1


class Buffer:
    def lookup_transform(self, target_frame, source_frame, when):
        assert isinstance(when, Time) and when.nanoseconds == 0, "the newest"
        if (target_frame, source_frame) not in ros.transforms:
            raise TransformException(f'"{source_frame}" is not connected to "{target_frame}"')
        return ros.transforms[target_frame, source_frame]


class TransformBroadcaster:
    TOPIC = "/tf"

    def __init__(self, node):
        self._publisher = node.create_publisher(CLASSES["geometry_msgs/TransformStamped"], self.TOPIC, 1)

    def sendTransform(self, transforms):  # noqa: N802: as tf2_ros has it
        for transform in transforms if isinstance(transforms, list) else [transforms]:
            self._publisher.publish(transform)


class StaticTransformBroadcaster(TransformBroadcaster):
    TOPIC = "/tf_static"


def _init(args=None):
    """As in rclpy, SIGINT and SIGTERM shut ROS down from here on, and SIGINT raises KeyboardInterrupt, too."""
    def interrupt(number, frame):
        ros.stopped.set()
        signal.default_int_handler(number, frame)
    signal.signal(signal.SIGINT, interrupt)
    signal.signal(signal.SIGTERM, lambda *_: ros.stopped.set())


def _spin(node):
    while not ros.stopped.wait(0.02):
        pass
    raise ExternalShutdownException


class _Made:
    """An action or substitution of launch; stores its arguments after checking their names."""

    def __init__(self, *arguments, **named):
        known = inspect.signature(self.signature).parameters
        assert set(named) <= set(known), f"{type(self).__name__} does not know {set(named) - set(known)}"
        self.__dict__.update(zip(known, arguments))
        self.__dict__.update(named)


class LaunchDescription(_Made):
    @staticmethod
    def signature(entities):
        pass


class DeclareLaunchArgument(_Made):
    @staticmethod
    def signature(name, default_value, description, choices):
        pass


class LaunchConfiguration(_Made):
    @staticmethod
    def signature(variable_name):
        pass


class LaunchedNode(_Made):
    @staticmethod
    def signature(package, executable, name, namespace, parameters, remappings, output):
        pass


class ParameterValue(_Made):
    @staticmethod
    def signature(value, value_type):
        pass


def _install(**modules):
    for name, members in modules.items():
        name = name.replace("__", ".")
        module = sys.modules.setdefault(name, ModuleType(name))
        module.__dict__.update(members)


SENSOR_DATA = "best effort, depth 5"

_install(
    rclpy={"init": _init, "spin": _spin, "try_shutdown": ros.stopped.set},
    rclpy__node={"Node": Node}, rclpy__time={"Time": Time},
    rclpy__executors={"ExternalShutdownException": ExternalShutdownException},
    rclpy__exceptions={"ParameterException": ParameterException},
    rclpy__qos={"qos_profile_sensor_data": SENSOR_DATA, "QoSProfile": QoSProfile, "DurabilityPolicy": Durability,
                "ReliabilityPolicy": Reliability},
    tf2_ros={"Buffer": Buffer, "TransformException": TransformException, "TransformListener": lambda buffer, node: None,
             "StaticTransformBroadcaster": StaticTransformBroadcaster, "TransformBroadcaster": TransformBroadcaster},
    launch={"LaunchDescription": LaunchDescription},
    launch__actions={"DeclareLaunchArgument": DeclareLaunchArgument},
    launch__substitutions={"LaunchConfiguration": LaunchConfiguration},
    launch_ros={}, launch_ros__actions={"Node": LaunchedNode},
    launch_ros__parameter_descriptions={"ParameterValue": ParameterValue})
