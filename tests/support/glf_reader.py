# SPDX-License-Identifier: Apache-2.0
"""Reads Tritech .glf and .dat logs. Written from protocol/glf/README.md without our C++ code, so that it checks each byte.

    log = glf_reader.read(path)    # a .glf, or the .dat of one
    log.images[0].pixels           # bytes, line after line

The reader is strict: it raises GlfError for contents that our logs never have.
"""

import dataclasses
import struct
import xml.etree.ElementTree
import zipfile
import zlib

SECONDS_1970_TO_1980 = 315_532_800


class GlfError(Exception):
    pass


def need(holds, what, offset):
    if not holds:
        raise GlfError(f"byte {offset}: {what}")


@dataclasses.dataclass
class Header:
    """The 21 bytes before each record (1.3)."""

    offset: int
    length: int
    time_s: float
    data_type: int
    device_id: int
    node_id: int

    @property
    def unix_s(self):
        """Unix time, for logs in UTC."""
        return self.time_s + SECONDS_1970_TO_1980


@dataclasses.dataclass
class Image:
    """An image record (1.4)."""

    header: Header
    lines: int
    beams: int
    range_compression: int  # one line has 2 to this power lines of the head
    compression: str
    data_size: int
    pixels: bytes
    bearings_rad: tuple
    state_flags: int
    modulation_frequency_hz: int
    aperture_deg: float
    transmit_time_s: float
    ping_flags: int
    sound_speed_mps: float
    gain_percent: int
    chirp: int
    sonar_type: int
    platform: int

    @property
    def metres_per_line(self):
        return self.sound_speed_mps / 2 / self.modulation_frequency_hz

    @property
    def max_range_m(self):
        return self.lines * self.metres_per_line

    def row(self, line):
        return self.pixels[line * self.beams:(line + 1) * self.beams]


@dataclasses.dataclass
class Status:
    """A status record (1.5)."""

    header: Header
    version: int
    bf_firmware_version: int
    da_version: int
    device_id: int
    selected_transducer: int
    temperatures_c: tuple  # FPGA board, HSC board, DA FPGA, transducer, PSU, die, TX, then eight of the AFEs
    link_type: int
    uplink_mbps: float
    downlink_mbps: float
    link_quality_percent: int
    counts: tuple
    addresses: tuple
    mac: tuple
    boot_status: tuple
    fpga_time_us: int
    dip_switch: int
    shutdown_status: int
    network_adaptor_found: int


@dataclasses.dataclass
class Log:
    records: list  # Image and Status, in file order
    creation_time_s: float | None = None
    close_time_s: float | None = None
    app_name: str | None = None
    device_info: str | None = None

    @property
    def images(self):
        return [record for record in self.records if isinstance(record, Image)]

    @property
    def statuses(self):
        return [record for record in self.records if isinstance(record, Status)]


def _header(dat, offset):
    need(len(dat) - offset >= 21, "no room for a header", offset)
    mark, version, length, time_s, data_type, device_id, node_id, spare = struct.unpack_from("<cBIdBHHH", dat, offset)
    need(mark == b"*", f"starts with {mark}", offset)
    need(version == 2, f"header version {version}", offset)
    need(spare == 0, "spare bytes are not zero", offset)
    need(offset + length <= len(dat), f"a length of {length} leads beyond the end", offset)
    return Header(offset, length, time_s, data_type, device_id, node_id)


def _pixels(data, compression, count, at):
    if compression == 1:
        need(len(data) == count, "raw pixels of another size than the image", at)
        return "raw", bytes(data)
    need(compression == 0, f"compression {compression}", at)
    need(len(data) != count, "zlib data as large as the image, which other readers take for raw", at)
    stream = zlib.decompressobj()
    pixels = stream.decompress(data)
    need(stream.eof and not stream.unused_data, "no whole zlib stream, or something after it", at)
    need(len(pixels) == count, "zlib data of another size than the image", at)
    return "zlib", pixels


