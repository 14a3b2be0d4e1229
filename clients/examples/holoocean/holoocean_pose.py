# SPDX-License-Identifier: Apache-2.0
"""Converts the state of a HoloOcean agent to a message for sonard (docs/simulators/unreal.md).

The agent needs a PoseSensor and should have a VelocitySensor and an IMUSensor. Attach all to one socket; its pose is
sent. Needs python3-protobuf and the message module beside this file, which you make once:
    protoc --proto_path=protocol/pose --python_out=clients/examples/holoocean pose.proto
"""
import math

import pose_pb2


def pose_update(state):
    """HoloOcean's axes are right-handed, in metres: x forward, y left, z up. The world's x is sent as east."""
    pose = state["PoseSensor"]  # 4 x 4, from the agent's axes to the world's
    update = pose_pb2.PoseUpdate(time_ns=round(state["t"] * 1e9), frame=pose_pb2.FRAME_ENU_FLU)
    position, orientation = update.vehicle.position_m, update.vehicle.orientation
    position.x, position.y, position.z = (float(pose[i][3]) for i in range(3))
    orientation.w, orientation.x, orientation.y, orientation.z = quaternion(pose)
    if "VelocitySensor" in state:  # in the world's axes
        velocity = state["VelocitySensor"]
        linear = update.twist.linear_mps
        linear.x, linear.y, linear.z = (float(sum(pose[i][axis] * velocity[i] for i in range(3))) for axis in range(3))
        if "IMUSensor" in state:  # accelerations and turn rates, in the agent's axes
            angular = update.twist.angular_radps
            angular.x, angular.y, angular.z = (float(rate) for rate in state["IMUSensor"][1])
    return update


def quaternion(pose):
    """The quaternion (w, x, y, z) of the rotation in the upper left 3 x 3."""
    trace = sum(pose[i][i] for i in range(3))
    # The squares of the four components, times four. The largest is the divisor.
    squares = [1 + trace] + [1 + 2 * pose[i][i] - trace for i in range(3)]
    largest = max(range(4), key=squares.__getitem__)
    parts = [[squares[0], pose[2][1] - pose[1][2], pose[0][2] - pose[2][0], pose[1][0] - pose[0][1]],
             [pose[2][1] - pose[1][2], squares[1], pose[1][0] + pose[0][1], pose[0][2] + pose[2][0]],
             [pose[0][2] - pose[2][0], pose[1][0] + pose[0][1], squares[2], pose[2][1] + pose[1][2]],
             [pose[1][0] - pose[0][1], pose[0][2] + pose[2][0], pose[2][1] + pose[1][2], squares[3]]]
    return [float(part) / (2 * math.sqrt(squares[largest])) for part in parts[largest]]
