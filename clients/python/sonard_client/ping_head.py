# SPDX-License-Identifier: Apache-2.0
"""What the clients of a Ping1D and of a Ping360 share: frames by UDP. Section numbers in comments refer to
protocol/ping360/README.md."""

from __future__ import annotations

import socket
import struct
import time
from typing import Callable, Iterator, Optional, TypeVar

from .ping import NoHead

NACK, PROTOCOL_VERSION, GENERAL_REQUEST = 2, 5, 6
ATTEMPTS = 5
_Self = TypeVar("_Self", bound="PingHead")


def frame(message: int, payload: bytes) -> bytes:
    """Encodes a frame (1)."""
    front = b"BR" + struct.pack("<HHBB", len(payload), message, 0, 0) + payload
    return front + struct.pack("<H", sum(front) & 0xFFFF)


def frames(buffer: bytearray) -> Iterator[tuple[int, bytes]]:
    """Removes whole frames from the received bytes; number and payload of each (1.1)."""
    while (start := buffer.find(b"BR")) >= 0 and len(buffer) >= start + 10:
        del buffer[:start]
        length, message = struct.unpack_from("<HH", buffer, 2)
        if len(buffer) < length + 10 and length <= 4096:
            return
        if length <= 4096 and sum(buffer[: length + 8]) & 0xFFFF == struct.unpack_from("<H", buffer, length + 8)[0]:
            payload = bytes(buffer[8: length + 8])
            del buffer[: length + 10]
            yield message, payload
        else:
            del buffer[:1]


class PingHead:
    """A client of one head at HOST:PORT. Use it from one thread at a time."""

    def __init__(self, host: str, port: int, patience_s: float) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._buffer = bytearray()
        self._ready: list[tuple[int, bytes]] = []
        try:
            self._socket.connect((host, port))
            for _ in range(ATTEMPTS):
                if self._ask(GENERAL_REQUEST, struct.pack("<H", PROTOCOL_VERSION), PROTOCOL_VERSION, patience_s / ATTEMPTS):
                    return
            raise NoHead(f"no answer from {host}:{port} within {patience_s} s: check that the head is on")
        except BaseException:
            self.close()
            raise

    def __enter__(self: _Self) -> _Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._socket.close()

    def _ask(self, message: int, payload: bytes, wanted: int, wait_s: float,
             fits: Callable[[bytes], bool] = lambda payload: True) -> Optional[bytes]:
        """Sends a message. Returns the payload of the answer `wanted` that fits; None if none comes. Raises ValueError if
        the head refuses the message."""
        self._send(message, payload)
        return self._receive(wanted, wait_s, fits, message)

    def _send(self, message: int, payload: bytes) -> None:
        try:
            self._socket.send(frame(message, payload))
        except ConnectionRefusedError:  # nothing listened when an earlier message came
            pass

    def _receive(self, wanted: int, wait_s: float, fits: Callable[[bytes], bool] = lambda payload: True,
                 asked: int = -1) -> Optional[bytes]:
        """The payload of the next message `wanted` that fits; None if none comes. Raises ValueError if the head refuses the
        message `asked`."""
        until_s = time.monotonic() + wait_s
        while True:
            while self._ready:
                number, payload = self._ready.pop(0)
                if number == NACK and len(payload) >= 2 and struct.unpack_from("<H", payload)[0] == asked:
                    raise ValueError(f"the head refuses message {asked}: {payload[2:].decode(errors='replace')}")
                if number == wanted and fits(payload):
                    return payload
            left_s = until_s - time.monotonic()
            if left_s <= 0:
                return None
            self._socket.settimeout(left_s)
            try:
                self._buffer += self._socket.recv(65536)
            except (TimeoutError, socket.timeout):
                return None
            except ConnectionRefusedError:  # nothing listens at this port, now
                time.sleep(max(0.0, until_s - time.monotonic()))
                return None
            self._ready += frames(self._buffer)
