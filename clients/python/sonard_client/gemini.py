# SPDX-License-Identifier: Apache-2.0
"""A client for a Tritech Gemini 720i. Section numbers in comments refer to protocol/gemini/README.md."""

from __future__ import annotations

import ipaddress
import math
import socket
import struct
import time
from dataclasses import dataclass, field
from typing import Iterator, Optional

import numpy as np

from .ping import Array, NoHead, NoPing, Ping

REPORT_PORT, COMMAND_PORT = 52900, 52901  # 1.1
LINE_RATE_HZ = 90422.0  # 6.7
_FREQUENCY_HZ = 720e3  # the nominal one
_BEAMWIDTH_RAD, _VERTICAL_BEAMWIDTH_RAD = math.radians(1), math.radians(20)
STATUS, PING_HEAD, PING_LINE, PING_TAIL = 0x40, 0x41, 0x42, 0x43
_BUFFER_BYTES = 16 << 20  # several pings; the kernel may give less
_KEEP_ALIVE_S = 1.0  # the head forgets a client after 3 s (1.5)
_RETRIES = 6


@dataclass(frozen=True)
class Status:
    """The values of a status (3.3) that this module uses."""

    sonar_id: int
    address: str
    netmask: str
    firmware: int


@dataclass
class _Arriving:
    """A ping that has not arrived completely (6)."""

    head: bytes
    lines: dict[int, bytes] = field(default_factory=dict)
    tail: bool = False

    def __post_init__(self) -> None:
        self.ping_id, self.ext_mode, low, high = struct.unpack_from("<HHII", self.head, 8)
        self.transmit_us = high << 32 | low
        start, end = struct.unpack_from("<HH", self.head, 20)
        (self.beams,) = struct.unpack_from("<H", self.head, 28)
        self.rle = self.head[44]
        self.compression = self.head[45]
        self.count = (end - start) >> self.compression

    def add(self, datagram: bytes) -> None:
        if datagram[0] == PING_LINE and len(datagram) >= 16 and datagram[9] == self.ping_id & 0xFF:
            self.lines[struct.unpack_from("<H", datagram, 10)[0] & 0x7FFF] = datagram[16:]
        elif datagram[0] == PING_TAIL and len(datagram) >= 9 and datagram[8] == self.ping_id & 0xFF:
            self.tail = True

    def gaps(self) -> list[tuple[int, int]]:
        """First line and number of lines of each gap, in order."""
        gaps: list[tuple[int, int]] = []
        for line in range(self.count):
            if line in self.lines:
                continue
            if gaps and sum(gaps[-1]) == line:
                gaps[-1] = (gaps[-1][0], gaps[-1][1] + 1)
            else:
                gaps.append((line, 1))
        return gaps

    def samples(self) -> Array:
        eight_bit = bool(self.ext_mode & 4)
        rows = np.zeros((self.count, self.beams), np.uint8 if eight_bit else np.uint16)
        for line, data in self.lines.items():
            if line >= self.count:
                continue
            if not eight_bit:  # big-endian (6.6)
                row = np.frombuffer(data[: 2 * self.beams], ">u2")
            elif self.rle:
                row = _run_length_decoded(data, self.beams)
            else:
                row = np.frombuffer(data[: self.beams], np.uint8)
            rows[line, : row.size] = row
        return rows


def _run_length_decoded(data: bytes, beams: int) -> Array:
    """Decodes a line (6.8)."""
    row = np.zeros(beams, np.uint8)
    beam = at = 0
    while at < len(data) and beam < beams:
        if data[at] == 0:
            beam += data[at + 1] if at + 1 < len(data) else beams
            at += 2
        else:
            row[beam] = 0 if data[at] == 1 else data[at]
            beam += 1
            at += 1
    return row


def bearings_rad(beams: int) -> Array:
    """Bearings of the beams, evenly spaced in the sine over 120 degrees (6.5); positive to port."""
    bearings: Array = -np.arcsin((2 * np.arange(beams) + 1 - beams) / beams * math.sin(math.radians(60)))
    return bearings


