#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Draws one ping in each world of tests/data/public_worlds, side by side (needs python3-pil).

    tests/pictures/public_worlds.py build/release/bin/sonard docs/images/public_worlds.webp
"""

import argparse
import math
import os
import pathlib
import subprocess
import tempfile

from PIL import Image, ImageDraw

WORLDS = pathlib.Path(__file__).resolve().parents[1] / "data" / "public_worlds"
COLUMNS = 3
CAPTION_PX = 18
CONFIG = """
engine: cpu
world: {{file: {world}, missing: skip}}
poses: {{initial: {{position_m: [0, 0, -3]}}}}
heads:
  - name: bow
    type: gemini_720i
    sonar_id: 513
    network: {{alternate_address: 127.0.0.2, netmask: 255.0.0.0}}
"""
# Position of the sonar in metres, and its pitch downwards in radians.
VIEWS = {
    "uuv_classic.world": ((2, 0, -10), 0.25),
    "dave_ocean.world": ((0, 0, -4.2), 0.15),
    "vrx_regatta.sdf": ((0, 0, -1.2), 0.15),
    "ardusub_underwater.world": ((0.6, 0, -6), 0.15),
    "sdf_1_10.sdf": ((0, 0, -2.8), 0.15),
    "sdf_1_11.sdf": ((1, 0, -3.5), 0.15),
    "sdf_1_12.sdf": ((1, 0, -3.8), 0.12),
    "nested_includes.sdf": ((1, 0, -3), 0.1),
    "heightmap_lake.sdf": ((-4, -2, -7), 0.15),
    "glb_wreck.sdf": ((0, -1, -17.5), 0.2),
    "lrauv_trench.sdf": ((2, 0, -27.5), 0.15),
}


def ping(sonard, world, position_m, pitch_rad, folder):
    config, trajectory = folder / "sonard.yaml", folder / "still.csv"
    config.write_text(CONFIG.format(world=WORLDS / world), encoding="utf-8")
    pose = ",".join("%g" % v for v in (*position_m, 0, math.sin(pitch_rad / 2), 0, math.cos(pitch_rad / 2)))
    trajectory.write_text(f"t,x,y,z,qx,qy,qz,qw\n0,{pose}\n0.01,{pose}\n", encoding="utf-8")
    subprocess.run([sonard, "render", config, "--trajectory", trajectory, "--out", folder / "out", "--range", "15",
                    "--compression", "1", "--size", "230"], check=True,
                   env={**os.environ, "GZ_FUEL_CACHE_PATH": str(WORLDS / "fuel")})
    return Image.open(folder / "out" / "ping_000000.png").convert("RGB")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("sonard", type=pathlib.Path, help="the program")
    parser.add_argument("out", help="a picture file")
    options = parser.parse_args()
    pictures = {}
    for world, (position_m, pitch_rad) in VIEWS.items():
        with tempfile.TemporaryDirectory() as folder:
            pictures[world] = ping(options.sonard.resolve(), world, position_m, pitch_rad, pathlib.Path(folder))
    width, height = next(iter(pictures.values())).size
    height += CAPTION_PX
    sheet = Image.new("RGB", (COLUMNS * width, -(-len(pictures) // COLUMNS) * height))
    draw = ImageDraw.Draw(sheet)
    for i, (world, picture) in enumerate(pictures.items()):
        x, y = i % COLUMNS * width, i // COLUMNS * height
        sheet.paste(picture, (x, y + CAPTION_PX))
        draw.text((x + 6, y + 3), world, fill=(230, 230, 230))
    sheet.save(options.out, quality=70)


if __name__ == "__main__":
    main()
