# SPDX-License-Identifier: Apache-2.0
"""Start and end of both nodes."""

import sys
from typing import Callable

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


def run(make_node: Callable[[], Node]) -> int:
    """Runs the node until ROS is shut down. Returns the exit code: 1 if a parameter is invalid."""
    rclpy.init()
    try:
        return _spin(make_node)
    except (KeyboardInterrupt, ExternalShutdownException):  # Ctrl-C may also come while the node is made
        return 0
    finally:
        rclpy.try_shutdown()


def _spin(make_node: Callable[[], Node]) -> int:
    try:
        node = make_node()
    except ValueError as error:
        print(error, file=sys.stderr)
        return 1
    try:
        rclpy.spin(node)
    finally:
        node.destroy_node()
    return 0