def _ping_config(sonar_id: int, range_m: float, gain_percent: float, sound_speed_mps: float, compression: int,
                 bits: int, interval_s: Optional[float]) -> bytes:
    """A ping configuration, 0x21, filled in as the vendor's early library does (5)."""
    line_m = sound_speed_mps / (2 * LINE_RATE_HZ)
    lines = min(max(math.floor(range_m / line_m + 0.5), 32), 20000 if bits == 8 else 10000)
    cycles = 4 if range_m < 10 else 4 + math.floor(28 * (range_m - 10) / 40) if range_m < 50 else \
        32 + math.floor(96 * (range_m - 50) / 50) if range_m < 100 else 128
    bank = sum(range_m < limit for limit in (50, 40, 30, 25, 20, 15, 10))
    spreading = int(500 * math.exp((gain_percent - 100) / 25))
    body = struct.pack("<4H", 0, 0, 0, 0)
    body += struct.pack("<HH", 0 if interval_s is None else 1, 0x0200 | (4 if bits == 8 else 0))
    body += struct.pack("<HHI", 0, lines, 0 if interval_s is None else round(1e6 * interval_s))
    body += struct.pack("<HHHH", cycles, 0, 0x83E8 if range_m < 5 else 0xC3E8, 0)
    body += struct.pack("<IHHHH", 0x1E00, spreading, 0, bank, 1)
    body += struct.pack("<HHHHHH", round(10 * sound_speed_mps), 1, compression, 0, 0, 0)
    body += struct.pack("<BBHBBBB", 1, 29, 0, 1, 18, 30, 17)
    return _header(0x21, sonar_id) + body


def _header(message_type: int, sonar_id: int) -> bytes:
    return struct.pack("<BBHHBB", message_type, 1, sonar_id, 0, 0, 0)


def _address(number: int) -> str:
    return str(ipaddress.IPv4Address(number))


