# SPDX-License-Identifier: Apache-2.0
"""Messages of the Oculus, written from protocol/oculus/README.md, not from our C++ code: an independent check.

Section numbers are those of that page.
"""

import dataclasses
import struct

MAGIC = 0x4F53
FIRE, PING, USER_CONFIG, LOGS, DUMMY = 0x15, 0x23, 0x55, 0x80, 0xFF
STATUS_SIZE = 142
LOW, HIGH = 1, 2
STANDBY = 5

HEADER = struct.Struct("<HHHHHIH")  # 1
FIRE_BODY = struct.Struct("<BBBBBdddd")  # 3, behind the header
EXTENSION = struct.Struct("<I8I")
RESULT_1 = struct.Struct("<IIddddIBdHHIII")  # 4.1, from 53
RESULT_2 = struct.Struct("<IIdddddddd" "Bd" "HH" "4I" "III")  # 4.2, from 89
STATUS_BODY = struct.Struct("<IHHI6I4s4s4s6s8dd")  # 6, from 16


def header(message, version, size, source=0):
    return HEADER.pack(MAGIC, source, 0, message, version, size, 0)


def fire(mode=HIGH, rate=0, network=0xFF, gamma=0x7F, flags=0x0D, range_m=5.0, gain=50.0, speed=0.0, salinity=0.0, version=0,
         extension=None, states_size=True):
    """`extension`: extFlags of version 2."""
    body = FIRE_BODY.pack(mode, rate, network, gamma, flags, range_m, gain, speed, salinity)
    if extension is not None:
        body += EXTENSION.pack(extension, *(8 * [0]))
    return header(FIRE, version, len(body) if states_size else 0) + body


def user_config(address=b"\0\0\0\0", mask=b"\0\0\0\0"):
    return header(USER_CONFIG, 0, 12) + address + mask + bytes(4)


@dataclasses.dataclass
class Message:
    id: int
    version: int
    source: int
    part: int
    raw: bytes

    @property
    def body(self):
        return self.raw[16:]


class Stream:
    """Joins the bytes of a TCP stream into messages. Fails at bytes that do not begin a message."""

    def __init__(self):
        self._bytes = bytearray()

    def feed(self, data):
        self._bytes += data
        messages = []
        while len(self._bytes) >= HEADER.size:
            magic, source, _, kind, version, size, part = HEADER.unpack_from(self._bytes)
            if magic != MAGIC:
                raise AssertionError(f"no message begins with {bytes(self._bytes[:16]).hex()}")
            if len(self._bytes) < HEADER.size + size:
                break
            messages.append(Message(kind, version, source, part, bytes(self._bytes[:HEADER.size + size])))
            del self._bytes[:HEADER.size + size]
        return messages


@dataclasses.dataclass
class Ping:
    """With the checks of 4.3; for each check there is a client that makes it."""
    version: int
    mode: int
    rate: int
    gamma: int
    flags: int
    range_m: float
    gain: float
    speed: float
    salinity: float
    extension: int
    id: int
    frequency_hz: float
    temperature_c: float
    pressure_bar: float
    attitude_deg: tuple  # heading, pitch, roll; version 1 has none
    speed_used: float
    start_s: float
    width: int
    resolution_m: float
    ranges: int
    beams: int
    bearings_cdeg: list
    rows: list  # bytes of each, without the gain
    gains: list  # of the rows, where there are any


def ping_of(message):
    raw = message.raw
    assert message.id == PING
    mode, rate, _, gamma, flags, range_m, gain, speed, salinity = FIRE_BODY.unpack_from(raw, 16)
    extension, attitude = 0, ()
    if message.version == 2:
        extension = struct.unpack_from("<I", raw, 53)[0]
        (number, _, frequency, temperature, pressure, heading, pitch, roll, used, start, width, resolution, ranges, beams,
         *_, offset, size, whole) = RESULT_2.unpack_from(raw, 89)
        attitude = (heading, pitch, roll)
        fixed = 202
    else:
        (number, _, frequency, temperature, pressure, used, start, width, resolution, ranges, beams, offset, size,
         whole) = RESULT_1.unpack_from(raw, 53)
        start *= 1e-9
        fixed = 122
    width += 1
    lead = 4 if flags & 0x04 else 0
    stride = beams * width + lead
    assert size == ranges * stride, "liboculus drops it"
    assert offset + size == whole == len(raw), "the maker's code drops it"
    assert offset >= fixed + 2 * beams
    assert not any(raw[fixed + 2 * beams:offset])
    rows = [raw[at + lead:at + stride] for at in range(offset, whole, stride)]
    gains = [struct.unpack_from("<I", raw, at)[0] for at in range(offset, whole, stride)] if lead else []
    return Ping(message.version, mode, rate, gamma, flags, range_m, gain, speed, salinity, extension, number, frequency,
                temperature, pressure, attitude, used, start, width, resolution, ranges, beams,
                list(struct.unpack_from(f"<{beams}h", raw, fixed)), rows, gains)


@dataclasses.dataclass
class Status:
    source: int
    device_id: int
    part: int
    word: int
    address: str
    mask: str
    client: str
    temperatures: tuple
    pressure_bar: float


def status_of(datagram):
    assert len(datagram) == STATUS_SIZE, f"{len(datagram)} bytes: liboculus never listens again"
    magic, source, _, _, _, size, _ = HEADER.unpack_from(datagram)
    assert (magic, size) == (MAGIC, STATUS_SIZE - 16)
    device_id, kind, part, word, *rest = STATUS_BODY.unpack_from(datagram, 16)
    address, mask, client = (".".join(map(str, octets)) for octets in rest[6:9])
    assert kind == 1
    return Status(source, device_id, part, word, address, mask, client, tuple(rest[10:18]), rest[18])
