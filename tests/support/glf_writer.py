# SPDX-License-Identifier: Apache-2.0
"""Writes Tritech .glf and .dat logs for tests that read or play logs. Written from protocol/glf/README.md without our C++ code.

    images = glf_writer.noise(count=20, lines=482, device_id=513)
    glf_writer.write_glf(path, images)
"""

import dataclasses
import math
import random
import struct
import zipfile
import zlib

SECONDS_1970_TO_1980 = 315_532_800
LINE_RATE_HZ = 90422
END = b"\xde\xde"


@dataclasses.dataclass
class Image:
    time_s: float  # since 1980, on the clock of the log
    pixels: bytes  # line after line
    lines: int
    beams: int = 256
    device_id: int = 513
    modulation_frequency_hz: int = LINE_RATE_HZ
    sound_speed_mps: float = 1500.0
    gain_percent: int = 50

    def crc32(self):
        return zlib.crc32(self.pixels)


def noise(count, lines, device_id=513, start_s=1_479_651_753.25, interval_s=0.05, **settings):
    """Images of random bytes; the same arguments give the same images."""
    draw = random.Random(f"{device_id} {count} {lines}")
    return [Image(start_s + number * interval_s, draw.randbytes(lines * settings.get("beams", 256)), lines,
                  device_id=device_id, **settings)
            for number in range(count)]


def _record(kind, image_time_s, device_id, body):
    return struct.pack("<cBIdBHHH", b"*", 2, 21 + len(body), image_time_s, kind, device_id, 100, 0) + body


def bearings_rad(beams):
    """The bearings of a 720i (protocol/gemini/README.md 6.5), from port (positive in a log) to starboard."""
    return [-math.asin((2 * beam + 1 - beams) / beams * math.sin(math.radians(60))) for beam in range(beams)]


def image_record(image):
    """An image record (1.4)."""
    packed = zlib.compress(image.pixels, 1)
    raw = len(packed) >= len(image.pixels)
    data = image.pixels if raw else packed
    body = struct.pack("<HHHIIHIIHI", 1, 0xEFEF, 3, 0, image.lines, 0, 0, image.beams, 1 if raw else 0, len(data)) + data
    body += struct.pack(f"<{image.beams}d", *bearings_rad(image.beams))
    body += struct.pack("<IIfdHfhBBBBH", 0, image.modulation_frequency_hz, 120.0, image.time_s, 0x8000,
                        image.sound_speed_mps, image.gain_percent, 0, 0, 0, 0, 0xDEDE)
    return _record(0, image.time_s, image.device_id, body)


def status_record(time_s, device_id=513):
    """A status record (1.5) without values."""
    return _record(3, time_s, device_id, struct.pack("<5H", 1, 0, 0, 0, device_id) + bytes(208))


def dat(images, statuses=()):
    return b"".join([image_record(image) for image in images] + list(statuses)) + END


def write_dat(path, images, statuses=()):
    with open(path, "wb") as file:
        file.write(dat(images, statuses))


def write_glf(path, images, statuses=()):
    """A .glf (1.2) with stored blocks, as zlib makes them at level 0."""
    config = (f"<genesisLog><logHeader><creationTime>{images[0].time_s}</creationTime></logHeader><logTerminator>"
              f"<closeTime>{images[-1].time_s}</closeTime></logTerminator></genesisLog>")
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=0) as archive:
        archive.writestr("log.cfg", config)
        archive.writestr("data.dat", dat(images, statuses))
