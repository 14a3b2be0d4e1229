# SPDX-License-Identifier: Apache-2.0
"""Frames of the Ping360, written from protocol/ping360/README.md, not from our C++ code: an independent check.

Section numbers are those of that page.
"""

import dataclasses
import struct

ACK, NACK, ASCII_TEXT, DEVICE_INFORMATION, PROTOCOL_VERSION, GENERAL_REQUEST = 1, 2, 3, 4, 5, 6
SET_COMMON_DEVICE_ID = 100
SET_DEVICE_ID, DEVICE_DATA, AUTO_DEVICE_DATA = 2000, 2300, 2301
RESET, TRANSDUCER, AUTO_TRANSMIT, MOTOR_OFF = 2600, 2601, 2602, 2903

MOST_PAYLOAD = 4096


# ---- 1: frames

def frame(message, payload=b"", source=0, destination=0):
    front = b"BR" + struct.pack("<HHBB", len(payload), message, source, destination) + payload
    return front + struct.pack("<H", sum(front) & 0xFFFF)


@dataclasses.dataclass
class Frame:
    message: int
    source: int
    destination: int
    payload: bytes

    def bytes(self):
        return frame(self.message, self.payload, self.source, self.destination)


class Parser:
    """1.1, as in real clients: an invalid frame is dropped whole."""

    def __init__(self):
        self._bytes = b""
        self.junk = 0  # bytes that were part of no frame

    def feed(self, data):
        """The frames that `data` completes."""
        self._bytes += data
        frames = []
        while (start := self._bytes.find(b"BR")) >= 0 and len(self._bytes) >= start + 4:
            self._drop(start)
            end = 10 + struct.unpack_from("<H", self._bytes, 2)[0]
            if end > MOST_PAYLOAD + 10:
                self._drop(4)
            elif len(self._bytes) < end:
                break
            elif sum(self._bytes[:end - 2]) & 0xFFFF != struct.unpack_from("<H", self._bytes, end - 2)[0]:
                self._drop(end)
            else:
                _, message, source, destination = struct.unpack_from("<HHBB", self._bytes, 2)
                frames.append(Frame(message, source, destination, self._bytes[8:end - 2]))
                self._bytes = self._bytes[end:]
        return frames

    def _drop(self, count):
        self.junk += count
        self._bytes = self._bytes[count:]


# ---- 2: messages from hosts

def request(wanted):
    return frame(GENERAL_REQUEST, struct.pack("<H", wanted))


@dataclasses.dataclass
class Transducer:
    """2601. The defaults are ping-viewer's first settings."""
    mode: int = 1
    gain: int = 0
    angle: int = 0
    duration: int = 11
    period: int = 88
    frequency: int = 750
    samples: int = 1200
    transmit: int = 1

    def bytes(self):
        return frame(TRANSDUCER, struct.pack("<BBHHHHHBB", self.mode, self.gain, self.angle, self.duration, self.period,
                                             self.frequency, self.samples, self.transmit, 0))


@dataclasses.dataclass
class AutoTransmit:
    """2602, by default ping-viewer's whole turn."""
    mode: int = 1
    gain: int = 0
    duration: int = 11
    period: int = 88
    frequency: int = 750
    samples: int = 1200
    start: int = 0
    stop: int = 399
    steps: int = 1
    delay: int = 0

    def bytes(self):
        return frame(AUTO_TRANSMIT, struct.pack("<BBHHHHHHBB", self.mode, self.gain, self.duration, self.period,
                                                self.frequency, self.samples, self.start, self.stop, self.steps, self.delay))


MOTOR_OFF_FRAME = frame(MOTOR_OFF)


def reset(bootloader=0):
    return frame(RESET, bytes([bootloader, 0]))


# ---- 2: messages from heads

@dataclasses.dataclass
class DeviceData:
    """2300 and 2301; 2300 has no limits (None)."""
    mode: int
    gain: int
    angle: int
    duration: int
    period: int
    frequency: int
    samples: int
    data: bytes = dataclasses.field(repr=False)
    start: int = None
    stop: int = None
    steps: int = None
    delay: int = None

    def echoes(self, command):
        """Whether its settings equal those of `command`, except the angle."""
        names = ["mode", "gain", "duration", "period", "frequency", "samples"]
        if isinstance(command, AutoTransmit):
            names += ["start", "stop", "steps", "delay"]
        return all(getattr(self, name) == getattr(command, name) for name in names)


def device_data(got):
    mode, gain, angle, duration, period, frequency, samples, size = struct.unpack_from("<BBHHHHHH", got.payload)
    if len(got.payload) != 14 + size:
        raise ValueError(f"device_data of {len(got.payload)} bytes says {size} samples")
    return DeviceData(mode, gain, angle, duration, period, frequency, samples, got.payload[14:])


def auto_device_data(got):
    (mode, gain, angle, duration, period, frequency, start, stop, steps, delay, samples,
     size) = struct.unpack_from("<BBHHHHHHBBHH", got.payload)
    if len(got.payload) != 20 + size:
        raise ValueError(f"auto_device_data of {len(got.payload)} bytes says {size} samples")
    return DeviceData(mode, gain, angle, duration, period, frequency, samples, got.payload[20:], start, stop, steps, delay)


def data_of(got):
    return auto_device_data(got) if got.message == AUTO_DEVICE_DATA else device_data(got)


def nack(got):
    """(number of the refused message, text)"""
    return struct.unpack_from("<H", got.payload)[0], got.payload[2:].decode("ascii")
