#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What each set of vector instructions is worth: one program for each, in turns on this machine.

    instruction_sets.py [--rounds N] [--scene START]

Builds sonard_bench with hot loops for sse2, avx2 and avx512f alone (-DSONARD_SIMD, folders build/simd-*) and prints the
median of the rounds, and beside it the ratio to sse2. Images are the same to the bit whichever is taken:
tests/images/image_checksums.py says so of any of these builds.
"""

import argparse
import json
import os
import statistics
import subprocess
import tempfile

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
SETS = ("sse2", "avx2", "avx512f")


def supported():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        flags = next((line for line in file if line.startswith("flags")), "").split()
    return [name for name in SETS if name in flags]


def build(name):
    folder = os.path.join(SOURCE, "build", f"simd-{name}")
    quiet = {"stdout": subprocess.DEVNULL, "check": True, "cwd": SOURCE}
    subprocess.run(["cmake", "--preset", "release", "-B", folder, "-DSONARD_TESTS=ON", f"-DSONARD_SIMD={name}"], **quiet)
    subprocess.run(["cmake", "--build", folder, "--target", "sonard_bench"], **quiet)
    return os.path.join(folder, "bin", "sonard_bench")


def measure(program, scene):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "bench.json")
        subprocess.run([program, "--engine", "cpu", "--scene", scene, "--json", out], stdout=subprocess.DEVNULL, check=True)
        with open(out, encoding="utf-8") as file:
            return {(m["scene"], m["preset"]): m["value"] for m in json.load(file) if m["metric"] == "ping_ms"}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--scene", default="flat100k", help="scenes whose names start so [flat100k]")
    args = parser.parse_args()
    names = supported()
    programs = {name: build(name) for name in names}
    rounds = {name: [] for name in names}
    for _ in range(args.rounds):
        for name, program in programs.items():
            rounds[name].append(measure(program, args.scene))
    print(f"{'scene':28} {'preset':14}" + "".join(f"{name + ', ms':>14} {'ratio':>6}" for name in names))
    for scene, preset in rounds[names[0]][0]:
        ms = [statistics.median(times[scene, preset] for times in rounds[name]) for name in names]
        print(f"{scene:28} {preset:14}" + "".join(f"{value:14.3g} {value / ms[0]:6.2f}" for value in ms))


if __name__ == "__main__":
    main()
