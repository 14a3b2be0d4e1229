#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws error against time, and time against size, from results of sonard_bench.

  tests/bench/plot.py out/bench.json docs/images/benchmark
"""

import argparse
import pathlib
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402  (after the choice of engine)

from bench_results import Results, pareto  # noqa: E402

COLOURS = {"cpu": "#0b6fb8", "gpu": "#c2570c"}  # also distinct for colour-blind readers
PRESETS = {"fast": "v", "default": "s", "reference": "D"}
SEABED = ["plane", "flat100k", "swell100k", "ripple100k", "swell1m", "docking"]
SCANNING = ["msis_swell", "msis_ripple"]
LEGEND_LINE_IN = 0.18
SIZES = {"triangles": "triangles", "beams": "beams", "bins": "range lines", "cores": "cores"}


def draw_engine(axes, results, scene, engine):
    colour = COLOURS[engine]
    grid = results.curve(scene, engine, "grid_")
    axes.plot([p[0] for p in grid], [p[1] for p in grid], "o", color=colour, ms=3.5, alpha=0.55,
              label=f"{engine}: fixed grids")
    points = results.curve(scene, engine, "point_")
    axes.plot([p[0] for p in points], [p[1] for p in points], "x--", color=colour, ms=5, lw=0.8, alpha=0.55,
              label=f"{engine}: points, no footprint")
    presets = [p for name in PRESETS for p in results.curve(scene, engine, name) if p[2] == name]
    for x, y, name in presets:  # named in the legend, because names beside the marks would overlap
        axes.plot(x, y, PRESETS[name], color=colour, ms=8, mec="black", mew=0.6, label=f"{engine}: {name}")
    front = pareto(grid + presets)
    axes.plot([p[0] for p in front], [p[1] for p in front], "-", color=colour, lw=1.4, label=f"{engine}: best")


def draw_scene(axes, results, scene):
    for engine in results.engines():
        draw_engine(axes, results, scene, engine)
    for bound in (0.05, 0.01):
        axes.axhline(bound, color="grey", lw=0.6, ls=":")
    axes.set(xscale="log", yscale="log", title=scene)
    axes.grid(True, which="major", lw=0.3)


def draw_fronts(results, scenes, path):
    """One panel for each scene with a reference; draws nothing if no scene has one."""
    scenes = [s for s in scenes if any("bin_rms" in v for b in results.engines() for v in results.of(s, b).values())]
    if not scenes:
        return
    columns = min(3, len(scenes))
    rows = -(-len(scenes) // columns)
    figure, panels = plt.subplots(rows, columns, figsize=(4.4 * columns, 3.6 * rows), squeeze=False)
    for axes in panels.flat[len(scenes):]:
        axes.axis("off")
    for axes, scene in zip(panels.flat, scenes):
        draw_scene(axes, results, scene)
    for axes in panels[:, 0]:
        axes.set_ylabel("bin RMS error")
    for axes in panels.flat[max(0, len(scenes) - columns):len(scenes)]:
        axes.set_xlabel("ms per ping")
    add_legend(figure, panels.flat[0], min(4, columns + 1))
    save(figure, path)


def add_legend(figure, axes, columns):
    """Adds a legend below all panels, on a free strip of the figure."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncol=columns, fontsize=8, frameon=False)
    strip_in = 0.15 + LEGEND_LINE_IN * -(-len(labels) // columns)
    figure.tight_layout(rect=(0, strip_in / figure.get_figheight(), 1, 1))


def draw_growth(results, path):
    """Time of each preset against size, log-log; scenes are named NAME@WHAT=VALUE."""
    families = {}
    for scene in results.scenes():
        match = re.fullmatch(r".*@(\w+)=(.*)", scene)
        if match:
            families.setdefault(match[1], []).append((float(match[2]), scene))
    if not families:
        return
    figure, panels = plt.subplots(1, len(families), figsize=(3.6 * len(families), 3.4), squeeze=False)
    for axes, (what, members) in zip(panels.flat, families.items()):
        for engine in results.engines():
            for preset, marker in PRESETS.items():
                line = [(x, results.points[s, engine, preset][results.time]) for x, s in sorted(members)
                        if results.time in results.points.get((s, engine, preset), {})]
                axes.plot([p[0] for p in line], [p[1] for p in line], marker + "-", color=COLOURS[engine], ms=4,
                          lw=1, label=f"{engine} {preset}" if line else None)
        axes.set(xscale="log", yscale="log", xlabel=SIZES.get(what, what))
        if what == "cores":  # too few values for the labels of a logarithmic axis
            axes.set(xscale="linear", xticks=[x for x, _ in sorted(members)])
        axes.grid(True, which="major", lw=0.3)
    panels[0, 0].set_ylabel("ms per ping")
    add_legend(figure, panels[0, -1], 6)
    save(figure, path)


def save(figure, path):
    figure.savefig(path, dpi=110, metadata={"Software": None})  # the same picture gives the same bytes
    plt.close(figure)
    print(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("json", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--least", action="store_true", help="least times and not medians: of a busy machine")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    results = Results(arguments.json, "ping_ms_min" if arguments.least else "ping_ms")
    standard = [s for s in results.scenes() if "@" not in s]
    draw_fronts(results, [s for s in SEABED if s in standard], arguments.folder / "pareto_seabed.png")
    draw_fronts(results, [s for s in SCANNING if s in standard], arguments.folder / "pareto_scanning.png")
    draw_fronts(results, [s for s in standard if re.match(r"b\d_", s)], arguments.folder / "pareto_b1_to_b7.png")
    draw_growth(results, arguments.folder / "growth.png")


if __name__ == "__main__":
    main()
