# SPDX-License-Identifier: Apache-2.0
"""Start and end of a node, the same for both."""

import sys
from typing import Callable

import rclpy
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node


def run(make_node: Callable[[], Node]) -> int:
    """Until ROS is shut down. The exit code: 1 where a parameter is wrong."""
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
