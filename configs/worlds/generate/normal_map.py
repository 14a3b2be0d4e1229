# SPDX-License-Identifier: Apache-2.0
"""Tangent-space normal maps as PNG files that repeat at their edges: sand, and concrete as it comes out of its formwork."""

import math
import struct
import zlib

from noise import uniform

SIZE_PX = 128
SAND_TILE_M = 1.28
CONCRETE_TILE_M = 2.56


def _sand_relief(seed):
    """Small current ripples and grain."""
    waves = []
    for k in range(26):
        # Whole numbers of waves for each tile; most run along one direction, as current ripples do.
        fx = round(uniform(-3.0, 3.0, seed, k, 1))
        fy = round(uniform(8.0, 13.0, seed, k, 2)) if k < 14 else round(uniform(-24.0, 24.0, seed, k, 3))
        height = 0.0022 if k < 14 else 0.0007
        waves.append((fx, fy, height * uniform(0.4, 1.0, seed, k, 4), uniform(0.0, 2.0 * math.pi, seed, k, 5)))

    return [[_sum(waves, x, y) for x in range(SIZE_PX)] for y in range(SIZE_PX)]


def _concrete_relief(seed):
    """Boards 0.16 m wide that stand a little proud of each other, a groove round each panel, and a rough skin."""
    board_px, groove_m = 8, 0.005
    boards = [uniform(-0.0015, 0.0015, seed, k, 6) for k in range(SIZE_PX // board_px)]
    waves = [(round(uniform(-26.0, 26.0, seed, k, 1)), round(uniform(-26.0, 26.0, seed, k, 2)),
              uniform(0.0004, 0.0012, seed, k, 3), uniform(0.0, 2.0 * math.pi, seed, k, 4)) for k in range(24)]

    def height(x, y):
        groove = x == 0 or y % (SIZE_PX // 2) == 0  # panels of 2.56 x 1.28 m
        return boards[x // board_px] + _sum(waves, x, y) - (groove_m if groove else 0.0)

    return [[height(x, y) for x in range(SIZE_PX)] for y in range(SIZE_PX)]


def _sum(waves, x, y):
    return sum(a * math.cos(2.0 * math.pi * (fx * x + fy * y) / SIZE_PX + phase) for fx, fy, a, phase in waves)


def _chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def _normal_map(relief, tile_m):
    """Red and green are the normal's x and y (v upwards), blue its z, each from -1..1 to 0..255.

    `relief` holds heights in metres, row by row; its last row and column continue into the first.
    """
    step = 2.0 * tile_m / SIZE_PX
    rows = bytearray()
    for y in reversed(range(SIZE_PX)):  # the first row of the file is the highest v
        rows.append(0)
        for x in range(SIZE_PX):
            dx = (relief[y][(x + 1) % SIZE_PX] - relief[y][x - 1]) / step
            dy = (relief[(y + 1) % SIZE_PX][x] - relief[y - 1][x]) / step
            scale = 127.5 / math.sqrt(1.0 + dx * dx + dy * dy)
            rows += bytes(round(127.5 + round(c * scale, 3)) for c in (-dx, -dy, 1.0))
    # Stored, not deflated: zlib versions differ in what they make of the same bytes.
    return (b"\x89PNG\r\n\x1a\n" + _chunk(b"IHDR", struct.pack(">2I5B", SIZE_PX, SIZE_PX, 8, 2, 0, 0, 0)) +
            _chunk(b"IDAT", zlib.compress(bytes(rows), 0)) + _chunk(b"IEND", b""))


def sand_normal_map(seed):
    return _normal_map(_sand_relief(seed), SAND_TILE_M)


def concrete_normal_map(seed):
    return _normal_map(_concrete_relief(seed), CONCRETE_TILE_M)
