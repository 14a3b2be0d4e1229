#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints a checksum of each image that `sonard render` makes from the scenes of configs/, on both engines.

If a change must not alter images, compare the output before and after it, on one machine:

    tests/images/image_checksums.py build/release/bin/sonard > before.txt
    ... build the change ...
    tests/images/image_checksums.py build/release/bin/sonard | diff before.txt -
"""

import argparse
import hashlib
import os
import subprocess
import sys
import tempfile

CONFIGS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "configs")

# Configuration, trajectory, head (None: the first), seconds of the trajectory, further options.
SCENES = [
    ("demo", "docking_demo", None, 0.35, []),
    ("demo", "docking_demo", None, 0.25, ["--bits", "16", "--compression", "1"]),
    ("paper", "docking_demo", None, 0.25, []),
    ("recording", "docking_demo", None, 0.15, ["--truth"]),
    ("gemini-and-micron", "docking_demo", None, 0.15, []),
    ("gemini-and-micron", "docking_demo", 1, 2.2, ["--rate", "100"]),
    ("manifold", "manifold_demo", None, 0.15, []),
    ("ssiv", "ssiv_demo", None, 0.15, []),
    ("gazebo", "docking_demo", None, 0.15, []),
    ("demo-micron", "tank", None, 2.2, ["--rate", "100"]),
    ("demo-micron", "tank", None, 2.2, ["--rate", "100", "--sector", "-40", "60", "--bins", "300"]),
    ("grid-micron", "grid", None, 2.2, ["--rate", "100"]),
    ("oil-and-gas-micron", "oil_and_gas", None, 2.2, ["--rate", "100"]),
]


def head_names(config):
    return [line.split("name:")[1].strip() for line in config.splitlines() if line.startswith("  - name:")]


def without_sections(config, names):
    kept, dropping = "", False
    for line in config.splitlines():
        if line[:1] not in ("", " ", "#"):
            dropping = line.split(":")[0] in names
        kept += "" if dropping else line + "\n"
    return kept


def shortened(path, seconds):
    with open(path, encoding="utf-8") as file:
        title, *rows = file.read().splitlines()
    start = float(rows[0].split(",")[0])
    return "\n".join([title] + [row for row in rows if float(row.split(",")[0]) - start <= seconds]) + "\n"


def render(sonard, scene, engine, folder):
    name, trajectory, head, seconds, options = scene
    with open(os.path.join(CONFIGS, name + ".yaml"), encoding="utf-8") as file:
        config = file.read()
    with open(os.path.join(folder, "config.yaml"), "w", encoding="utf-8") as file:
        file.write(f"engine: {engine}\n" + without_sections(config, ("engine", "recording")))
    with open(os.path.join(folder, "way.csv"), "w", encoding="utf-8") as file:
        file.write(shortened(os.path.join(CONFIGS, "trajectories", trajectory + ".csv"), seconds))
    for shared in ("worlds", "trajectories"):
        os.symlink(os.path.abspath(os.path.join(CONFIGS, shared)), os.path.join(folder, shared))
    out = os.path.join(folder, "out")
    command = [sonard, "render", os.path.join(folder, "config.yaml"), "--trajectory", os.path.join(folder, "way.csv"),
               "--out", out, "--size", "64", *options]
    if head is not None:
        command += ["--head", head_names(config)[head]]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
    for file_name in sorted(os.listdir(out)):
        if file_name.endswith((".npy", ".glf")):
            with open(os.path.join(out, file_name), "rb") as file:
                yield file_name, hashlib.sha256(file.read()).hexdigest()[:16]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sonard")
    parser.add_argument("--engine", action="append", help="cpu or gpu; both when left out")
    arguments = parser.parse_args()
    for scene in SCENES:
        for engine in arguments.engine or ("cpu", "gpu"):
            with tempfile.TemporaryDirectory(prefix="sonard-images-") as folder:
                for file_name, checksum in render(arguments.sonard, scene, engine, folder):
                    print(scene[0], engine, *scene[4], file_name, checksum, flush=True)


if __name__ == "__main__":
    main()
