#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the speed of each set of vector instructions: one program for each, in turns on this machine.

    instruction_sets.py [--rounds N] [--built]

Builds sonard_bench with hot loops for sse2, avx2 and avx512f only (-DSONARD_SIMD, folders build/simd-*), and runs each
with --quick. Prints the median of the rounds and the ratio to sse2. `sonard_bench --quick` also ends with this table,
for the existing builds. All sets give the same images to the bit: tests/images/image_checksums.py checks this for any of
these builds.
"""

import argparse
import json
import os
import statistics
import subprocess
import tempfile

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
SETS = ("sse2", "avx2", "avx512f")
METRICS = ("ping_ms", "receiver_ms", "receiver_2411_ms")


def supported():
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        flags = next((line for line in file if line.startswith("flags")), "").split()
    return [name for name in SETS if name in flags]


def folder_of(name):
    return os.path.join(SOURCE, "build", f"simd-{name}")


def program_of(name):
    return os.path.join(folder_of(name), "bin", "sonard_bench")


def build(name):
    quiet = {"stdout": subprocess.DEVNULL, "check": True, "cwd": SOURCE}
    subprocess.run(["cmake", "--preset", "release", "-B", folder_of(name), "-DSONARD_TESTS=ON", f"-DSONARD_SIMD={name}"],
                   **quiet)
    subprocess.run(["cmake", "--build", folder_of(name), "--target", "sonard_bench"], **quiet)


def measure(name):
    with tempfile.TemporaryDirectory() as folder:
        out = os.path.join(folder, "bench.json")
        subprocess.run([program_of(name), "--quick", "--engine", "cpu", "--json", out], stdout=subprocess.DEVNULL,
                       stderr=subprocess.DEVNULL, check=True)
        with open(out, encoding="utf-8") as file:
            return {(m["scene"], m["preset"], m["metric"]): m["value"] for m in json.load(file) if m["metric"] in METRICS}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--built", action="store_true", help="only what is built; one round")
    args = parser.parse_args()
    names = supported()
    if args.built:
        names = [name for name in names if os.path.exists(program_of(name))]
        if not names:
            print("\nno program for one set of vector instructions alone: tests/bench/instruction_sets.py builds them")
            return
    else:
        for name in names:
            build(name)
    rounds = {name: [] for name in names}
    for _ in range(1 if args.built else args.rounds):
        for name in names:
            rounds[name].append(measure(name))
    print(f"\n{'scene':18} {'preset':14} {'metric':17}" + "".join(f"{name + ', ms':>13} {'ratio':>6}" for name in names))
    for key in rounds[names[0]][0]:
        scene, preset, metric = key
        if "@" in scene or scene.endswith("1m"):
            continue
        ms = [statistics.median(times[key] for times in rounds[name]) for name in names]
        print(f"{scene:18} {preset:14} {metric:17}" + "".join(f"{value:13.3g} {value / ms[0]:6.2f}" for value in ms))


if __name__ == "__main__":
    main()
