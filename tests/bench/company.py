#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures the demo on this machine: pings per second when served, beside busy processes, and rendered into files.

    company.py PROGRAMS [--seconds N]

Serving: a client requests a ping every 60 ms while 0, 1, 2 and 4 processes run empty loops. `CPU pings/s` are pings
per second of the daemon's CPU time; `fair` is its CPU time relative to a fair scheduler's share for two threads.
Rendering: `sonard render` of the same head and world, with and without pictures. `per core` is the rate of the whole
machine divided by its cores, `/ served` this rate divided by the rate of serving alone.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.append(os.path.join(SOURCE, "tests", "system", "gemini"))
from lab import Program

CONFIG = os.path.join(SOURCE, "configs", "demo.yaml")
TRAJECTORY = os.path.join(SOURCE, "configs", "trajectories", "docking_demo.csv")
CORES = os.cpu_count()
TICKS_PER_S = os.sysconf("SC_CLK_TCK")
INTERVAL_MS = 60
FRAMES_PER_S = 2  # of the trajectory, not of rendering


def cpu_s(pid):
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / TICKS_PER_S


def serve(programs, seconds, busy):
    """(pings per second, CPU seconds of the daemon per second)"""
    daemon = Program([f"{programs}/sonard", "run", CONFIG], "sonard")
    others = []
    try:
        daemon.wait_for_line("sonard ready", 60)
        cast = [f"{programs}/posecast", TRAJECTORY, "--to", "127.0.0.1:14600", "--loop"]
        others.append(Program(cast, "posecast"))
        others += [Program([sys.executable, "-c", "while True: pass"], "busy") for _ in range(busy)]
        before, began = cpu_s(daemon.pid), time.monotonic()
        view = [f"{programs}/sonarview", "--continuous", str(INTERVAL_MS), "--range", "20", "--compression", "1",
                "--quiet", "--seconds", str(seconds)]
        summary = subprocess.run(view, stdout=subprocess.PIPE, text=True, check=True).stdout
        elapsed = time.monotonic() - began
        used = (cpu_s(daemon.pid) - before) / elapsed
    finally:
        for program in [*others, daemon]:
            program.kill()
    return float(re.search(r"rate_hz=([0-9.]+)", summary)[1]), used


def render(programs, more):
    """(frames per second without the start, CPU seconds per frame)"""
    with tempfile.TemporaryDirectory() as folder:
        def timed(rate):
            out = os.path.join(folder, f"frames_{rate}")
            command = [f"{programs}/sonard", "render", CONFIG, "--trajectory", TRAJECTORY, "--range", "20",
                       "--compression", "1", "--rate", str(rate), "--out", out, *more]
            before, began = os.times(), time.monotonic()
            subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
            after = os.times()
            used = after.children_user + after.children_system - before.children_user - before.children_system
            frames = sum(name.endswith(".npy") for name in os.listdir(out))
            return frames, time.monotonic() - began, used
        few, many = timed(FRAMES_PER_S / 20), timed(FRAMES_PER_S)
        frames, seconds, used = (b - a for a, b in zip(few, many))
        return frames / seconds, used / frames


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("programs", help="folder of sonard, posecast and sonarview")
    parser.add_argument("--seconds", type=int, default=12, help="of each round of serving [12]")
    args = parser.parse_args()
    print(f"the demo served, a client asks for {1000 / INTERVAL_MS:.1f} pings a second, {CORES} cores")
    print("busy processes   pings/s   CPU s/s   CPU pings/s   fair")
    alone = None
    for busy in (0, 1, 2, 4):
        rate, used = serve(args.programs, args.seconds, busy)
        alone = alone or rate
        fair = CORES * min(1, 2 / (2 + busy))
        print(f"{busy:14}   {rate:7.1f}   {used:7.2f}   {rate / used:11.1f}   {100 * used / fair:3.0f} %", flush=True)
    print("the same rendered into files\npictures         frames/s  per core  CPU s/frame  / served")
    for what, more in (("every frame", []), ("every 10th", ["--picture-every", "10"]), ("none", ["--picture-every", "0"])):
        rate, used = render(args.programs, more)
        print(f"{what:14}   {rate:7.1f}   {rate / CORES:7.2f}   {used:11.3f}   {rate / alone:6.2f}", flush=True)


if __name__ == "__main__":
    main()
