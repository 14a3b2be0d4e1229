# SPDX-License-Identifier: Apache-2.0
"""The parameters of both nodes. The launch file has an argument for each; docs/simulators/ros2.md lists them."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Optional, Sequence, Union

from rcl_interfaces.msg import ParameterDescriptor
from rclpy.node import Node

Value = Union[str, int, float]


@dataclass(frozen=True)
class Parameter:
    """A parameter of a node. If given, `lowest` and `highest` limit a number, and `choices` a text. The two nodes use
    different names, so that one launch file can have all of them as arguments."""

    name: str
    default: Value
    meaning: str
    lowest: Optional[float] = None
    highest: Optional[float] = None
    choices: Sequence[Value] = ()

    def checked(self, value: Value) -> Value:
        """Returns the value in the type of the default. Raises ValueError if it is not allowed."""
        if self.choices and value not in self.choices:
            raise ValueError(f"parameter {self.name} is '{value}', expected {' or '.join(str(choice) for choice in self.choices if choice != '')}")
        if self.lowest is not None and self.highest is not None:
            is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
            if not is_number or not self.lowest <= float(value) <= self.highest:
                raise ValueError(f"parameter {self.name} is {value}, expected a number from {self.lowest:g} to {self.highest:g}")
        return type(self.default)(value)


POSE_BRIDGE = (
    Parameter("source", "odometry", "source of the poses", choices=("odometry", "pose", "tf")),
    Parameter("topic", "/odom", "topic of nav_msgs/Odometry, or of geometry_msgs/PoseStamped with source pose"),
    Parameter("world_frame", "world", "the frame of sonard's world"),
    Parameter("base_frame", "base_link", "the vehicle's frame; source tf only"),
    Parameter("rate_hz", 50.0, "rate at which tf is read, in Hz; source tf only", 1.0, 1000.0),
    Parameter("axes", "enu_flu", "ned_frd if z points down", choices=("enu_flu", "ned_frd")),
    Parameter("host", "127.0.0.1", "address of sonard's pose input"),
    Parameter("port", 14600, "UDP port of sonard's pose input", 1, 65535),
)

SONAR_BRIDGE = (
    Parameter("type", "gemini", "the type of head", choices=("gemini", "micron")),
    Parameter("device", "", "former name of type; it is used if it is set", choices=("", "gemini", "micron")),
    Parameter("frame_id", "sonar", "the head's frame: x ahead, y to port, z up"),
    Parameter("range_m", 20.0, "range of the pings in metres", 1.0, 150.0),
    Parameter("gain_percent", 50.0, "gain of the head in percent", 0.0, 100.0),
    Parameter("sound_speed_mps", 1500.0, "sound speed in m/s, to convert times to ranges", 1400.0, 1600.0),
    Parameter("interval_s", 0.1, "seconds from ping to ping; Gemini", 0.01, 60.0),
    Parameter("compression", 1, "2^n range lines are averaged into one; Gemini", 0, 4),
    Parameter("bits", 8, "bits per sample; Gemini", choices=(8, 16)),
    Parameter("sonar_id", 0, "ID of the head; 0: the first whose status arrives; Gemini", 0, 65535),
    Parameter("local", "", "address of this machine to send from; empty: the one that routes to the head; Gemini"),
    Parameter("micron_host", "127.0.0.1", "address of the Micron's device server"),
    Parameter("micron_port", 4001, "TCP port of the Micron's device server", 1, 65535),
    Parameter("step_deg", 1.8, "degrees from line to line; Micron", 0.06, 14.3),
    Parameter("bins", 400, "bins per line; Micron", 20, 1500),
)


def declare(node: Node, parameters: Sequence[Parameter]) -> SimpleNamespace:
    """Declares the parameters and returns their values by name. ROS must reject later changes, because they are read only
    at the start. An integer is accepted for a float. Raises ValueError."""
    values = {}
    for parameter in parameters:
        descriptor = ParameterDescriptor(description=parameter.meaning, read_only=True,
                                         dynamic_typing=isinstance(parameter.default, float))
        value = node.declare_parameter(parameter.name, parameter.default, descriptor).value
        values[parameter.name] = parameter.checked(value)
    return SimpleNamespace(**values)
