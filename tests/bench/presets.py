#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Prints a table of errors promised and kept by presets, or draws time against error, from output of tune_presets.

  tests/bench/presets.py out/presets.json                                prints the table
  tests/bench/presets.py out/drawn.json --picture docs/images/benchmark/presets.png
"""

import argparse
import collections
import json
import math

from bench_results import pareto

# The promises of each preset for all scenes and poses. A promise for beams covers 99 % of them.
PROMISES = {"fast": {"bin_rms": 0.05, "total_p99": 0.01, "centroid_lines_p99": 2.0, "first_echo_lines_p99": 1.0,
                     "holes": 1e-3},
            "default": {"bin_rms": 0.01, "total_p99": 0.002, "centroid_lines_p99": 0.25, "first_echo_lines_p99": 0.5,
                        "holes": 1e-5}}
# Facets concentrate the echo, so that a small displacement of an edge changes the sums of a beam more.
PROMISES_WITH_FACETS = {"fast": {"bin_rms": 0.05, "total_p99": 0.02, "centroid_lines_p99": 4.0, "first_echo_lines_p99": 2.0,
                                 "holes": 1e-3},
                        "default": {"bin_rms": 0.0125, "total_p99": 0.003, "centroid_lines_p99": 0.75,
                                    "first_echo_lines_p99": 1.0, "holes": 1e-4}}
WITH_FACETS = ["docking_demo"]
# Thin pipes alone in the water: a beam may hold a sliver of one and nothing else.
WITHOUT_PROMISE = ["b7_pipes"]
COLUMNS = {"bin_rms": ("bins %", 100), "total_p99": ("total %", 100), "centroid_lines_p99": ("centroid", 1),
           "first_echo_lines_p99": ("first echo", 1), "holes": ("holes %", 100)}


def by_set(path):
    """{set: {scene: row}}"""
    sets = collections.defaultdict(dict)
    with open(path, encoding="utf-8") as file:
        for row in json.load(file):
            # JSON has no infinity, the centroid error of a beam without an echo.
            sets[row["set"]][row["scene"]] = {key: math.inf if value is None else value for key, value in row.items()}
    return sets


def text_of(value):
    return "0" if value == 0 else "-" if value == math.inf else f"{value:.2g}"


def promises(scene):
    return PROMISES_WITH_FACETS if scene in WITH_FACETS else PROMISES


def print_table(sets):
    """Prints each scene as `fast / default`, then the worst of the scenes without facets, then the promises."""
    print("| scene | " + " | ".join(name for name, _ in COLUMNS.values()) + " |")
    print("|---" * (len(COLUMNS) + 1) + "|")
    rows = {f"`{scene}`": [sets[name][scene] for name in PROMISES] for scene in sets["fast"]}
    plain = [scene for scene in sets["fast"] if scene not in WITH_FACETS + WITHOUT_PROMISE]
    rows["worst without facets"] = [{key: max((sets[name][scene][key] for scene in plain), default=0.0) for key in COLUMNS} for name in PROMISES]
    rows["promise"] = list(PROMISES.values())
    rows["promise with facets"] = list(PROMISES_WITH_FACETS.values())
    for name, values in rows.items():
        text = "{:g}".format if name.startswith("promise") else text_of
        cells = [" / ".join(text(factor * value[key]) for value in values) for key, (_, factor) in COLUMNS.items()]
        print(f"| {name} | " + " | ".join(cells) + " |")


def broken(sets):
    """Lines about broken promises."""
    for name in PROMISES:
        for scene, row in sets[name].items():
            if scene in WITHOUT_PROMISE:
                continue
            for key, limit in promises(scene)[name].items():
                if row[key] > limit:
                    yield f"{name}, {scene}: {key} is {row[key]:.3g}, promised {limit:g}"


def draw(sets, path):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    def place(name):
        """Time as the mean ratio to `fast` over the scenes, and the largest error."""
        rows = {scene: row for scene, row in sets[name].items() if scene not in WITHOUT_PROMISE}
        logs = [math.log(row["cpu_ms"] / sets["fast"][scene]["cpu_ms"]) for scene, row in rows.items()]
        return math.exp(sum(logs) / len(logs)), max(row["bin_rms"] for row in rows.values()), name

    points = [place(name) for name in sets if set(sets[name]) == set(sets["fast"])]
    front = pareto(points)
    figure, axes = plt.subplots(figsize=(6.4, 4.2))
    axes.plot([p[0] for p in points], [p[1] for p in points], "o", color="#0b6fb8", ms=3, alpha=0.4, label="drawn sets")
    axes.plot([p[0] for p in front], [p[1] for p in front], "-", color="#0b6fb8", lw=1.2, label="best of them")
    for name, mark in (("fast", "v"), ("default", "s")):
        x, y, _ = place(name)
        axes.plot(x, y, mark, color="#c2570c", ms=9, mec="black", mew=0.6, label=name)
        axes.axhline(PROMISES[name]["bin_rms"], color="grey", lw=0.7, ls=":")
    axes.set(xscale="log", yscale="log", xlabel="CPU time / that of fast, geometric mean of the scenes",
             ylabel="RMS of bins, worst scene")
    axes.grid(True, which="major", lw=0.3)
    axes.legend(fontsize=8)
    figure.tight_layout()
    figure.savefig(path, dpi=110)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", help="JSON file of tune_presets")
    parser.add_argument("--picture", metavar="FILE", help="draws instead")
    arguments = parser.parse_args()
    sets = by_set(arguments.results)
    if arguments.picture:
        draw(sets, arguments.picture)
        return
    print_table(sets)
    complaints = list(broken(sets))
    print("\n".join(complaints))
    raise SystemExit(1 if complaints else 0)


main()
