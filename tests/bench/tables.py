#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Prints what sonard_bench wrote as the Markdown tables of docs/benchmark.md.

  tests/bench/tables.py out/bench.json
"""

import argparse
import math

from bench_results import Results

HEADER = ("preset", "samples k", "ping ms (p95)", "visibility ms", "bin RMS (trim) %", "first echo bins", "holes",
          "holes -60 dB", "worst beam total %", "MiB")


def number(value, scale=1.0):
    return "-" if value is None else f"{value * scale:.3g}"


def row(preset, values):
    get = values.get
    return (preset, number(get("samples"), 1e-3), f"{number(get('ping_ms'))} ({number(get('ping_ms_p95'))})",
            number(get("visibility_ms")), f"{number(get('bin_rms'), 100)} ({number(get('bin_rms_trim'), 100)})",
            number(get("first_echo_bins")), number(get("hole_fraction")), number(get("hole_fraction_60db")),
            number(get("beam_total_worst"), 100), number(get("peak_memory")))


def order(results, scene, engine, start):
    """p of error ~ samples^-p by least squares over the finer half of a ladder."""
    curve = results.curve(scene, engine, start, x="samples")
    curve = curve[len(curve) // 2:]
    if len(curve) < 2:
        return None
    xs = [math.log(p[0]) for p in curve]
    ys = [math.log(p[1]) for p in curve]
    x0, y0 = sum(xs) / len(xs), sum(ys) / len(ys)
    return -sum((x - x0) * (y - y0) for x, y in zip(xs, ys)) / sum((x - x0) ** 2 for x in xs)


def time_to(results, scene, engine, error):
    """The fastest point that keeps the error."""
    good = [(v["ping_ms"], p) for p, v in results.of(scene, engine).items() if v.get("bin_rms", math.inf) <= error]
    return min(good, default=None)


def print_scene(results, scene):
    for engine in results.engines():
        points = results.of(scene, engine)
        if not points:
            continue
        print(f"\n### {scene}, {engine}\n")
        print("| " + " | ".join(HEADER) + " |")
        print("|" + "---|" * len(HEADER))
        for preset, values in points.items():
            if "ping_ms" in values:
                print("| " + " | ".join(row(preset, values)) + " |")
        notes = []
        for error in (0.05, 0.01):
            best = time_to(results, scene, engine, error)
            if best:
                notes.append(f"{error:.0%} in {number(best[0])} ms ({best[1]})")
        for name, start in (("grids", "grid_"), ("points", "point_")):
            p = order(results, scene, engine, start)
            if p is not None:
                notes.append(f"error of {name} ~ samples^-{p:.2f}")
        if notes:
            print("\n" + "; ".join(notes) + ".")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("json")
    results = Results(parser.parse_args().json)
    for scene in results.scenes():
        print_scene(results, scene)


if __name__ == "__main__":
    main()
