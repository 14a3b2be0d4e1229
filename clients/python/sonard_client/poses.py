# SPDX-License-Identifier: Apache-2.0
"""Encodes and sends poses for sonard as messages of protocol/pose/pose.proto, without a protobuf library.

pose.proto defines the field numbers. sonard rejects values beyond the limits below.
"""

from __future__ import annotations

import math
import socket
import struct
from typing import NamedTuple, Optional, Sequence

_FRAMES = {"enu_flu": 0, "ned_frd": 1}
_MAX_TIME_NS = 4 * 10**18
_MAX_COORDINATE_M = 1e8
_MAX_SPEED = 1e6  # m/s and rad/s
_MIN_NORM, _MAX_NORM = 1e-3, 1e3


def _varint(value: int) -> bytes:
    value &= (1 << 64) - 1  # protobuf encodes negative numbers as their two's complement in 64 bits
    data = bytearray()
    while value > 0x7F:
        data.append(value & 0x7F | 0x80)
        value >>= 7
    data.append(value)
    return bytes(data)


def _varint_field(number: int, value: int) -> bytes:
    return _varint(number << 3) + _varint(value)


def _message_field(number: int, body: bytes) -> bytes:
    return _varint(number << 3 | 2) + _varint(len(body)) + body


def _doubles(values: Sequence[float]) -> bytes:
    """A message whose fields 1, 2, 3, ... are doubles."""
    return b"".join(_varint(number << 3 | 1) + struct.pack("<d", value) for number, value in enumerate(values, 1))


def _vector(name: str, values: Sequence[float], highest: float) -> bytes:
    numbers = [float(value) for value in values]
    # NaN fails every comparison.
    if len(numbers) != 3 or not all(abs(number) <= highest for number in numbers):
        raise ValueError(f"{name} is {numbers}, expected three numbers within {highest:g}")
    return _doubles(numbers)


def _quaternion(values: Sequence[float]) -> bytes:
    numbers = [float(value) for value in values]
    if len(numbers) != 4 or not _MIN_NORM <= math.hypot(*numbers) <= _MAX_NORM:
        raise ValueError(f"quaternion_xyzw is {numbers}, expected four numbers whose norm is within "
                         f"{_MIN_NORM:g} to {_MAX_NORM:g}")
    x, y, z, w = numbers
    return _doubles((w, x, y, z))


class MovingBody(NamedTuple):
    """A moving object of the world, by the name of its model. The numbers are as for the vehicle in encode_pose(); the
    velocities are in the axes of the body."""

    name: str
    position_m: Sequence[float]
    quaternion_xyzw: Sequence[float]
    linear_mps: Optional[Sequence[float]] = None
    angular_radps: Optional[Sequence[float]] = None


def _pose(position_m: Sequence[float], quaternion_xyzw: Sequence[float]) -> bytes:
    return _message_field(1, _vector("position_m", position_m, _MAX_COORDINATE_M)) + \
        _message_field(2, _quaternion(quaternion_xyzw))


def _twist(linear_mps: Optional[Sequence[float]], angular_radps: Optional[Sequence[float]]) -> bytes:
    twist = b""
    if linear_mps is not None:
        twist += _message_field(1, _vector("linear_mps", linear_mps, _MAX_SPEED))
    if angular_radps is not None:
        twist += _message_field(2, _vector("angular_radps", angular_radps, _MAX_SPEED))
    return twist


def _body(body: MovingBody) -> bytes:
    if not body.name:
        raise ValueError("name is empty, expected the name of a body")
    twist = _twist(body.linear_mps, body.angular_radps)
    return _message_field(1, body.name.encode()) + _message_field(2, _pose(body.position_m, body.quaternion_xyzw)) + \
        (_message_field(3, twist) if twist else b"")


def encode_pose(time_ns: int, position_m: Sequence[float], quaternion_xyzw: Sequence[float],
                linear_mps: Optional[Sequence[float]] = None, angular_radps: Optional[Sequence[float]] = None,
                axes: str = "enu_flu", bodies: Sequence[MovingBody] = ()) -> bytes:
    """Encodes one PoseUpdate.

    time_ns          time of the pose, on any clock of the publisher
    position_m       of the vehicle's origin in the world
    quaternion_xyzw  rotates vectors from the vehicle's axes to the world's; its norm need not be 1
    linear_mps, angular_radps
                     velocities in the vehicle's axes. If only one is given, the other is 0. If both are missing, the pose
                     holds until the next one
    axes             enu_flu: world x east, y north, z up, vehicle x forward, y to port, z up, as in ROS;
                     ned_frd: world x north, y east, z down, vehicle x forward, y to starboard, z down
    bodies           other moving objects, with the same axes, each once

    Raises ValueError, which names the argument, if sonard would reject a number.
    """
    if not -_MAX_TIME_NS <= time_ns <= _MAX_TIME_NS:
        raise ValueError(f"time_ns is {time_ns}, expected a number within 4e18")
    if axes not in _FRAMES:
        raise ValueError(f"axes is '{axes}', expected enu_flu or ned_frd")
    if len({body.name for body in bodies}) < len(bodies):
        raise ValueError("bodies has a name twice")
    update = _varint_field(1, time_ns) + _varint_field(2, _FRAMES[axes]) + \
        _message_field(3, _pose(position_m, quaternion_xyzw))
    twist = _twist(linear_mps, angular_radps)
    return update + (_message_field(4, twist) if twist else b"") + \
        b"".join(_message_field(5, _body(body)) for body in bodies)


class PosePublisher:
    """Sends poses to sonard. Use it from one thread at a time.

    host, port  address of sonard: `poses.udp.bind` of its configuration, or `poses.tcp.bind`
    tcp         connect by TCP. No pose is lost then, and in lock-step (`poses.clock: simulated_lock_step`)
                send() waits while sonard still renders the pings of earlier poses

    Raises OSError if nothing listens (TCP).
    """

    def __init__(self, host: str = "127.0.0.1", port: int = 14600, tcp: bool = False) -> None:
        self._receiver = (host, port)
        self._tcp = tcp
        if tcp:
            self._socket = socket.create_connection(self._receiver)
            self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        else:
            self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)

    def __enter__(self) -> PosePublisher:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def send(self, time_ns: int, position_m: Sequence[float], quaternion_xyzw: Sequence[float],
             linear_mps: Optional[Sequence[float]] = None, angular_radps: Optional[Sequence[float]] = None,
             axes: str = "enu_flu", bodies: Sequence[MovingBody] = ()) -> None:
        """Sends one pose (arguments of encode_pose()); send at least 20 per second. Raises OSError if the host has no
        address or no route, and by TCP if sonard closed the connection. UDP does not report whether sonard listens."""
        message = encode_pose(time_ns, position_m, quaternion_xyzw, linear_mps, angular_radps, axes, bodies)
        if self._tcp:
            self._socket.sendall(_varint(len(message)) + message)
        else:
            self._socket.sendto(message, self._receiver)

    def finish(self, timeout_s: Optional[float] = None) -> None:
        """Ends the stream; by TCP waits until sonard has read all poses. Raises TimeoutError."""
        if self._tcp:
            self._socket.shutdown(socket.SHUT_WR)
            self._socket.settimeout(timeout_s)
            try:
                while self._socket.recv(1024):
                    pass
            except socket.timeout as error:
                raise TimeoutError(f"sonard did not read all poses within {timeout_s} s") from error
        self.close()

    def close(self) -> None:
        self._socket.close()