def _image(dat, header):
    at = header.offset + 21
    (record_type, tag, version, start_range, end_range, range_compression, start_bearing, end_bearing, compression,
     size) = struct.unpack_from("<HHHIIHIIHI", dat, at)
    need((record_type, tag, version) == (1, 0xEFEF, 3), "no image of version 3", at)
    need((start_range, start_bearing) == (0, 0), "a part of a fan", at)
    need(range_compression <= 4, f"range compression {range_compression}", at)
    need(header.length == 21 + 30 + size + 8 * end_bearing + 34, "length is not that of an image", at)
    data = dat[at + 30:at + 30 + size]
    compression, pixels = _pixels(data, compression, end_range * end_bearing, at + 30)
    bearings_rad = struct.unpack_from(f"<{end_bearing}d", dat, at + 30 + size)
    tail = struct.unpack_from("<IIfdHfhBBBBH", dat, at + 30 + size + 8 * end_bearing)
    need(tail[10] == 0, "acoustic zoom", at)
    need(tail[11] == 0xDEDE, "no end tag", at)
    return Image(header, end_range, end_bearing, range_compression, compression, size, pixels, bearings_rad, *tail[:10])


def _status(dat, header):
    need(header.length == 21 + 218, "length is not that of a status", header.offset)
    body = dat[header.offset + 21:header.offset + header.length]
    version, firmware, da_version, flags, device_id, transducer = struct.unpack_from("<HHHHHB", body, 0)
    need(flags == 0, "internal flags", header.offset)
    link_type, uplink, downlink, quality = struct.unpack_from("<HddH", body, 131)
    fpga_time_us, dip_switch, shutdown, adaptor = struct.unpack_from("<QHHB", body, 205)
    return Status(header, version, firmware, da_version, device_id, transducer, struct.unpack_from("<15d", body, 11),
                  link_type, uplink, downlink, quality, struct.unpack_from("<7I", body, 151),
                  struct.unpack_from("<3I", body, 179), struct.unpack_from("<3H", body, 191),
                  struct.unpack_from("<2I", body, 197), fpga_time_us, dip_switch, shutdown, adaptor)


def parse_dat(dat):
    """Returns all records of a closed .dat."""
    records = []
    offset = 0
    while dat[offset:] != b"\xde\xde":
        header = _header(dat, offset)
        need(header.data_type in (0, 3), f"record of type {header.data_type}", offset)
        records.append(_image(dat, header) if header.data_type == 0 else _status(dat, header))
        offset += header.length
    return records


def _check_container(raw, archive):
    """Checks requirements of other readers beyond a valid ZIP (1.2)."""
    names = [entry.filename for entry in archive.infolist()]
    need([name[-4:] for name in names] == [".cfg", ".dat"], f"entries are {names}", 0)
    for entry in archive.infolist():
        at = entry.header_offset
        signature, _, flags, method, _, _, crc, packed, size, name_size, extra = struct.unpack_from(
            "<IHHHHHIIIHH", raw, at)
        need(signature == 0x04034B50 and (flags, method, extra) == (0, 8, 0), "local header", at)
        need((crc, packed, size) == (entry.CRC, entry.compress_size, entry.file_size), "sizes in the local header", at)
        at += 30 + name_size
        blocks = -(-size // 65531)
        need(packed == size + 5 * (blocks + 1), "compressed size", at)
        for block in range(blocks):
            length = min(65531, size - 65531 * block)
            need(raw[at:at + 5] == struct.pack("<BHH", 0, length, length ^ 0xFFFF), f"header of block {block}", at)
            at += 5 + length
        need(raw[at:at + 5] == b"\x01\x00\x00\xff\xff", "final block", at)
    need(not archive.comment, "a comment", 0)


def read(path):
    with open(path, "rb") as file:
        raw = file.read()
    if raw[:2] != b"PK":
        return Log(parse_dat(raw))
    with zipfile.ZipFile(path) as archive:
        need(archive.testzip() is None, "a CRC is wrong", 0)
        _check_container(raw, archive)
        config, dat = [archive.read(entry) for entry in archive.infolist()]
    root = xml.etree.ElementTree.fromstring(config)
    need(root.tag == "genesisLog" and root.findtext("logHeader/fileVersion") == "1", "no .cfg of ours", 0)
    return Log(parse_dat(dat), float(root.findtext("logHeader/creationTime")),
               float(root.findtext("logTerminator/closeTime")), root.findtext("logHeader/appName"),
               root.findtext("logHeader/deviceInfo"))
