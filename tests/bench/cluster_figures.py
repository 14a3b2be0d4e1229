#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures `sonard render` on one core and two, and estimates the cost of many tasks: the figures of docs/cluster.md.

    cluster_figures.py --programs DIR [--repeat N] [CONFIG TRAJECTORY]

Each process is bound to a core, as on a cluster. Times are minima of several runs, because other load can only add to
them. For wall times, the machine must be idle, or the program must run before all others (chrt -f 1).
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time

REPOSITORY = pathlib.Path(__file__).resolve().parents[2]
TASKS = (1, 2, 4, 16, 64, 256, 1000)
FIRST_FRAME = ("--shard", "0/1000000")
FRAMES = (1_000, 10_000, 100_000)


class Folder:
    """Runs of `sonard render` into one folder, without pictures by default."""

    def __init__(self, options, name, *more):
        more = more or ("--picture-every", "0")
        self.path = options.folder / name
        self.command = [options.programs / "sonard", "render", options.config, "--trajectory", options.trajectory, "--out", self.path,
                        *more]
        shutil.rmtree(self.path, ignore_errors=True)

    def start(self, core, *more):
        def bind():
            os.sched_setaffinity(0, {core})
        return subprocess.Popen([*self.command, *more], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, preexec_fn=bind)

    def end(self, process):
        """@return processor seconds"""
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode:
            raise SystemExit(f"{' '.join(map(str, self.command))} ended with {process.returncode}")
        return used.ru_utime + used.ru_stime

    def run(self, core, *more):
        """@return wall and processor seconds"""
        began = time.monotonic()
        cpu_s = self.end(self.start(core, *more))
        return time.monotonic() - began, cpu_s

    def run_shares(self, cores):
        """Renders one share per core, in parallel. @return wall seconds, and processor seconds of all"""
        began = time.monotonic()
        running = [self.start(core, "--shard", f"{number + 1}/{len(cores)}") for number, core in enumerate(cores)]
        cpu_s = sum(self.end(process) for process in running)
        return time.monotonic() - began, cpu_s

    def files(self, *patterns):
        return [path for pattern in patterns for path in self.path.glob(pattern)]


def size(files):
    return sum(path.stat().st_size for path in files)


def measure_pass(options, core):
    """Time of passing a frame of another share: renders the first frame only, then the last, which passes all others.
    @return seconds per frame"""
    first, last = [], []
    for _ in range(options.repeat):
        run = Folder(options, "pass", "--picture-every", "0", "--rate", "500")
        first.append(run.run(core, *FIRST_FRAME)[1])
        frames = json.loads((run.path / "run.json").read_text(encoding="utf-8"))["frames"]
        last.append(run.run(core, "--shard", f"{frames - 1}/{frames}")[1])
    return (min(last) - min(first)) / (frames - 1)


def measure(options):
    """Seconds for start, render (a frame), pass (a frame of another share), log (a frame), and bytes and rates."""
    one, two = Folder(options, "one"), Folder(options, "two")
    cores = sorted(os.sched_getaffinity(0))[:2]
    wall_of_one, wall_of_two, whole, shares = [], [], [], []
    for _ in range(options.repeat):
        for folder in (one, two):  # the first frame exists then, and the engine is chosen
            shutil.rmtree(folder.path, ignore_errors=True)
            folder.run(cores[0], *FIRST_FRAME)
        wall_s, cpu_s = one.run(cores[0])
        wall_of_one.append(wall_s)
        whole.append(cpu_s)
        wall_s, cpu_s = two.run_shares(cores)
        wall_of_two.append(wall_s)
        shares.append(cpu_s)
    frames = len(one.files("*_*.json"))
    log_bytes = size(one.files("*.glf"))
    nothing, with_log = [], []
    for _ in range(options.repeat):
        nothing.append(one.run(cores[0])[1])
        for log in one.files("*.glf"):
            log.unlink()
        with_log.append(one.run(cores[0])[1])
    pictures = Folder(options, "pictures", "--picture-every", "1")
    pictures.run(cores[0], *FIRST_FRAME)
    pictures_s = pictures.run(cores[0])[1]
    start_s, log_s = min(nothing), min(with_log) - min(nothing)
    return {"frames": frames, "start_s": start_s, "render_s": (min(whole) - start_s - log_s) / (frames - 1),
            "pass_s": measure_pass(options, cores[0]), "log_s": log_s / frames,
            "picture_s": (pictures_s - min(whole)) / (frames - 1),
            "wall_1_s": min(wall_of_one), "wall_2_s": min(wall_of_two),
            "cpu_1_s": min(whole), "cpu_2_s": min(shares),
            "frame_bytes": size(one.files("*_*.json", "*.npy")) / frames, "log_bytes": log_bytes / frames,
            "picture_bytes": size(pictures.files("*.png")) / frames}


