# SPDX-License-Identifier: Apache-2.0
"""Smooth, repeatable noise without any library: integer hashing, so the same everywhere."""

import math


def _hash01(*keys):
    """A number in [0, 1) that depends on integer keys only."""
    h = 0x9E3779B97F4A7C15
    for key in keys:
        h = ((h ^ (key & 0xFFFFFFFF)) * 0xBF58476D1CE4E5B9) & 0xFFFFFFFFFFFFFFFF
        h ^= h >> 29
        h = (h * 0x94D049BB133111EB) & 0xFFFFFFFFFFFFFFFF
        h ^= h >> 32
    return (h >> 11) / float(1 << 53)


def uniform(low, high, *keys):
    return low + (high - low) * _hash01(*keys)


def smoothstep(low, high, x):
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3.0 - 2.0 * t)


def value_noise(seed, x, y, z=0.0):
    """Noise in [-1, 1] with features about one unit wide."""
    ix, iy, iz = math.floor(x), math.floor(y), math.floor(z)
    fx, fy, fz = (smoothstep(0.0, 1.0, f) for f in (x - ix, y - iy, z - iz))
    total = 0.0
    for dx, wx in ((0, 1.0 - fx), (1, fx)):
        for dy, wy in ((0, 1.0 - fy), (1, fy)):
            for dz, wz in ((0, 1.0 - fz), (1, fz)):
                weight = wx * wy * wz
                if weight > 0.0:
                    total += weight * _hash01(seed, ix + dx, iy + dy, iz + dz)
    return 2.0 * total - 1.0


def layered_noise(seed, x, y, octaves, z=0.0):
    """Octaves of value noise: each half as wide and half as high as the one before."""
    total, amplitude, frequency = 0.0, 1.0, 1.0
    for octave in range(octaves):
        total += amplitude * value_noise(seed + octave, x * frequency, y * frequency, z * frequency)
        amplitude *= 0.5
        frequency *= 2.0
    return total
