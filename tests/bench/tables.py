#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints results of sonard_bench for presets as the Markdown table of docs/benchmark.md.

  tests/bench/tables.py out/bench.json
"""

import argparse

from bench_results import Results

PRESETS = ("fast", "default", "reference")
# Title, metric, factor.
COLUMNS = (("ping ms", "ping_ms", 1), ("least", "ping_ms_min", 1), ("samples k", "samples", 1e-3),
           ("bin RMS %", "bin_rms", 100), ("trimmed %", "bin_rms_trim", 100),
           ("worst beam total %", "beam_total_worst", 100), ("first echo, bins", "first_echo_bins", 1),
           ("holes -60 dB", "hole_fraction_60db", 1))
# Scenes of other sections, and a scene without anything in range.
OTHERS = ("bodies", "terrain", "recording", "b2_seabed_10m")


def number(values, metric, scale):
    return f"{values[metric] * scale:.3g}" if metric in values else "-"


def print_row(cells):
    print("| " + " | ".join(cells) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("json")
    results = Results(parser.parse_args().json)
    print_row(["scene", "engine", "preset"] + [title for title, _, _ in COLUMNS])
    print("|" + "---|" * (3 + len(COLUMNS)))
    for scene in results.scenes():
        if "@" in scene or scene.startswith(OTHERS):
            continue
        for engine in results.engines():
            for preset, values in results.of(scene, engine).items():
                if preset in PRESETS and "ping_ms" in values:
                    print_row([f"`{scene}`", engine, preset] + [number(values, *column[1:]) for column in COLUMNS])


if __name__ == "__main__":
    main()
