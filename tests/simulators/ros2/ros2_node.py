#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A node of clients/ros2 as a process, with stand-ins for rclpy; its log goes to standard output.

    ros2_node.py pose_bridge|sonar_bridge [NAME=VALUE ...]      parameters, as in YAML
"""

import importlib
import json
import sys

from ros2_stand_ins import ros


def value(text):
    try:
        return json.loads(text)
    except ValueError:
        return text


ros.reset(**{name: value(text) for name, text in (argument.split("=", 1) for argument in sys.argv[2:])})
ros.echo = True
sys.exit(importlib.import_module("sonard_ros2." + sys.argv[1]).main())