def task_s(found, frames, tasks):
    """Time of one of the tasks of a trajectory: it starts, renders its own frames, and passes the others."""
    own = frames / tasks
    return found["start_s"] + own * found["render_s"] + (frames - own) * found["pass_s"]


def report(found, euro_per_core_hour):
    rate = 1 / found["render_s"]
    print(f"{found['frames']} frames; processor seconds: start {found['start_s']:.2f}; a frame: render {found['render_s']:.4f}, "
          f"pass {found['pass_s']:.4f}, log {found['log_s']:.4f}, picture {found['picture_s']:.4f}")
    print(f"frames per second and core: {rate:.2f}; with a picture of each {1 / (found['render_s'] + found['picture_s']):.2f}")
    print(f"frames per euro at {euro_per_core_hour} EUR a core hour: {rate * 3600 / euro_per_core_hour:,.0f}")
    print(f"1 task {found['wall_1_s']:.1f} s, 2 tasks {found['wall_2_s']:.1f} s: "
          f"efficiency {found['wall_1_s'] / 2 / found['wall_2_s']:.0%} by wall time, "
          f"{found['cpu_1_s'] / found['cpu_2_s']:.0%} by processor time, "
          f"{task_s(found, found['frames'], 1) / 2 / task_s(found, found['frames'], 2):.0%} by the model")
    print(f"a frame: {found['frame_bytes'] / 1e6:.3f} MB in 2 files; {found['log_bytes'] / 1e6:.3f} MB of the log; "
          f"picture {found['picture_bytes'] / 1e6:.3f} MB")
    print(f"1,000 tasks write {1000 * rate * found['frame_bytes'] / 1e9:.2f} GB and {2000 * rate:,.0f} files a second")
    print(f"the log of 100,000 frames: {1e5 * found['log_s']:.0f} processor seconds, {1e5 * found['log_bytes'] / 1e9:.0f} GB\n")
    print("efficiency, one trajectory | " + " | ".join(f"{tasks:,} tasks" for tasks in TASKS))
    for frames in FRAMES:
        print(f"{frames:,} frames | " + " | ".join(
            f"{task_s(found, frames, 1) / tasks / task_s(found, frames, tasks):.0%}" if tasks <= frames else "-" for tasks in TASKS))
    print("a trajectory to each task | " + " | ".join(
        f"{frames:,} frames: {frames * found['render_s'] / task_s(found, frames, 1):.1%}" for frames in FRAMES))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, type=pathlib.Path, help="folder with sonard")
    parser.add_argument("--repeat", type=int, default=5, help="least times of so many runs")
    parser.add_argument("--folder", type=pathlib.Path, help="where frames go; default: a temporary one")
    parser.add_argument("--poses", type=int, default=30, help="as many poses of the trajectory, for time's sake")
    parser.add_argument("--euro-per-core-hour", type=float, default=0.0382)
    parser.add_argument("config", nargs="?", default=REPOSITORY / "configs" / "demo.yaml")
    parser.add_argument("trajectory", nargs="?", type=pathlib.Path, default=REPOSITORY / "configs" / "trajectories" / "demo.csv")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        options.folder = pathlib.Path(folder)
        lines = options.trajectory.read_text(encoding="utf-8").splitlines()[:options.poses + 1]
        options.trajectory = options.folder / "trajectory.csv"
        options.trajectory.write_text("\n".join(lines) + "\n", encoding="utf-8")
        report(measure(options), options.euro_per_core_hour)


if __name__ == "__main__":
    main()
