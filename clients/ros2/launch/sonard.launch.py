# SPDX-License-Identifier: Apache-2.0
"""Starts both nodes: poses go to sonard, pings of its head come back. Each parameter of the nodes is an argument.

    ros2 launch sonard_ros2 sonard.launch.py topic:=/rov/odometry range_m:=30
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
from launch_ros.parameter_descriptions import ParameterValue
from sonard_ros2 import parameters


def _argument(parameter):
    return DeclareLaunchArgument(parameter.name, default_value=parameter.default_text(), description=parameter.meaning)


def _value(parameter):
    """Keeps a text parameter as text, even "1"; reads any other value as YAML."""
    value_type = str if isinstance(parameter.default, str) else None
    return ParameterValue(LaunchConfiguration(parameter.name), value_type=value_type)


def _node(executable, its_parameters):
    values = {parameter.name: _value(parameter) for parameter in (parameters.USE_SIM_TIME, *its_parameters)}
    return Node(package="sonard_ros2", executable=executable, name=executable, output="screen", parameters=[values])


def generate_launch_description():
    return LaunchDescription([
        *map(_argument, (parameters.USE_SIM_TIME, *parameters.POSE_BRIDGE, *parameters.SONAR_BRIDGE)),
        _node("pose_bridge", parameters.POSE_BRIDGE),
        _node("sonar_bridge", parameters.SONAR_BRIDGE),
    ])
