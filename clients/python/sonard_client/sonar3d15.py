# SPDX-License-Identifier: Apache-2.0
"""A client for a Water Linked Sonar 3D-15: images by UDP, settings by HTTP, and recordings. Section numbers in comments refer
to protocol/sonar3d15/README.md."""

from __future__ import annotations

import http.client
import json
import math
import mmap
import socket
import struct
import time
import zlib
from dataclasses import dataclass
from os import PathLike
from typing import Any, Iterable, Iterator, Optional, Union

import numpy as np

from .ping import Array, NoHead, NoPing

_GROUP, _PORT = "224.0.0.96", 4747
_BASE = "/api/v1/integration/"
_TYPES = "type.googleapis.com/waterlinked.sonar.protocol."
_MOST_PACKET = 65507


@dataclass(frozen=True)
class Shot:
    """The two images of a shot: the strongest echo in each direction.

    ranges_m      (rows, columns): along the direction, 0: no echo. Rows from the lowest, columns from port to starboard
    signals       (rows, columns), uint8: 100 more are ten times the amplitude, 0: no echo
    bearings_rad, elevations_rad  of the columns, positive to port, and of the rows, positive up
    number        of the shot: 1 more for each
    time_ns       of the shot by the clock of the head, since the Unix epoch
    range_m, sound_speed_mps  settings behind the images
    """

    ranges_m: Array
    signals: Array
    bearings_rad: Array
    elevations_rad: Array
    number: int
    time_ns: int
    range_m: float
    sound_speed_mps: float

    def points_m(self) -> Array:
        """x ahead, y to port, z up (REP-103) of each direction with an echo, (echoes, 3), row after row."""
        level_m = self.ranges_m * np.cos(self.elevations_rad)[:, None]
        points = np.stack([level_m * np.cos(self.bearings_rad), level_m * np.sin(self.bearings_rad),
                           self.ranges_m * np.sin(self.elevations_rad)[:, None]], axis=-1)
        return points[self.ranges_m > 0]

    def strengths(self) -> Array:
        """The linear strength of each echo, in the order of points_m()."""
        return 30 * 10 ** (self.signals[self.ranges_m > 0] / 100)


@dataclass(frozen=True)
class ImuBatch:
    """Readings of the motion sensor. Axes: x ahead, y to starboard, z down, as the head has them."""

    number: int
    times_ns: Array  # (samples,)
    specific_force_mps2: Array  # (samples, 3)
    rate_of_turn_radps: Array  # (samples, 3)


@dataclass(frozen=True)
class Image:
    """One of the two images of a shot: ranges in units of `scale_m`, or signals, which have uint8 pixels and no scale."""

    pixels: Array  # (rows, columns), from the lowest row, from port
    number: int
    time_ns: int
    range_m: float
    sound_speed_mps: float
    fovs_rad: tuple[float, float]  # horizontal, vertical
    scale_m: float


def decode(packet: bytes) -> Union[Image, ImuBatch, None]:
    """The message in a packet; None if its type is unknown. Raises ValueError if the packet is damaged (1, 2)."""
    if len(packet) < 12 or struct.unpack_from("<I", packet, 4)[0] != len(packet):
        raise ValueError("the length of a packet is wrong")
    if zlib.crc32(packet[:-4]) != struct.unpack("<I", packet[-4:])[0]:
        raise ValueError("the checksum of a packet is wrong")
    if packet[:4] not in (b"RIP1", b"RIP2"):
        raise ValueError("a packet has an unknown id")
    try:
        payload = packet[8:-4]
        any_of = _fields(_fields(_unpacked(payload) if packet[:4] == b"RIP2" else payload)[1][0])
        kind, value = any_of[1][0].decode().rpartition("/")[2].rpartition(".")[2], _fields(any_of[2][0])
        if not any_of[1][0].startswith(_TYPES.encode()):
            return None
        if kind == "RangeImage":
            return _image(value, 5, _varints(value[10][0]), value[9][0])
        if kind == "BitmapImageGreyscale8":
            return None if value.get(5, [0])[0] else _image(value, 6, np.frombuffer(value[10][0], np.uint8), 0.0)
        return _imu_batch(value) if kind == "ImuBatch" else None
    except (IndexError, KeyError, struct.error, TypeError, AttributeError, OverflowError) as error:
        raise ValueError(f"a message is damaged: {error!r}") from error


def shots(packets: Iterable[bytes]) -> Iterator[Shot]:
    """The shots in packets. A range image and the signal image of the same number that follows it are one; other packets, also
    damaged ones, are passed over."""
    ranges: Optional[Image] = None
    for packet in packets:
        try:
            message = decode(packet)
        except ValueError:
            continue
        if not isinstance(message, Image):
            continue
        if message.scale_m:
            ranges = message
        elif ranges is not None and ranges.number == message.number and ranges.pixels.shape == message.pixels.shape:
            yield _shot(ranges, message)
            ranges = None


