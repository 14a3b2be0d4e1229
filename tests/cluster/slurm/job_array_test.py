#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""clients/examples/slurm with Slurm itself: slurmctld, slurmd and munged on loopback, with their own folders and ports.

    job_array_test.py --programs DIR [TestCase.test_name ...]

The expected files are those of one process with the same arguments. Needs Debian's slurm-wlm and munge; neither root nor a
network.
"""

import argparse
import hashlib
import os
import pathlib
import pwd
import re
import signal
import socket
import subprocess
import sys
import time
import unittest

import numpy

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]
sys.path.append(str(REPOSITORY / "tests" / "support"))
import glf_reader  # noqa: E402
from data_set import FRAMES, Files, frames, sums  # noqa: E402

PROGRAMS = None  # folder of the programs under test
RENDER = REPOSITORY / "clients" / "examples" / "slurm" / "render.sh"
PATIENCE_S = 600
CORES = 4  # of the node, whatever this machine has
SLURM_CONF = """
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,bf_interval=1
SlurmdParameters=config_overrides
PreemptType=preempt/partition_prio
PreemptMode=REQUEUE
ReturnToService=2
KillWait=2
NodeName=here NodeAddr=127.0.0.1 NodeHostname={host} CPUs={cores}
PartitionName=usual Nodes=here Default=YES PriorityTier=1
PartitionName=urgent Nodes=here PriorityTier=9 PreemptMode=OFF
"""


def free_ports(count):
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(count)]
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def wait_for(what, holds, seconds=PATIENCE_S):
    """Waits until holds() is true and returns its value."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if value := holds():
            return value
        time.sleep(0.05)
    raise AssertionError(f"{what}: not within {seconds} s")


class Slurm:
    """A cluster of one node."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.daemons = []
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        (self.folder / "munge.key").write_bytes(hashlib.sha512(str(folder).encode()).digest())
        (self.folder / "munge.key").chmod(0o400)
        controller_port, node_port = free_ports(2)
        self.user = pwd.getpwuid(os.getuid()).pw_name
        (self.folder / "slurm.conf").write_text(SLURM_CONF.format(
            folder=folder, controller_port=controller_port, node_port=node_port, user=self.user, cores=CORES,
            host=socket.gethostname()))
        self.environment = os.environ | {"SLURM_CONF": str(self.folder / "slurm.conf"), "SONARD": str(PROGRAMS / "sonard")}

    def begin(self):
        folder = self.folder
        self.start("munged", "--foreground", "--force", f"--socket={folder}/munge.socket", f"--key-file={folder}/munge.key",
                   f"--pid-file={folder}/munged.pid", f"--log-file={folder}/munged.log", f"--seed-file={folder}/munged.seed")
        wait_for("munged", (self.folder / "munge.socket").exists, 30)
        self.start("slurmctld", "-D", "-i")
        self.start("slurmd", "-D", "-N", "here")
        try:
            wait_for("the node", lambda: self.run("sinfo", "-h", "-p", "usual", "-o", "%T", check=False).stdout == "idle\n", 60)
        except AssertionError as error:
            raise AssertionError(f"{error}\n{self.complaints()}") from None

    def start(self, program, *arguments):
        path = f"{os.environ['PATH']}:/usr/sbin"
        with open(self.folder / f"{program}.out", "wb") as output:
            self.daemons.append(subprocess.Popen([program, *arguments], stdout=output, stderr=output, stdin=subprocess.DEVNULL,
                                                 env=self.environment | {"PATH": path}))

    def stop(self):
        self.run("scancel", "--signal=KILL", "--full", "--user", self.user, check=False)
        self.run("scancel", "--user", self.user, check=False)
        wait_for("the end of all jobs", lambda: not self.run("squeue", "--noheader", check=False).stdout, 120)
        for daemon in reversed(self.daemons):
            daemon.terminate()
            daemon.wait(60)

    def run(self, *command, check=True):
        done = subprocess.run([str(part) for part in command], env=self.environment, capture_output=True, text=True, timeout=60)
        if check and done.returncode:
            raise AssertionError(f"{command}: {done.returncode}: {done.stderr}{self.complaints()}")
        return done

    def complaints(self):
        return "".join(file.read_text()[-2000:] for file in sorted(self.folder.glob("*.log")) + sorted(self.folder.glob("*.out")))

    def submit(self, tasks, *arguments, options=()):
        """@return numbers of the array and of the job that writes the log"""
        said = self.run(RENDER, tasks, *options, "--", *arguments).stdout
        print("   ", said.strip().split(";")[0])
        return re.fullmatch(r"array (\d+) of \d+ tasks, then (\d+);.*\n", said).groups()

    def jobs(self, number):
        """Slurm's state of a job; for an array, of each task."""
        lines = self.run("scontrol", "show", "job", number, "--oneliner").stdout.strip().splitlines()
        return [dict(re.findall(r"(\S+?)=(\S*)", line)) for line in lines]

    def end(self, number):
        """Waits until all jobs of the number have ended. @return these jobs"""
        over = ("COMPLETED", "FAILED", "CANCELLED", "TIMEOUT", "NODE_FAIL")
        return wait_for(f"job {number}", lambda: (jobs := self.jobs(number)) and all(job["JobState"] in over for job in jobs) and jobs)

    def processes(self, array, task):
        """{name: pid} of a task's running processes."""
        found = {}
        marks = {f"SLURM_CONF={self.environment['SLURM_CONF']}".encode(), f"SLURM_ARRAY_JOB_ID={array}".encode(),
                 f"SLURM_ARRAY_TASK_ID={task}".encode()}
        for folder in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if marks <= set((folder / "environ").read_bytes().split(b"\0")):
                    found[(folder / "comm").read_text().strip()] = int(folder.name)
            except OSError:
                pass  # it has ended, or belongs to somebody else
        return found