class Gemini:
    """A client of one head. Use it from one thread at a time.

    sonar_id  the ID of the head; None: the first whose status arrives
    local     the address of this machine that commands are sent from and the head answers to; None: the one that routes
              to the head
    bind      the address on which reports arrive, "" for all
    """

    def __init__(self, sonar_id: Optional[int] = None, local: Optional[str] = None, bind: str = "",
                 patience_s: float = 5.0) -> None:
        self._reports = self._open(bind, REPORT_PORT)
        try:
            self.status = self._first_status(sonar_id, patience_s)
            self._commands = self._open(local or self._local_address(), COMMAND_PORT)
        except BaseException:
            self._reports.close()
            raise
        self._last_command_s = 0.0

    def __enter__(self) -> Gemini:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends the conversation with the head and closes the sockets."""
        self._send(_header(0xC8, self.status.sonar_id) + b"\0\0")
        self._reports.close()
        self._commands.close()

    def ping(self, range_m: float = 20.0, gain_percent: float = 50.0, sound_speed_mps: float = 1500.0,
             compression: int = 0, bits: int = 8) -> Ping:
        """Requests one ping. `compression` averages 2^n lines into one, n = 0..4.

        Raises NoPing if no ping arrives, e.g. because the head has no pose or is out of the water.
        """
        config = _ping_config(self.status.sonar_id, range_m, gain_percent, sound_speed_mps, compression, bits, None)
        self._send(config)
        return self._receive(config, range_m, sound_speed_mps)

    def pings(self, interval_s: float, range_m: float = 20.0, gain_percent: float = 50.0,
              sound_speed_mps: float = 1500.0, compression: int = 0, bits: int = 8) -> Iterator[Ping]:
        """Pings that the head sends on its own, until the iterator is closed. The request is sent at once."""
        config = _ping_config(self.status.sonar_id, range_m, gain_percent, sound_speed_mps, compression, bits, interval_s)
        self._send(config)

        def received() -> Iterator[Ping]:
            while True:
                yield self._receive(config, range_m, sound_speed_mps)

        return received()

    # ---- Sockets

    @staticmethod
    def _open(address: str, port: int) -> socket.socket:
        made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER_BYTES)
        try:
            made.bind((address, port))
        except OSError as error:
            made.close()
            raise OSError(f"UDP port {port} of {address or 'this machine'} cannot be opened: {error}") from error
        return made

    def _local_address(self) -> str:
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            probe.connect((self.status.address, COMMAND_PORT))
            local = str(probe.getsockname()[0])
        # On loopback, each address routes to itself; use the head's own address.
        return "127.0.0.1" if local == self.status.address else local

    def _send(self, message: bytes) -> None:
        self._last_command_s = time.monotonic()
        self._commands.sendto(message, (self.status.address, COMMAND_PORT))

    def _next(self, until_s: float) -> Optional[bytes]:
        """The next datagram of the head; None if the time is over."""
        left_s = until_s - time.monotonic()
        if left_s <= 0:
            return None
        self._reports.settimeout(left_s)
        try:
            datagram = self._reports.recv(2048)
        except (TimeoutError, socket.timeout):
            return None
        return datagram if len(datagram) >= 8 else b"\0" * 8

    def _first_status(self, sonar_id: Optional[int], patience_s: float) -> Status:
        until_s = time.monotonic() + patience_s
        while (datagram := self._next(until_s)) is not None:
            if datagram[0] != STATUS or len(datagram) < 110:
                continue
            firmware, its_id, _, alternate = struct.unpack_from("<HHII", datagram, 8)
            (netmask,) = struct.unpack_from("<I", datagram, 58)
            if alternate != 0 and sonar_id in (None, its_id):
                return Status(its_id, _address(alternate), _address(netmask), firmware)
        raise NoHead(f"no status{'' if sonar_id is None else f' of head {sonar_id}'} on UDP port {REPORT_PORT} within "
                     f"{patience_s} s: check that the head is on and sends its status here")

    # ---- Pings

    def _receive(self, config: bytes, range_m: float, sound_speed_mps: float) -> Ping:
        ping: Optional[_Arriving] = None
        until_s = time.monotonic() + 4.0 + 4 * range_m / sound_speed_mps
        retries = 0
        while True:
            if time.monotonic() - self._last_command_s > _KEEP_ALIVE_S:
                # If no PING_HEAD arrives within a second, the command or the PING_HEAD was lost (1.6).
                self._send(_header(0x20, self.status.sonar_id) if ping else config)
            # The head delays its next ping by 10 ms after a request (7.3).
            patience_s = _KEEP_ALIVE_S if ping is None else 0.008 if ping.tail else 0.1
            wait_s = min(until_s, time.monotonic() + patience_s)
            datagram = self._next(wait_s)
            if datagram is None and time.monotonic() >= until_s:
                if ping is None:
                    raise NoPing("no ping arrived: check that the head has a pose and is in the water")
                return self._made(ping, sound_speed_mps)
            if datagram is not None and datagram[0] == PING_HEAD and len(datagram) >= 46:
                if ping is None or struct.unpack_from("<H", datagram, 8)[0] & 0xFF != ping.ping_id & 0xFF:
                    ping, retries = _Arriving(datagram), 0
            elif datagram is not None and ping is not None:
                ping.add(datagram)
            if ping is None or not (ping.tail or datagram is None):
                continue
            gaps = ping.gaps()
            if not gaps:
                return self._made(ping, sound_speed_mps)
            if retries < _RETRIES and (datagram is None or datagram[0] == PING_TAIL):
                retries += 1
                for first, count in gaps:
                    self._send(_header(0x30, self.status.sonar_id) + struct.pack("<HHHH", 1, first, count, 0))

    @staticmethod
    def _made(ping: _Arriving, sound_speed_mps: float) -> Ping:
        bin_m = sound_speed_mps / (2 * LINE_RATE_HZ) * 2 ** ping.compression
        return Ping(samples=ping.samples(), ranges_m=(np.arange(ping.count) + 0.5) * bin_m,
                    bearings_rad=bearings_rad(ping.beams), transmit_us=ping.transmit_us,
                    missing=ping.count - len(ping.lines), sound_speed_mps=sound_speed_mps, frequency_hz=_FREQUENCY_HZ,
                    beamwidth_rad=_BEAMWIDTH_RAD, vertical_beamwidth_rad=_VERTICAL_BEAMWIDTH_RAD)
