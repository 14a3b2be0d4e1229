#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints random poses that look at the labelled bodies of a world, as a trajectory for `sonard render --still`.

The sonar looks 20 degrees down from 3 to 10 m away, and not exactly at the body. Without the world's file, as for open
water, the poses are around (0, 0, -10). Needs NumPy and PyYAML.
"""
import argparse
import math
import pathlib
from fnmatch import fnmatchcase
from xml.etree import ElementTree

import numpy as np
import yaml

INSIDE = {"tank": (6.5, 4.5), "gazebo_basin": (5.5, 3.5)}  # worlds with walls: most |x| and |y| of the sonar, in metres


def targets(world, patterns):
    """Positions of models that have a class and a pose of their own."""
    if not world.exists():
        return [(0.0, 0.0, -10.0)]
    places = [(model.get("name"), [float(word) for word in (model.findtext("pose") or "0 0 0").split()[:3]])
              for model in ElementTree.parse(world).findall("world/model")]
    return [place for name, place in places if any(place) and any(fnmatchcase(name, pattern) for pattern in patterns)]


def pose(random, places, most):
    while True:
        x, y, z = places[random.integers(len(places))]
        distance, bearing = random.uniform(3, 10), random.uniform(0, 2 * math.pi)
        x, y = x - distance * math.cos(bearing), y - distance * math.sin(bearing)
        z += distance * math.tan(math.radians(20)) * random.uniform(0.7, 1.3)
        if abs(x) < most[0] and abs(y) < most[1] and z < -0.5:
            heading = bearing + random.normal(0, math.radians(15))
            return x, y, z, 0, 0, math.sin(heading / 2), math.cos(heading / 2)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("world", type=pathlib.Path)
    parser.add_argument("--labels", type=pathlib.Path, required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--count", type=int, required=True)
    options = parser.parse_args()
    places = targets(options.world, yaml.safe_load(options.labels.read_text(encoding="utf-8")))
    random, most = np.random.default_rng(options.seed), INSIDE.get(options.world.stem, (math.inf, math.inf))
    print("t,x,y,z,qx,qy,qz,qw")
    for number in range(options.count):
        print(",".join(f"{value:.4f}" for value in (number, *pose(random, places, most))))


if __name__ == "__main__":
    main()