class JobArray(Files):
    def setUp(self):
        super().setUp()
        (self.folder / "slurm").mkdir()
        self.slurm = Slurm(self.folder / "slurm")
        self.addCleanup(self.slurm.stop)
        self.slurm.begin()

    def log_of(self, out, task):
        return (self.folder / f"{out}.tasks" / f"{task}.log").read_text()

    def expect_whole(self, out):
        """Files equal those of one process: all frames once in files and log, and no other files."""
        if not (self.folder / "whole").exists():
            self.render_whole(PROGRAMS)
        self.assertEqual(sums(self.folder / out), sums(self.folder / "whole"))
        [log] = (self.folder / out).glob("*.glf")
        images = glf_reader.read(str(log)).images
        self.assertEqual(len(images), FRAMES)
        for k, image in enumerate(images):
            self.assertEqual(image.pixels, numpy.load(self.folder / out / f"ping_{k:06}.npy").tobytes())

    def test_1_2_and_4_tasks_make_the_bytes_of_one_process(self):
        for tasks in (1, 2, 4):
            with self.subTest(tasks=tasks):
                out = f"of{tasks}"
                array, log = self.slurm.submit(tasks, *self.arguments(out))
                self.assertEqual([job["JobState"] for job in self.slurm.end(log)], ["COMPLETED"])
                done = self.slurm.jobs(array)
                self.assertEqual([job["JobState"] for job in done], ["COMPLETED"] * tasks)
                self.expect_whole(out)
                for task in range(1, tasks + 1):  # none rendered a frame of another
                    self.assertNotIn("are there; ", self.log_of(out, task))
                said = self.slurm.run(RENDER, "progress", self.folder / out).stdout
                self.assertEqual(said.splitlines()[0], f"{FRAMES} of {FRAMES} frames")

    def signal_each(self, number, out, array, tasks, names):
        """Signals the processes with these names of each task ({task: its first frame}), as soon as that frame exists."""
        todo = dict(tasks)

        def reached_all():
            there = frames(self.folder / out)
            for task in [task for task, first in todo.items() if f"ping_{first:06}.json" in there]:
                running = self.slurm.processes(array, task)
                for name in names:
                    os.kill(running[name], number)
                del todo[task]
            return not todo
        wait_for(f"the frames {tasks}", reached_all)

    def start_and_kill(self, out, victims):
        """Starts two tasks, and kills these processes of the second, whose number is the array's, in the middle of its frames."""
        array, log = self.slurm.submit(2, *self.arguments(out))
        self.signal_each(signal.SIGKILL, out, array, {2: 0}, victims)
        before = frames(self.folder / out)
        self.assertLess(len(before), FRAMES, "it was killed too late to show anything")
        print(f"    killed with {len(before)} of {FRAMES} frames there: {' and '.join(victims)}")
        return array, log, before

    def expect_kept(self, out, before):
        after = frames(self.folder / out)
        self.assertEqual({name: after[name] for name in before}, before, "a whole frame was made again")

    def test_a_task_that_is_killed_is_queued_again(self):
        array, log, before = self.start_and_kill("killed", ["sonard"])
        self.assertEqual([job["JobState"] for job in self.slurm.end(log)], ["COMPLETED"])
        done = {job["ArrayTaskId"]: (job["JobState"], job["Restarts"]) for job in self.slurm.jobs(array)}
        self.assertEqual(done, {"1": ("COMPLETED", "0"), "2": ("COMPLETED", "1")})
        self.assertIn("ended by signal 9; queued again", self.log_of("killed", 2))
        self.assertRegex(self.log_of("killed", 2), rf"\d+ of {FRAMES // 2} frames exist; \d+ to render")
        self.expect_kept("killed", before)
        self.expect_whole("killed")

    def test_the_last_job_renders_what_a_lost_task_has_left(self):
        array, log, before = self.start_and_kill("lost", ["slurm_script", "sonard"])
        self.assertEqual([job["JobState"] for job in self.slurm.end(log)], ["COMPLETED"])
        self.assertEqual(sorted(job["JobState"] for job in self.slurm.jobs(array)), ["COMPLETED", "FAILED"])
        self.assertRegex(self.log_of("lost", "log"), rf"\d+ of {FRAMES} frames exist; \d+ to render")
        self.expect_kept("lost", before)
        self.expect_whole("lost")

    def test_a_task_that_is_preempted_goes_on(self):
        array, log = self.slurm.submit(4, *self.arguments("preempted"))
        # SIGSTOP, so that no task ends before it is pre-empted.
        self.signal_each(signal.SIGSTOP, "preempted", array, {1: 1, 2: 2, 3: 3, 4: 0}, ["sonard"])
        urgent = self.slurm.run("sbatch", "--parsable", "--partition=urgent", f"--ntasks={CORES}", "--output=/dev/null",
                                "--wrap=true").stdout.strip()
        self.assertEqual([job["JobState"] for job in self.slurm.end(urgent)], ["COMPLETED"])
        before = frames(self.folder / "preempted")
        self.assertEqual([job["JobState"] for job in self.slurm.end(log)], ["COMPLETED"])
        done = self.slurm.jobs(array)
        self.assertEqual([job["JobState"] for job in done], ["COMPLETED"] * 4)
        self.assertEqual([job["Restarts"] for job in done], ["1"] * 4)
        self.expect_kept("preempted", before)
        self.expect_whole("preempted")

    def test_a_task_whose_time_is_nearly_up_goes_on_in_a_new_one(self):
        array, log = self.slurm.submit(2, *self.arguments("late"))
        self.signal_each(signal.SIGUSR1, "late", array, {2: 0}, ["slurm_script"])  # as Slurm does, by --signal
        self.assertEqual([job["JobState"] for job in self.slurm.end(log)], ["COMPLETED"])
        done = {job["ArrayTaskId"]: (job["JobState"], job["Restarts"]) for job in self.slurm.jobs(array)}
        self.assertEqual(done, {"1": ("COMPLETED", "0"), "2": ("COMPLETED", "1")})
        self.assertIn("its time is up; queued again", self.log_of("late", 2))
        self.assertRegex(self.log_of("late", 2), rf"interrupted: \d+ of {FRAMES // 2} frames exist")
        self.expect_whole("late")

    def test_a_mistake_is_not_tried_again(self):
        array, log = self.slurm.submit(2, *self.arguments("wrong", "--range", "6", "--head", "stern"))
        self.assertEqual([job["JobState"] for job in self.slurm.end(log)], ["FAILED"])
        for job in self.slurm.jobs(array):
            self.assertEqual((job["JobState"], job["Restarts"], job["ExitCode"]), ("FAILED", "0", "2:0"))
        self.assertIn("no head is named 'stern'", self.log_of("wrong", 1))

    def test_wrong_usage_submits_nothing(self):
        for arguments in ([], ["2"], ["2", "--", "config.yaml"], ["0", "--", "config.yaml", "--out", "x"],
                          ["2", "--", "config.yaml", "--out", "x", "--overwrite"]):
            self.assertEqual(self.slurm.run(RENDER, *arguments, check=False).returncode, 64, arguments)


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, type=pathlib.Path, help="folder with sonard")
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    PROGRAMS = arguments.programs.resolve()
    unittest.main(argv=[sys.argv[0], "-v", *arguments.tests], module=__name__)


if __name__ == "__main__":
    main()
