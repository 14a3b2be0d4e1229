# SPDX-License-Identifier: Apache-2.0
"""Reads captures of IPv4 packets. Written from draft-ietf-opsawg-pcapng and RFC 791, 768, 9293 without our C++ code.

    for packet in pcapng_reader.read(path): packet.interface, packet.time_ns, packet.payload ...

The reader is strict: it raises PcapngError for contents that our captures never have.
"""

import dataclasses
import struct

SECTION, INTERFACE, PACKET = 0x0A0D0D0A, 1, 6


class PcapngError(Exception):
    pass


def need(holds, what, offset):
    if not holds:
        raise PcapngError(f"byte {offset}: {what}")


@dataclasses.dataclass
class Packet:
    interface: str  # its name
    time_ns: int
    protocol: str  # "udp", "tcp"
    source: tuple  # address, port
    target: tuple
    payload: bytes
    sequence: int = 0  # TCP only
    flags: int = 0


def _checksum(data):
    if len(data) % 2:
        data += b"\0"
    total = sum(struct.unpack(f">{len(data) // 2}H", data))
    while total >> 16:
        total = (total & 0xFFFF) + (total >> 16)
    return total


def _name(body):
    link, _, _ = struct.unpack_from("<HHI", body)
    need(link == 101, f"link type {link}", 0)
    name, nanoseconds, at = None, False, 8
    while at + 4 <= len(body):
        code, size = struct.unpack_from("<HH", body, at)
        value = body[at + 4:at + 4 + size]
        if code == 2:
            name = value.decode()
        elif code == 9:
            nanoseconds = value == b"\x09"
        at += 4 + -(-size // 4) * 4
    need(nanoseconds, "times are not in nanoseconds", 0)
    return name


def _packet(interface, time_ns, ip, at):
    need(ip[0] == 0x45, "no IPv4 header without options", at)
    size, = struct.unpack_from(">H", ip, 2)
    need(size == len(ip), f"IPv4 says {size} bytes of {len(ip)}", at)
    need(_checksum(ip[:20]) == 0xFFFF, "checksum of IPv4", at)
    source, target = (".".join(map(str, ip[i:i + 4])) for i in (12, 16))
    body = ip[20:]
    pseudo = ip[12:20] + struct.pack(">BBH", 0, ip[9], len(body))
    need(_checksum(pseudo + body) == 0xFFFF, "checksum of UDP or TCP", at)
    ports = struct.unpack_from(">HH", body)
    ends = (source, ports[0]), (target, ports[1])
    if ip[9] == 17:
        need(struct.unpack_from(">H", body, 4)[0] == len(body), "length of UDP", at)
        return Packet(interface, time_ns, "udp", *ends, bytes(body[8:]))
    need(ip[9] == 6, f"protocol {ip[9]}", at)
    sequence, = struct.unpack_from(">I", body, 4)
    return Packet(interface, time_ns, "tcp", *ends, bytes(body[(body[12] >> 4) * 4:]), sequence, body[13])


def read(path):
    with open(path, "rb") as file:
        data = file.read()
    packets, names, at = [], [], 0
    while at < len(data):
        need(len(data) - at >= 12, "no room for a block", at)
        kind, size = struct.unpack_from("<II", data, at)
        need(size % 4 == 0 and 12 <= size <= len(data) - at, f"block of {size} bytes", at)
        need(struct.unpack_from("<I", data, at + size - 4)[0] == size, "lengths differ", at)
        body = data[at + 8:at + size - 4]
        if at == 0:
            need(kind == SECTION and body[:4] == b"\x4d\x3c\x2b\x1a", "no section", at)
        elif kind == INTERFACE:
            names.append(_name(body))
        else:
            need(kind == PACKET, f"block of type {kind}", at)
            interface, high, low, captured, original = struct.unpack_from("<5I", body)
            need(captured == original, "a packet that was cut", at)
            packets.append(_packet(names[interface], high << 32 | low, body[20:20 + captured], at))
        at += size
    return packets
