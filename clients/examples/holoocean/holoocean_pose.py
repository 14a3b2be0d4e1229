# SPDX-License-Identifier: Apache-2.0
"""The state of a HoloOcean agent as a message for sonard (docs/simulators/unreal.md).

The agent needs a PoseSensor, and had better have a VelocitySensor and an IMUSensor; all in one socket, whose pose it is.
Needs python3-protobuf and, once, the message module beside this file:
    protoc --proto_path=protocol/pose --python_out=clients/examples/holoocean pose.proto
"""
import math

import pose_pb2


def pose_update(state):
    """HoloOcean's own axes are right-handed, in metres: x forward, y left, z up. Its world's x is taken for east."""
    pose = state["PoseSensor"]  # 4 x 4, from the agent's axes to the world's
    update = pose_pb2.PoseUpdate(time_ns=round(state["t"] * 1e9), frame=pose_pb2.FRAME_ENU_FLU)
    position, orientation = update.vehicle.position_m, update.vehicle.orientation
    position.x, position.y, position.z = (float(pose[i][3]) for i in range(3))
    orientation.w, orientation.x, orientation.y, orientation.z = quaternion(pose)
    if "VelocitySensor" in state:  # in the world's axes
        velocity = state["VelocitySensor"]
        linear = update.twist.linear_mps
        linear.x, linear.y, linear.z = (float(sum(pose[i][axis] * velocity[i] for i in range(3))) for axis in range(3))
        if "IMUSensor" in state:  # accelerations, then turn rates, on board
            angular = update.twist.angular_radps
            angular.x, angular.y, angular.z = (float(rate) for rate in state["IMUSensor"][1])
    return update


def quaternion(pose):
    """(w, x, y, z) of the rotation in the upper left 3 x 3."""
    trace = sum(pose[i][i] for i in range(3))
    # The squares of the four parts, times four; the largest one is divided by.
    squares = [1 + trace] + [1 + 2 * pose[i][i] - trace for i in range(3)]
    largest = max(range(4), key=squares.__getitem__)
    parts = [[squares[0], pose[2][1] - pose[1][2], pose[0][2] - pose[2][0], pose[1][0] - pose[0][1]],
             [pose[2][1] - pose[1][2], squares[1], pose[1][0] + pose[0][1], pose[0][2] + pose[2][0]],
             [pose[0][2] - pose[2][0], pose[1][0] + pose[0][1], squares[2], pose[2][1] + pose[1][2]],
             [pose[1][0] - pose[0][1], pose[0][2] + pose[2][0], pose[2][1] + pose[1][2], squares[3]]]
    return [float(part) / (2 * math.sqrt(squares[largest])) for part in parts[largest]]
