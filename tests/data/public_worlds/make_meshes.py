#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes the meshes and the heightmap of the worlds beside it, in the formats that public worlds have them in.

    make_meshes.py

A hull as GLB with y up, an amphora as COLLADA in inches with y up, a concrete block as binary STL in millimetres,
a frame of pipes as OBJ. Sizes are what public_worlds_test.cpp expects.
"""

import json
import math
import os
import struct
import zlib

HERE = os.path.dirname(os.path.abspath(__file__))


def with_area(points, triangles):
    """Without triangles that have the same place twice, as at poles."""
    return points, [t for t in triangles if len({points[c] for c in t}) == 3]


def revolution(profile, around=24):
    """A closed surface about z from (radius, z) pairs, bottom to top, which begin and end on the axis."""
    points, triangles = [], []
    for radius, z in profile:
        for k in range(around):
            angle = 2 * math.pi * k / around
            points.append((round(radius * math.cos(angle), 6), round(radius * math.sin(angle), 6), z))
    for ring in range(len(profile) - 1):
        for k in range(around):
            a, b = ring * around + k, ring * around + (k + 1) % around
            triangles += [(a, b, b + around), (a, b + around, a + around)]
    return with_area(points, triangles)


def box(size, centre=(0, 0, 0)):
    points = [tuple(c + (0.5 if (k >> axis) & 1 else -0.5) * s for axis, (c, s) in enumerate(zip(centre, size)))
              for k in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return points, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def hull():
    """A wreck's hull along x, 12 m long, 3 m wide, 2 m high, keel at z = 0: frames of half an ellipse, an open top."""
    points, triangles = [], []
    frames, ribs = 16, 13
    for i in range(frames + 1):
        x = -6 + 12 * i / frames
        fullness = math.sqrt(max(0.0, 1 - (x / 6) ** 2))
        for k in range(ribs):
            angle = math.pi * k / (ribs - 1)
            points.append((x, round(-1.5 * fullness * math.cos(angle), 6), round(2 - 2 * fullness * math.sin(angle), 6)))
    for i in range(frames):
        for k in range(ribs - 1):
            a = i * ribs + k
            triangles += [(a, a + ribs, a + 1), (a + 1, a + ribs, a + ribs + 1)]
    return with_area(points, triangles)


def write_glb(path, name, material, points, triangles):
    """With y up: (x, y, z) is written as (x, z, -y)."""
    points = [(x, z, -y) for x, y, z in points]
    positions = b"".join(struct.pack("<3f", *p) for p in points)
    indices = b"".join(struct.pack("<3H", *t) for t in triangles)
    indices += b"\0" * (-len(indices) % 4)
    text = json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
        "nodes": [{"name": name, "mesh": 0}],
        "materials": [{"name": material, "doubleSided": True}],
        "meshes": [{"name": name, "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "material": 0}]}],
        "buffers": [{"byteLength": len(positions) + len(indices)}],
        "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": len(positions)},
                        {"buffer": 0, "byteOffset": len(positions), "byteLength": len(indices)}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
                       "min": [min(c) for c in zip(*points)], "max": [max(c) for c in zip(*points)]},
                      {"bufferView": 1, "componentType": 5123, "count": 3 * len(triangles), "type": "SCALAR"}],
    }).encode()
    text += b" " * (-len(text) % 4)
    binary = positions + indices
    with open(path, "wb") as file:
        file.write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def write_dae(path, points, triangles, unit_m):
    """With y up, in units of `unit_m`."""
    numbers = " ".join("%.6g %.6g %.6g" % (x / unit_m, z / unit_m, -y / unit_m) for x, y, z in points)
    corners = " ".join("%d %d %d" % t for t in triangles)
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"""<?xml version="1.0" encoding="utf-8"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
  <asset><unit meter="{unit_m}" name="inch"/><up_axis>Y_UP</up_axis></asset>
  <library_geometries>
    <geometry id="jar" name="jar"><mesh>
      <source id="points"><float_array id="numbers" count="{3 * len(points)}">{numbers}</float_array>
        <technique_common><accessor source="#numbers" count="{len(points)}" stride="3">
          <param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/>
        </accessor></technique_common></source>
      <vertices id="vertices"><input semantic="POSITION" source="#points"/></vertices>
      <triangles count="{len(triangles)}"><input semantic="VERTEX" source="#vertices" offset="0"/><p>{corners}</p></triangles>
    </mesh></geometry>
  </library_geometries>
  <library_visual_scenes><visual_scene id="scene">
    <node id="jar-node"><instance_geometry url="#jar"/></node>
  </visual_scene></library_visual_scenes>
  <scene><instance_visual_scene url="#scene"/></scene>
</COLLADA>
""")


def write_stl(path, points, triangles):
    with open(path, "wb") as file:
        file.write(b"binary STL".ljust(80) + struct.pack("<I", len(triangles)))
        for triangle in triangles:
            file.write(struct.pack("<3f", 0, 0, 0))
            for corner in triangle:
                file.write(struct.pack("<3f", *points[corner]))
            file.write(b"\0\0")


def write_obj(path, name, parts):
    with open(path, "w", encoding="utf-8") as file:
        file.write(f"o {name}\n")
        base = 1
        for points, triangles in parts:
            file.writelines("v %.6g %.6g %.6g\n" % p for p in points)
            file.writelines("f %d %d %d\n" % tuple(base + c for c in t) for t in triangles)
            base += len(points)


def write_png(path, heights):
    """16 bits of grey; `heights` are rows from the top, 0 to 1."""
    rows = b"".join(b"\0" + b"".join(struct.pack(">H", round(65535 * h)) for h in row) for row in heights)

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        file.write(chunk(b"IHDR", struct.pack(">IIBBBBB", len(heights[0]), len(heights), 16, 0, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b""))


def lake_bed(side=65):
    """A bowl with a ridge across it; its rim is 1, its middle 0."""
    def height(i, k):
        x, y = 2 * k / (side - 1) - 1, 2 * i / (side - 1) - 1
        bowl = min(1.0, x * x + y * y)
        return min(1.0, bowl + 0.25 * (1 - bowl) * math.exp(-(8 * (x - 0.3 * y - 0.25)) ** 2))
    return [[height(i, k) for k in range(side)] for i in range(side)]


def main():
    os.chdir(HERE)
    write_glb("models/wreck/meshes/hull.glb", "hull", "steel_fouled", *hull())
    write_dae("models/amphora/meshes/amphora.dae", *revolution(
        [(0, 0), (0.08, 0), (0.3, 0.3), (0.36, 0.55), (0.25, 0.85), (0.1, 1.0), (0.14, 1.2), (0, 1.2)]), unit_m=0.0254)
    write_stl("models/dock_block/meshes/block.stl", *box((2000, 2000, 600)))
    write_obj("models/bluerov2/meshes/frame.obj", "frame", [
        box((0.46, 0.02, 0.25), (0, 0.16, 0)), box((0.46, 0.02, 0.25), (0, -0.16, 0)),
        box((0.30, 0.32, 0.02), (0, 0, -0.1)), box((0.33, 0.11, 0.11), (0, 0, 0.06)), box((0.25, 0.09, 0.09), (0, 0, -0.05))])
    write_png("models/lake_bed/materials/lake_bed.png", lake_bed())


if __name__ == "__main__":
    main()
