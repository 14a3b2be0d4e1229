#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints results of sonard_bench for presets as the Markdown table of docs/benchmark.md. Each cell has the values of
`fast / default / reference`.

  tests/bench/tables.py out/bench.json
"""

import argparse

from bench_results import Results

PRESETS = ("fast", "default", "reference")
# Title, metric, factor.
COLUMNS = (("ping ms", "ping_ms", 1), ("bin RMS %", "bin_rms", 100), ("worst beam total %", "beam_total_worst", 100),
           ("first echo, bins", "first_echo_bins", 1), ("holes -60 dB", "hole_fraction_60db", 1))
# Scenes of other sections, and a scene without anything in range.
OTHERS = ("bodies", "terrain", "recording", "b2_seabed_10m")


def cell(presets, metric, scale):
    """One value for each preset; a single dash if the metric was not measured."""
    numbers = [f"{values[metric] * scale:.3g}" if metric in values else "-" for values in presets]
    return " / ".join(numbers) if set(numbers) != {"-"} else "-"


def print_row(cells):
    print("| " + " | ".join(cells) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("json")
    results = Results(parser.parse_args().json)
    print_row(["scene", "engine"] + [title for title, _, _ in COLUMNS])
    print("|" + "---|" * (2 + len(COLUMNS)))
    for scene in results.scenes():
        if "@" in scene or scene.startswith(OTHERS):
            continue
        for engine in results.engines():
            measured = results.of(scene, engine)
            presets = [measured.get(preset, {}) for preset in PRESETS]
            if any("ping_ms" in values for values in presets):
                print_row([f"`{scene}`", engine] + [cell(presets, *column[1:]) for column in COLUMNS])


if __name__ == "__main__":
    main()
