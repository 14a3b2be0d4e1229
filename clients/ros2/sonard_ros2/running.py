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
        node = make_node()
    except ValueError as error:
        print(error, file=sys.stderr)
        rclpy.try_shutdown()
        return 1
    try:
        rclpy.spin(node)
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0