def read_sonar_file(path: Union[str, PathLike[str]]) -> Iterator[Shot]:
    """The shots of a .sonar file, of sonard or of a real head. Damaged parts are passed over (9)."""
    with open(path, "rb") as file:
        data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        yield from shots(_packets(data))


class Sonar3D15:
    """A client of one head, whose HTTP interface is at HOST:PORT. Use it from one thread at a time.

    interface  address of this machine that receives the images; empty: the one that routes to the head
    """

    def __init__(self, host: str = "127.0.0.5", port: int = 8080, interface: str = "", patience_s: float = 5.0) -> None:
        self._host, self._port, self._patience_s = host, port, patience_s
        self._switched_on = False
        try:
            self._address = socket.gethostbyname(host)
            self.version: str = self.get("about")["version_short"]
        except OSError as error:
            raise NoHead(f"no answer from {host}:{port} within {patience_s} s: check that the head is on") from error
        self._interface = interface or self._route()

    def __enter__(self) -> "Sonar3D15":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Switches acoustics off, if this client has switched them on."""
        if self._switched_on:
            self._switched_on = False
            try:
                self.set("acoustics/enabled", False)
            except OSError:
                pass  # the head is gone

    def get(self, path: str) -> Any:
        """The value of a path of the HTTP interface, such as "temperature" (5). Raises ValueError if the head refuses."""
        return json.loads(self._call("GET", path, None))

    def set(self, path: str, value: Any) -> None:
        """Sets the value of a path, such as "acoustics/range" to {"min": 0.3, "max": 10} (5). Raises ValueError if the head
        refuses it."""
        self._call("POST", path, json.dumps(value))

    def shot(self, **settings: Any) -> Shot:
        """The next shot with these settings of shots()."""
        return next(self.shots(**settings))

    def shots(self, range_m: float = 15.0, least_range_m: float = 0.3, high_frequency: bool = False,
              sound_speed_mps: float = 0.0) -> Iterator[Shot]:
        """Yields shot after shot, until the iterator is closed. All clients of the head share its settings.

        sound_speed_mps  that the head assumes; 0: it chooses

        Raises NoPing if no shots arrive, ValueError if the head refuses a setting.
        """
        newer = [int(part) for part in self.version.split(".")] >= [1, 7]
        self.set("acoustics/range", {"min": least_range_m, "max": range_m})
        if newer or high_frequency:
            self.set("acoustics/mode", "high-frequency" if high_frequency else "low-frequency")
        if newer or sound_speed_mps:
            self.set("acoustics/speed_of_sound", sound_speed_mps)
        udp = self.get("udp")
        if udp["mode"] == "disabled":
            udp = {**udp, "mode": "multicast"}
            self.set("udp", udp)
        with self._listen(udp) as images:
            received = shots(self._datagrams(images))
            if self.get("acoustics/enabled"):
                next(received)  # was under way when the settings changed
            else:
                self.set("acoustics/enabled", True)
                self._switched_on = True
            yield from received

    def _call(self, method: str, path: str, body: Optional[str]) -> bytes:
        connection = http.client.HTTPConnection(self._host, self._port, timeout=self._patience_s)
        try:
            connection.request(method, _BASE + path, body, {"Content-Type": "application/json"})
            reply = connection.getresponse()
            text = reply.read()
        except http.client.HTTPException as error:
            raise OSError(f"{self._host}:{self._port} does not answer as a head: {error!r}") from error
        finally:
            connection.close()
        if reply.status not in (200, 204):
            raise ValueError(f"the head refuses {method} {path} {body or ''}: status {reply.status}")
        return text

    def _route(self) -> str:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect((self._address, _PORT))
            return str(probe.getsockname()[0])

    def _listen(self, udp: dict[str, Any]) -> socket.socket:
        multicast = udp["mode"] == "multicast"
        images = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        images.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        images.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
        try:
            images.bind((_GROUP, _PORT) if multicast else ("", udp["unicast_destination_port"]))
            if multicast:
                images.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP,
                                  socket.inet_aton(_GROUP) + socket.inet_aton(self._interface))
        except OSError:
            images.close()
            raise
        return images

    def _datagrams(self, images: socket.socket) -> Iterator[bytes]:
        """Packets of this head. Others may send to the group, too (6)."""
        until_s = time.monotonic() + self._patience_s
        while (left_s := until_s - time.monotonic()) > 0:
            images.settimeout(left_s)
            try:
                packet, sender = images.recvfrom(_MOST_PACKET)
            except (TimeoutError, socket.timeout):
                break
            if sender[0] == self._address:
                until_s = time.monotonic() + self._patience_s
                yield packet
        raise NoPing("no shot arrived: check that the head has a pose, and that multicast reaches this machine")


def _shot(ranges: Image, signals: Image) -> Shot:
    rows, columns = ranges.pixels.shape
    bearing, elevation = ranges.fovs_rad[0] / 2, ranges.fovs_rad[1] / 2
    return Shot(ranges.pixels * ranges.scale_m, signals.pixels, np.linspace(bearing, -bearing, columns),
                np.linspace(-elevation, elevation, rows), ranges.number, ranges.time_ns, ranges.range_m, ranges.sound_speed_mps)


def _image(fields: dict[int, Any], at: int, pixels: Array, scale_m: float) -> Image:
    width, height = fields[at][0], fields[at + 1][0]
    if width < 2 or height < 2 or pixels.size != width * height:
        raise ValueError("an image has another number of pixels than its size says")
    header = _fields(fields[1][0])
    return Image(pixels.reshape(height, width), header.get(2, [0])[0], _time_ns(header.get(1, [b""])[0]), fields[3][0],
                 fields[2][0], (math.radians(fields[at + 2][0]), math.radians(fields[at + 3][0])), scale_m)


def _imu_batch(fields: dict[int, Any]) -> ImuBatch:
    force, turn = (np.frombuffer(fields[number][0], "<f4").reshape(-1, 3) for number in (4, 5))
    times_ns = np.array([_time_ns(stamp) for stamp in fields.get(3, [])], np.int64)
    if not len(times_ns) == len(force) == len(turn) == fields[2][0]:
        raise ValueError("a batch has another number of samples than it says")
    return ImuBatch(fields.get(1, [0])[0], times_ns, force, turn)


def _time_ns(stamp: bytes) -> int:
    fields = _fields(stamp)
    seconds: int = fields.get(1, [0])[0]
    return (seconds - (1 << 64) if seconds >> 63 else seconds) * 10**9 + int(fields.get(2, [0])[0])


def _varint(data: bytes, at: int) -> tuple[int, int]:
    """A number, and where the next byte is."""
    value = shift = 0
    while True:
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            return value, at


def _varints(data: bytes) -> Array:
    """Packed numbers below 2^28."""
    octets = np.frombuffer(data, np.uint8)
    ends = np.flatnonzero(octets < 0x80)
    starts = np.concatenate([[0], ends[:-1] + 1])
    if not len(ends) or ends[-1] != len(octets) - 1 or (ends - starts).max() > 3:
        raise ValueError("the pixels of an image are damaged")
    values = np.zeros(len(ends), np.uint32)
    for place in range(4):
        has = starts + place <= ends
        values[has] |= (octets[starts[has] + place].astype(np.uint32) & 0x7F) << np.uint32(7 * place)
    return values


def _fields(message: bytes) -> dict[int, list[Any]]:
    """The values of each field of a message of Protobuf, by number."""
    found: dict[int, list[Any]] = {}
    at = 0
    while at < len(message):
        key, at = _varint(message, at)
        value: Any
        if key & 7 == 0:
            value, at = _varint(message, at)
        elif key & 7 == 1:
            value, at = message[at:at + 8], at + 8
        elif key & 7 == 5:
            value, at = struct.unpack_from("<f", message, at)[0], at + 4
        elif key & 7 == 2:
            size, at = _varint(message, at)
            value, at = message[at:at + size], at + size
        else:
            raise ValueError("a message has a field of an unknown kind")
        if at > len(message):
            raise ValueError("a message is cut")
        found.setdefault(key >> 3, []).append(value)
    return found


def _unpacked(block: bytes) -> bytes:
    """A raw block of Snappy, unpacked (1)."""
    size, at = _varint(block, 0)
    out = bytearray()
    while at < len(block) and len(out) <= size:
        tag, at = block[at], at + 1
        kind, length = tag & 3, (tag >> 2) + 1
        if kind == 0:
            if length > 60:
                width = length - 60
                length, at = int.from_bytes(block[at:at + width], "little") + 1, at + width
            out += block[at:at + length]
            at += length
            continue
        if kind == 1:
            length, offset, at = (tag >> 2 & 7) + 4, tag >> 5 << 8 | block[at], at + 1
        else:
            width = 2 if kind == 2 else 4
            offset, at = int.from_bytes(block[at:at + width], "little"), at + width
        if not 0 < offset <= len(out):
            raise ValueError("a packet is packed wrongly")
        copied = out[-offset:][:length]
        out += (copied * (length // len(copied) + 1))[:length]
    if len(out) != size:
        raise ValueError("a packet is packed wrongly")
    return bytes(out)


def _packets(data: mmap.mmap) -> Iterator[bytes]:
    """Packets one after another, and those after damage."""
    at = data.find(b"RIP")
    while 0 <= at <= len(data) - 12:
        size = struct.unpack_from("<I", data, at + 4)[0]
        packet = data[at:at + size] if 12 <= size <= _MOST_PACKET else b""
        if len(packet) == size and zlib.crc32(packet[:-4]) == struct.unpack("<I", packet[-4:])[0]:
            yield packet
            at = data.find(b"RIP", at + size)
        else:
            at = data.find(b"RIP", at + 1)
