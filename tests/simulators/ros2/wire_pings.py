# SPDX-License-Identifier: Apache-2.0
"""Pings of a capture, read by the tests' own readers of the devices' protocols, without our clients: an independent check.

Section numbers are those of protocol/DEVICE/README.md.
"""

import dataclasses
import importlib.util
import math
import os
import struct
import sys

import numpy

SYSTEM = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "system")
SOUND_SPEED_MPS = 1500.0


def _module(device, name):
    spec = importlib.util.spec_from_file_location(f"{device}_{name}", os.path.join(SYSTEM, device, name + ".py"))
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


gemini, oculus, ping360 = _module("gemini", "wire"), _module("oculus", "messages"), _module("ping360", "messages")


@dataclasses.dataclass
class WirePing:
    rows: list  # bytes of each range, near to far
    bearings_rad: list  # positive to port
    row_m: float

    def data(self):
        return b"".join(self.rows)

    def samples(self):
        return numpy.frombuffer(self.data(), numpy.uint8).reshape(len(self.rows), -1)


def _payloads(packets, protocol, port):
    return [packet.payload for packet in packets if packet.protocol == protocol and packet.source[1] == port]


def gemini_pings(packets):
    """8-bit pings."""
    pings = []
    for payload in [packet.payload for packet in packets if packet.target[1] == 52900]:
        if gemini.message_type(payload) == gemini.PING_HEAD:
            pings.append(gemini.Ping(payload))
        elif pings:
            pings[-1].add(payload)
    return [WirePing([ping.lines[row] for row in range(ping.count)], [-gemini.bearing_rad(beam) for beam in range(ping.beams)],
                     gemini.line_step_m(SOUND_SPEED_MPS) * 2**ping.compression) for ping in pings if ping.complete()]


def oculus_pings(packets):
    made = [oculus.ping_of(message) for message in oculus.Stream().feed(b"".join(_payloads(packets, "tcp", 52100)))
            if message.id == oculus.PING]
    return [WirePing(ping.rows, [-math.radians(bearing / 100) for bearing in ping.bearings_cdeg], ping.resolution_m)
            for ping in made]


def micron_pings(packets):
    """6.3, 8-bit."""
    stream, pings = b"".join(_payloads(packets, "tcp", 4001)), []
    while stream:
        size = struct.unpack_from("<H", stream, 5)[0] + 6
        frame, stream = stream[:size], stream[size:]
        if frame[10] == 2:
            interval, bearing, count = (struct.unpack_from("<H", frame, at)[0] for at in (33, 40, 42))
            pings.append(WirePing([bytes([sample]) for sample in frame[44:44 + count]],
                                  [(3200 - bearing) * math.tau / 6400], interval * 640e-9 * SOUND_SPEED_MPS / 2))
    return pings


def ping360_pings(packets):
    frames = ping360.Parser().feed(b"".join(_payloads(packets, "udp", 12345)))
    answers = [ping360.device_data(frame) for frame in frames if frame.message == ping360.DEVICE_DATA]
    return [WirePing([bytes([sample]) for sample in one.data],
                     [-(one.angle if one.angle < 200 else one.angle - 400) * math.tau / 400],
                     one.period * 25e-9 * SOUND_SPEED_MPS / 2) for one in answers]


PINGS = {"gemini": gemini_pings, "oculus": oculus_pings, "micron": micron_pings, "ping360": ping360_pings}
