# SPDX-License-Identifier: Apache-2.0
"""The few messages that these tests send and read themselves, written from protocol/gemini/README.md and
protocol/pose/pose.proto, without our C++ code: an independent check of every byte."""

import math
import struct
import zlib

STATUS, PING_HEAD, PING_LINE, PING_TAIL, ACKNOWLEDGE = 0x40, 0x41, 0x42, 0x43, 0x49
LINE_RATE_HZ = 90422.0


def header(message_type, sonar_id):
    return struct.pack("<BBHHBB", message_type, 1, sonar_id, 0, 0, 0)


def status_request(sonar_id):
    return header(0x20, sonar_id)


def ping_config(sonar_id, lines, continuous_ms=None, sound_speed_mps=1500.0, spreading=67):
    """0x21 (section 5): 8 bit, also pings out of water, speed of sound from the configuration, no compression."""
    body = struct.pack("<4H", 0, 0, 0, 0)
    body += struct.pack("<HH", 0 if continuous_ms is None else 1, 0x0204)  # runMode, extMode
    body += struct.pack("<HHI", 0, lines, 1000 * (continuous_ms or 200))  # startRange, endRange, interping
    body += struct.pack("<HHHH", 4, 0, 0xC3E8, 0)  # txLength, txAngle, mainGain, absorption
    body += struct.pack("<IHHHH", 0x1E00, spreading, 0, 7, 1)  # softwareGain, spreading, autoGain, filter, shade
    body += struct.pack("<HHHHHH", round(sound_speed_mps * 10), 1, 0, 0, 0, 0)  # spdSnd, velMode, comp, RLE, ..
    body += struct.pack("<BBHBBBB", 1, 29, 0, 1, 18, 30, 17)
    message = header(0x21, sonar_id) + body
    assert len(message) == 68
    return message


def retry_lines(sonar_id, first, count):
    return header(0x30, sonar_id) + struct.pack("<HHHH", 1, first, count, 0)


def message_type(datagram):
    return datagram[0] if datagram else None


class Status:
    """0x40 (3.3)."""

    def __init__(self, datagram):
        assert len(datagram) == 110
        self.header_id = struct.unpack_from("<H", datagram, 2)[0]
        self.sonar_id = struct.unpack_from("<H", datagram, 10)[0]
        self.fixed, self.alternate, self.client = struct.unpack_from("<III", datagram, 12)
        self.netmask = struct.unpack_from("<I", datagram, 58)[0]
        self.boot = struct.unpack_from("<I", datagram, 68)[0]


def address(text):
    octets = [int(part) for part in text.split(".")]
    return octets[0] << 24 | octets[1] << 16 | octets[2] << 8 | octets[3]


class Ping:
    """Collects one ping of 256 beams, 8 bit, uncompressed."""

    def __init__(self, head):
        assert len(head) == 48
        self.id, self.ext_mode, low, high = struct.unpack_from("<HHII", head, 8)
        self.transmit_us = high << 32 | low
        self.start, self.end = struct.unpack_from("<HH", head, 20)
        self.beams = struct.unpack_from("<H", head, 28)[0]
        self.compression = head[45]
        self.count = (self.end - self.start) >> self.compression
        self.lines = {}
        self.tail = False

    def add(self, datagram):
        if message_type(datagram) == PING_LINE and datagram[9] == self.id & 0xFF:
            line = struct.unpack_from("<H", datagram, 10)[0] & 0x7FFF
            self.lines[line] = datagram[16:16 + self.beams]
        elif message_type(datagram) == PING_TAIL and datagram[8] == self.id & 0xFF:
            self.tail = True

    def complete(self):
        return self.tail and len(self.lines) == self.count

    def crc32(self):
        return zlib.crc32(b"".join(self.lines[i] for i in range(self.count)))


def bearing_rad(beam, beams=256):
    """6.5; positive to starboard."""
    return math.asin((2 * beam + 1 - beams) / beams * math.sin(math.radians(60)))


def line_step_m(sound_speed_mps):
    """6.7."""
    return sound_speed_mps / (2 * LINE_RATE_HZ)


# ---- Poses ---------------------------------------------------------------------------------------------------

def _varint(value):
    out = bytearray()
    while value >= 0x80:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    out.append(value)
    return bytes(out)


def _field(number, payload):
    return _varint(number << 3 | 2) + _varint(len(payload)) + payload


def _doubles(*values):
    return b"".join(_varint((i + 1) << 3 | 1) + struct.pack("<d", value) for i, value in enumerate(values))


def pose_update(time_ns, position_m, yaw_rad=0.0, bodies=()):
    """PoseUpdate at rest in the axes of FRAME_ENU_FLU; `bodies` are (name, position) pairs."""
    message = _varint(1 << 3) + _varint(time_ns)
    message += _field(3, _pose(position_m, yaw_rad))
    for name, body_position_m in bodies:
        message += _field(5, _field(1, name.encode()) + _field(2, _pose(body_position_m, 0.0)))
    return message


def _pose(position_m, yaw_rad):
    orientation = _doubles(math.cos(yaw_rad / 2), 0.0, 0.0, math.sin(yaw_rad / 2))
    return _field(1, _doubles(*position_m)) + _field(2, orientation)
