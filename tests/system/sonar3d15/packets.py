# SPDX-License-Identifier: Apache-2.0
"""Packets of a Sonar 3D-15 (protocol/sonar3d15/README.md 1 to 3), read without the code under test or its libraries."""

import collections
import struct
import zlib

import numpy

TYPES = "type.googleapis.com/waterlinked.sonar.protocol."

# `pixels` are ranges in metres or signals, by row from the lowest.
Image = collections.namedtuple("Image", "kind seconds nanos sequence speed range frequency fov_h fov_v pixels header")


def varint(data, at):
    value = shift = 0
    while True:
        byte = data[at]
        at += 1
        value |= (byte & 0x7F) << shift
        shift += 7
        if byte < 0x80:
            return value, at


def snappy(block):
    """A raw block of Snappy."""
    size, at = varint(block, 0)
    out = bytearray()
    while at < len(block):
        tag, at = block[at], at + 1
        kind, length = tag & 3, tag >> 2
        if kind == 0:
            if length >= 60:
                more = length - 59
                length = int.from_bytes(block[at:at + more], "little")
                at += more
            out += block[at:at + length + 1]
            at += length + 1
            continue
        if kind == 1:
            offset, length, at = (tag >> 5) << 8 | block[at], (length & 7) + 4, at + 1
        else:
            width = 2 if kind == 2 else 4
            offset, length, at = int.from_bytes(block[at:at + width], "little"), length + 1, at + width
        if not 0 < offset <= len(out):
            raise ValueError("an offset of Snappy before the start")
        for _ in range(length):
            out.append(out[-offset])
    if len(out) != size:
        raise ValueError("a block of Snappy of another size")
    return bytes(out)


def message_of(packet):
    """The message in a packet, which must be all of `packet`."""
    if struct.unpack_from("<I", packet, 4)[0] != len(packet) or zlib.crc32(packet[:-4]) != struct.unpack("<I", packet[-4:])[0]:
        raise ValueError("length or checksum")
    payload = packet[8:-4]
    return {b"RIP1": bytes, b"RIP2": snappy}[packet[:4]](payload)


def fields(message):
    """{number: value} of a message of Protobuf; later values replace earlier ones."""
    found, at = {}, 0
    while at < len(message):
        key, at = varint(message, at)
        if key & 7 == 0:
            found[key >> 3], at = varint(message, at)
        elif key & 7 == 5:
            found[key >> 3], at = struct.unpack_from("<f", message, at)[0], at + 4
        else:
            size, at = varint(message, at)
            found[key >> 3], at = message[at:at + size], at + size
    return found


def decode(packet):
    any_of = fields(fields(message_of(packet))[1])
    kind = any_of[1].decode()
    if not kind.startswith(TYPES):
        raise ValueError(kind)
    kind = kind[len(TYPES):]
    value = fields(any_of[2])
    if kind == "ImuBatch":
        return value
    header = fields(value[1])
    stamp = fields(header[1])
    first = 5 if kind == "RangeImage" else 6
    width, height = value[first], value[first + 1]
    if kind == "RangeImage":
        codes, at = [], 0
        while at < len(value[10]):
            code, at = varint(value[10], at)
            codes.append(code)
        pixels = numpy.array(codes, float) * value[9]
    else:
        pixels = numpy.frombuffer(value[10], numpy.uint8)
    return Image(kind, stamp.get(1, 0), stamp.get(2, 0), header.get(2, 0), value[2], value[3], value.get(4, 0),
                 value[first + 2], value[first + 3], pixels.reshape(height, width), value[1])


def points(image):
    """x forward, y to starboard, z down, of the pixels with an echo."""
    height, width = image.pixels.shape
    yaw = numpy.radians(numpy.arange(width) / (width - 1) * image.fov_h - image.fov_h / 2)[None, :]
    pitch = numpy.radians(numpy.arange(height) / (height - 1) * image.fov_v - image.fov_v / 2)[:, None]
    r = image.pixels
    xyz = numpy.stack([r * numpy.cos(pitch) * numpy.cos(yaw), r * numpy.cos(pitch) * numpy.sin(yaw),
                       -r * numpy.sin(pitch) * numpy.ones_like(yaw)], axis=-1)
    return xyz[r > 0]
