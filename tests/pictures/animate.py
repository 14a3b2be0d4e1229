#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Makes an animation from frames of `sonard render` (needs python3-pil).

    sonard render configs/demo.yaml --trajectory configs/trajectories/docking_demo.csv --out out/demo \\
        --rate 1 --range 25 --compression 1 --size 420
    tests/pictures/animate.py out/demo docs/images/docking_demo.webp --times 4
"""

import argparse
import pathlib

from PIL import Image


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("frames", type=pathlib.Path, help="folder with the PNGs")
    parser.add_argument("out", help="an animated .webp")
    parser.add_argument("--times", type=float, default=1.0, help="how many frames are shown in a second")
    parser.add_argument("--quality", type=int, default=50, help="0..100")
    options = parser.parse_args()
    frames = [Image.open(path).convert("RGB") for path in sorted(options.frames.glob("**/*.png"))]
    if not frames:
        parser.error(f"{options.frames} has no PNG")
    frames[0].save(options.out, save_all=True, append_images=frames[1:], duration=round(1000 / options.times), loop=0,
                   quality=options.quality, method=6)
    print(f"{options.out}: {len(frames)} frames of {frames[0].width} x {frames[0].height}")


if __name__ == "__main__":
    main()
