# SPDX-License-Identifier: Apache-2.0
"""A parameter of a node: what it may be, and how it is declared."""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Optional, Sequence, Tuple, Union

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import ParameterException
from rclpy.node import Node

Value = Union[str, bool, int, float, Tuple[float, ...]]


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

    def descriptor(self) -> ParameterDescriptor:
        """ROS rejects later changes, because parameters are read only at the start. An integer is accepted for a float."""
        is_real = isinstance(self.default, (float, tuple))
        descriptor = ParameterDescriptor(description=self.meaning, read_only=True, dynamic_typing=is_real,
                                         additional_constraints=self._choices())
        if self.lowest is not None and self.highest is not None:
            lowest, highest = self.lowest, self.highest
            if isinstance(self.default, float):
                descriptor.floating_point_range = [FloatingPointRange(from_value=float(lowest), to_value=float(highest))]
            else:
                descriptor.integer_range = [IntegerRange(from_value=int(lowest), to_value=int(highest), step=1)]
        return descriptor

    def default_text(self) -> str:
        """The default as YAML."""
        if isinstance(self.default, bool):
            return str(self.default).lower()
        return str(list(self.default) if isinstance(self.default, tuple) else self.default)

    def checked(self, value: Value) -> Value:
        """Returns the value in the type of the default. Raises ValueError if it is not allowed."""
        if self.choices and value not in self.choices:
            raise ValueError(f"parameter {self.name} is '{value}', expected {self._choices()}")
        if isinstance(self.default, tuple):
            return self._numbers(value)
        if self.lowest is not None and self.highest is not None:
            if not _is_number(value) or not self.lowest <= float(value) <= self.highest:
                raise ValueError(f"parameter {self.name} is {value}, expected a number from {self.lowest:g} to {self.highest:g}")
        return type(self.default)(value)

    def _numbers(self, value: Value) -> Value:
        if not hasattr(value, "__len__") or len(value) != len(self.default) or not all(map(_is_number, value)):
            raise ValueError(f"parameter {self.name} is {value}, expected {len(self.default)} numbers")
        return tuple(map(float, value))

    def _choices(self) -> str:
        return " or ".join(str(choice) for choice in self.choices if choice != "")


def _is_number(value: Value) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < float("inf")


def declare(node: Node, parameters: Sequence[Parameter]) -> SimpleNamespace:
    """Declares the parameters and returns their values by name. Raises ValueError, which names the parameter."""
    values = {}
    for parameter in parameters:
        default = list(parameter.default) if isinstance(parameter.default, tuple) else parameter.default
        try:
            value = node.declare_parameter(parameter.name, default, parameter.descriptor()).value
        except ParameterException as error:  # of another type, or out of range
            raise ValueError(f"parameter {parameter.name}, {parameter.meaning}: {error}") from error
        values[parameter.name] = parameter.checked(value)
    return SimpleNamespace(**values)
