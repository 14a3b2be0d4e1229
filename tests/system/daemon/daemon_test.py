#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon as a process: its log, signals, descriptors, and its answers to clients of a Micron right after the start.

    daemon_test.py --programs DIR [TestCase.test_name ...]

Frames of the Micron are in tests/data/micron, with their sources.
"""

import argparse
import contextlib
import fcntl
import os
import re
import resource
import select
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path += [os.path.join(HERE, "..", "gemini"), os.path.join(HERE, "..", "..", "support")]
import wire
from example_messages import example
from lab import Deadline, Program

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
PROGRAMS = None  # folder of the programs under test
START_S = 60
PATIENCE_S = 30

CONFIG = """
log: {{level: {level}}}
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}{poses}}}
{more}
heads:
  - name: stern
    type: micron
    serial: {{tcp: [{{bind: 127.0.0.1:{port}}}]}}
    timing: {{line_period_ms: 5}}
{heads}"""

GEMINI = """
  - name: bow
    type: gemini_720i
    sonar_id: 513
    network:
      alternate_address: {head}
      netmask: 255.0.0.0
      client_port: {client_port}
      status: [127.0.0.1]
"""

ALIVE, HEAD_DATA = 4, 2
# Tests run in parallel, so each process uses its own addresses.
HEAD, SECOND_HEAD = (f"127.{1 + os.getpid() % 250}.{os.getpid() // 250 % 250}.{last}" for last in (2, 3))


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def frame(name):
    return example("micron", name)


class Client:
    """A blocking driver of a Micron: one frame at a time, with a time-out."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S)
        self._bytes = b""

    def write(self, data):
        self.socket.sendall(data)

    def read(self, seconds):
        """The next whole frame; None after the time-out."""
        deadline = Deadline(seconds)
        while True:
            if len(self._bytes) >= 7:
                size = int(self._bytes[1:5], 16) + 6
                if len(self._bytes) >= size:
                    whole, self._bytes = self._bytes[:size], self._bytes[size:]
                    return whole
            if not select.select([self.socket], [], [], deadline.left())[0]:
                return None
            self._bytes += self.socket.recv(4096)

    def read_until(self, message, seconds):
        deadline = Deadline(seconds)
        while not deadline.over():
            got = self.read(deadline.left())
            if got is not None and got[10] == message:
                return got
        return None

    def close(self):
        self.socket.close()


class DaemonCase(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.port = free_port()
        self.processes = []

    def tearDown(self):
        for process in self.processes:
            process.kill()
        self.folder.cleanup()

    def client(self):
        client = Client(self.port)
        self.addCleanup(client.close)
        return client

    def configuration(self, level="info", poses="", more="", heads=""):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(level=level, world=WORLD, poses=poses, more=more, heads=heads, port=self.port))
        return [os.path.join(PROGRAMS, "sonard"), "run", path]

    def start(self, **settings):
        daemon = Program(self.configuration(**settings), "sonard")
        self.processes.append(daemon)
        daemon.wait_for_line("sonard ready", START_S)
        return daemon

    def start_bare(self, command, **popen):
        """Starts a daemon without reading its standard error; returns when it accepts connections."""
        process = subprocess.Popen(command, **popen)
        self.processes.append(process)
        deadline = Deadline(START_S)
        while not deadline.over():
            self.assertIsNone(process.poll(), "the daemon has ended")
            try:
                return process, self.client()
            except ConnectionRefusedError:
                time.sleep(0.05)
        self.fail("the daemon takes no connections")

    def configured(self, client):
        client.write(frame("head_command_ros"))
        self.assertIsNotNone(client.read_until(ALIVE, PATIENCE_S))

    def lines(self, client, count, seconds=PATIENCE_S):
        for i in range(count):
            client.write(frame("send_data"))
            self.assertIsNotNone(client.read_until(HEAD_DATA, seconds), f"line {i}")


class LogReader(DaemonCase):
    def test_one_that_stops_reading_costs_no_line_and_sigterm_ends_it_within_a_second(self):
        reader, writer = os.pipe()
        try:
            # Debug: one line per scan line, so that the pipe is soon full.
            daemon, client = self.start_bare(self.configuration(level="debug"), stderr=writer)
            os.close(writer)
            writer = -1
            self.configured(client)
            room = 65536 // 150  # a pipe of 64 KiB, lines of 150 bytes and more
            self.lines(client, 2 * room)
            os.set_blocking(reader, False)
            begin = time.monotonic()
            daemon.send_signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(PATIENCE_S), 0)
            took = time.monotonic() - begin
            self.assertLess(took, 1.0)
            self.assertGreater(len(os.read(reader, 1 << 20)), 32768, "the pipe was not full: nothing was tried")
        finally:
            os.close(reader)
            if writer >= 0:
                os.close(writer)

    def test_clients_that_come_and_go_do_not_fill_the_log(self):
        daemon = self.start()
        for _ in range(500):
            Client(self.port).close()
        client = self.client()
        self.configured(client)
        self.lines(client, 3)
        said = [line for line in daemon.output().splitlines() if "connected" in line]
        self.assertGreaterEqual(len(said), 10)
        self.assertLess(len(said), 60)
        time.sleep(3)  # two seconds bring the next line, which says what is missing
        Client(self.port).close()
        daemon.wait_for_line(r"earlier lines were dropped", PATIENCE_S)


class Signals(DaemonCase):
    def test_a_log_reader_that_leaves_while_it_starts_ends_nothing(self):
        reader, writer = os.pipe()
        os.close(reader)
        daemon, client = self.start_bare(self.configuration(level="debug"), stderr=writer)
        os.close(writer)
        self.configured(client)
        self.lines(client, 5)
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(PATIENCE_S), 0)

    def test_sigpipe_ends_nothing(self):
        daemon = self.start()
        client = self.client()
        self.configured(client)
        for _ in range(2):
            daemon.signal(signal.SIGPIPE)
            self.lines(client, 3)
        code, _ = daemon.terminate(PATIENCE_S)
        self.assertEqual(code, 0)

    def test_sighup_with_a_bad_configuration_changes_nothing(self):
        daemon = self.start()
        client = self.client()
        self.configured(client)
        with open(os.path.join(self.folder.name, "sonard.yaml"), "a", encoding="utf-8") as file:
            file.write("colour: green\n")
        daemon.signal(signal.SIGHUP)
        daemon.wait_for_line("sonard.yaml:\\d+:\\d+: colour", PATIENCE_S)
        daemon.wait_for_line("configuration invalid, keeping the current one", PATIENCE_S)
        self.lines(client, 3)
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)

    def test_signals_that_mean_nothing_change_nothing(self):
        daemon = self.start()
        for number in (signal.SIGUSR1, signal.SIGUSR2, signal.SIGPIPE):
            daemon.signal(number)
        time.sleep(0.5)
        client = self.client()
        self.assertIsNotNone(client.read_until(ALIVE, PATIENCE_S), daemon.tail())

    def test_sighup_begins_anew_with_a_good_configuration(self):
        daemon = self.start()
        client = self.client()
        self.configured(client)
        before, self.port = self.port, free_port()
        self.configuration()
        daemon.signal(signal.SIGHUP)
        daemon.wait_for_line("configuration valid, restarting", PATIENCE_S)
        daemon.wait_for_line("sonard ready", START_S, count=2)
        self.configured(self.client())
        with self.assertRaises(ConnectionRefusedError):
            socket.create_connection(("127.0.0.1", before))
        code, _ = daemon.terminate(PATIENCE_S)
        self.assertEqual(code, 0)

    def served_port(self, *ports):
        """The one of these ports on which the daemon accepts a connection within PATIENCE_S."""
        deadline = Deadline(PATIENCE_S)
        while not deadline.over():
            for port in ports:
                with contextlib.suppress(ConnectionRefusedError):
                    socket.create_connection(("127.0.0.1", port)).close()
                    return port
            time.sleep(0.02)
        self.fail(f"none of {ports} is served")

    def refused(self, daemon, why):
        """SIGHUP does not change the daemon, and one line gives the reason."""
        daemon.signal(signal.SIGHUP)
        daemon.wait_for_line(f"configuration invalid, keeping the current one: .*{why}", PATIENCE_S)
        self.configured(self.client())

    def test_sighup_with_a_taken_port_changes_nothing(self):
        daemon, before = self.start(), self.port
        with socket.socket() as other:
            other.bind(("127.0.0.1", 0))
            other.listen()
            self.port = other.getsockname()[1]
            self.configuration()
            self.port = before
            self.refused(daemon, "in use by another program")
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)

    def test_sighup_with_the_recording_folder_of_another_daemon_changes_nothing(self):
        daemon = self.start()
        directory = os.path.join(self.folder.name, "logs")
        os.mkdir(directory)
        holder = os.open(directory, os.O_RDONLY)
        self.addCleanup(os.close, holder)
        fcntl.flock(holder, fcntl.LOCK_EX)
        self.configuration(more=f"recording: {{directory: {directory}}}")
        self.refused(daemon, "another daemon records into")
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)

    def test_sighup_serves_the_bytes_that_were_checked(self):
        """The file becomes invalid at each of 50 times after SIGHUP, as if an editor wrote it in two steps."""
        daemon, ports = self.start(), (self.port, free_port())
        path = os.path.join(self.folder.name, "sonard.yaml")
        for moment in range(50):
            self.port = ports[moment % 2]
            self.configuration()
            daemon.signal(signal.SIGHUP)
            time.sleep(0.02 * moment)
            with open(path, encoding="utf-8") as file:
                text = file.read()
            with open(path, "w", encoding="utf-8") as file:
                file.flush()  # empty for a moment
                file.write(text[:len(text) // 2])
            self.served_port(*ports)
            self.assertTrue(daemon.running(), daemon.tail())
        daemon.wait_for_line("SIGHUP: reading the configuration again", 1)
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0, daemon.tail())

    def test_a_configuration_that_cannot_be_served_after_all_gives_way_to_the_one_before(self):
        """The check makes no pseudo terminal, so only the start finds the file in the place of its link."""
        daemon = self.start()
        link = os.path.join(self.folder.name, "link")
        with open(link, "w", encoding="utf-8"):
            pass
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, encoding="utf-8") as file:
            text = file.read()
        with open(path, "w", encoding="utf-8") as file:
            file.write(text.replace("serial: {", f"serial: {{pty: [{{link: {link}}}], "))
        daemon.signal(signal.SIGHUP)
        daemon.wait_for_line("returning to the previous one: .*link", PATIENCE_S)
        daemon.wait_for_line("sonard ready", START_S, count=2)
        self.configured(self.client())
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)

    @staticmethod
    def children(program):
        found = []
        for process in filter(str.isdigit, os.listdir("/proc")):
            with contextlib.suppress(OSError), open(f"/proc/{process}/stat", encoding="ascii") as file:
                if int(file.read().rsplit(")", 1)[1].split()[1]) == program.pid:
                    found.append(int(process))
        return found

    @staticmethod
    def is_a_check(process):
        """False for a fork of the daemon that has not yet started the check: the daemon waits for it."""
        with contextlib.suppress(OSError), open(f"/proc/{process}/cmdline", "rb") as file:
            return b"check" in file.read().split(b"\0")
        return False

    def test_sigterm_ends_a_check_that_hangs(self):
        """The checking process is stopped (SIGSTOP), as if it waited for a file server."""
        daemon = self.start()
        daemon.signal(signal.SIGHUP)
        deadline = Deadline(PATIENCE_S)
        checks = []
        while not checks and not deadline.over():
            checks = [process for process in self.children(daemon) if self.is_a_check(process)]
        os.kill(checks[0], signal.SIGSTOP)
        code, took = daemon.terminate(PATIENCE_S)
        self.assertEqual(code, 0)
        self.assertLess(took, 5.0)

    def test_the_service_manager_is_told(self):
        """The daemon notifies the service manager with the protocol of sd_notify(3)."""
        manager = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.addCleanup(manager.close)
        manager.settimeout(START_S)
        manager.bind(os.path.join(self.folder.name, "notify"))
        with unittest.mock.patch.dict(os.environ, NOTIFY_SOCKET=manager.getsockname()):
            daemon = self.start()
            self.assertEqual(manager.recv(100), b"READY=1")
            daemon.signal(signal.SIGHUP)
            self.assertEqual([manager.recv(100), manager.recv(100)], [b"RELOADING=1", b"READY=1"])
            daemon.signal(signal.SIGTERM)
            self.assertEqual(manager.recv(100), b"STOPPING=1")
            self.assertEqual(daemon.wait(PATIENCE_S), 0)

    def test_a_second_sigterm_is_the_first_one(self):
        """`timeout` sends two: to its child, and to the process group."""
        directory = os.path.join(self.folder.name, "logs")
        os.mkdir(directory)
        gemini_client = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.addCleanup(gemini_client.close)
        gemini_client.bind(("127.0.0.1", 0))
        daemon = self.start(more=f"recording: {{directory: {directory}}}",
                            heads=GEMINI.format(head=HEAD, client_port=gemini_client.getsockname()[1]))
        client = self.client()
        self.configured(client)
        self.lines(client, 20)
        self.ping_gemini(gemini_client)
        daemon.signal(signal.SIGTERM)
        for _ in range(20):
            time.sleep(0.001)
            try:
                daemon.signal(signal.SIGTERM)
            except ProcessLookupError:
                break
        self.assertEqual(daemon.wait(PATIENCE_S), 0, daemon.tail())
        daemon.wait_for_line("recording: packed", 1)
        names = os.listdir(directory)
        self.assertTrue(any(name.endswith(".glf") for name in names), names)
        self.assertFalse(any(name.endswith(".dat") for name in names), f"left unpacked: {names}")

    def ping_gemini(self, client):
        """One ping, so that there is a log to pack."""
        config = bytearray(example("gemini", "ping_config"))
        config[2:4] = (513).to_bytes(2, "little")
        deadline = Deadline(PATIENCE_S)
        client.settimeout(1.0)
        while not deadline.over():
            try:
                got = client.recv(2048)
            except TimeoutError:
                continue
            if got[0] == 0x40:
                client.sendto(bytes(config), (HEAD, 52901))
            if got[0] == 0x43:
                return
        self.fail("no ping of the Gemini")


class Descriptors(DaemonCase):
    def test_closed_ones_are_opened_on_dev_null(self):
        def close_all():
            for number in (0, 1, 2):
                os.close(number)

        daemon, client = self.start_bare(self.configuration(), preexec_fn=close_all)
        for number in (0, 1, 2):
            self.assertEqual(os.readlink(f"/proc/{daemon.pid}/fd/{number}"), "/dev/null")
        self.configured(client)
        self.lines(client, 5)
        daemon.send_signal(signal.SIGTERM)
        self.assertEqual(daemon.wait(PATIENCE_S), 0)


class Defect(DaemonCase):
    def test_a_refusal_that_no_code_foresees(self):
        """The kernel refuses epoll, as the profile of a sandbox may: no error of sonard covers this."""
        refusing = ["strace", "-f", "-qq", "-o", os.devnull, "-e", "inject=epoll_create1:error=EPERM"]
        done = subprocess.run([*refusing, *self.configuration()], capture_output=True, text=True, timeout=START_S, check=False)
        if "ptrace" in done.stderr.lower() and done.returncode == 1:  # forbidden, or by LeakSanitizer
            self.skipTest("processes cannot be traced here")
        self.assertEqual(done.returncode, 70, done.stderr)
        self.assertRegex(done.stderr, "(?m)^defect: epoll: Operation not permitted$")


class Exhaustion(DaemonCase):
    """If descriptors, threads or memory run out at the start, the daemon prints the reason; otherwise it serves."""

    def outcome(self, command, sentence, **popen):
        """'ready', or 'out' if it has ended with the sentence."""
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, **popen)
        self.processes.append(process)
        self.addCleanup(process.stdout.close)
        output = ""
        for line in process.stdout:
            output += line
            if "sonard ready" in line:
                process.kill()
                process.wait(PATIENCE_S)
                return "ready"
        self.assertEqual(process.wait(PATIENCE_S), 71, output)
        self.assertRegex(output, sentence)
        self.assertNotIn("defect", output)
        return "out"

    def outcomes(self, command, name, limits, sentence, **popen):
        found = [self.outcome(command, sentence, preexec_fn=lambda n=n: resource.setrlimit(name, (n, n)), **popen)
                 for n in limits]
        self.assertIn("out", found, "no limit was low enough for this test to mean something")
        self.assertIn("ready", found, "no limit was high enough")

    def test_of_descriptors(self):
        self.outcomes(self.configuration(heads=GEMINI.format(head=HEAD, client_port=free_port())), resource.RLIMIT_NOFILE,
                      (*range(6, 20), 64), "(?m)^out of file descriptors .*ulimit -n")

    def as_nobody(self, engine="cpu"):
        """Command line, environment and ID of a user without processes."""
        # Copies in a folder that this user can read.
        program = shutil.copy(os.path.join(PROGRAMS, "sonard"), self.folder.name)
        shutil.copy(WORLD, self.folder.name)
        os.chmod(self.folder.name, 0o755)
        _, run, config = self.configuration()
        with open(config, encoding="utf-8") as file:
            text = file.read().replace(WORLD, os.path.basename(WORLD)).replace("engine: cpu", f"engine: {engine}")
        with open(config, "w", encoding="utf-8") as file:
            file.write(text)
        return [program, run, config], {**os.environ, "HOME": self.folder.name}, 1_700_000_000 + os.getpid()

    def test_of_threads(self):
        if os.geteuid() != 0:
            raise RuntimeError("needs root, to start the program as a user that has no processes")
        command, environment, nobody = self.as_nobody()
        self.outcomes(command, resource.RLIMIT_NPROC, (*range(2, 9), 64), "(?m)^out of threads .*ulimit -u",
                      user=nobody, group=nobody, extra_groups=[], env=environment)

    def test_of_threads_of_opengl(self):
        """Mesa waits for ever for threads that it could not start."""
        if os.geteuid() != 0:
            raise RuntimeError("needs root, to start the program as a user that has no processes")
        command, environment, nobody = self.as_nobody(engine="gpu")
        for limit in (3, 4, 5):
            done = subprocess.run(command, capture_output=True, text=True, timeout=2 * START_S, check=False, user=nobody,
                                  group=nobody, extra_groups=[], env=environment,
                                  preexec_fn=lambda n=limit: resource.setrlimit(resource.RLIMIT_NPROC, (n, n)))
            self.assertEqual(done.returncode, 71, done.stderr)
            self.assertRegex(done.stderr, "(?m)^out of threads .*ulimit -u")

    def test_of_memory(self):
        command = self.configuration()
        limits = [n << 20 for n in (*range(50, 600, 25), 8000)]
        # Below the first of these limits the loader has no room for the libraries, and the program prints nothing.
        starts = [n for n in limits if subprocess.run(
            [command[0], "--version"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False,
            preexec_fn=lambda n=n: resource.setrlimit(resource.RLIMIT_AS, (n, n))).returncode == 0]
        self.outcomes(command, resource.RLIMIT_AS, starts, "(?m)^out of (memory|threads) .*ulimit -v")

    def pings_of_two_heads(self, limit_bytes):
        """The heads that sent pings when one was set to 100 m and the other to 2 m, and the log. None: the daemon never got
        ready."""
        client_port = free_port()
        second = GEMINI.replace("bow", "second").replace("513", "514").replace("{head}", SECOND_HEAD)
        command = self.configuration(heads=(GEMINI + second).format(head=HEAD, client_port=client_port))
        log = os.path.join(self.folder.name, "log")
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client, open(log, "w+", encoding="utf-8") as output:
            client.bind(("127.0.0.1", client_port))
            client.settimeout(0.1)
            daemon = subprocess.Popen(command, stderr=output,
                                      preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit_bytes,) * 2))
            self.processes.append(daemon)
            deadline = Deadline(START_S)
            said = ""
            while "sonard ready" not in said:
                time.sleep(0.05)
                if daemon.poll() is not None or deadline.over():
                    return None
                output.seek(0)
                said = output.read()
            heads = set()
            for lines, sonar_id, address in ((12060, 513, HEAD), (241, 514, SECOND_HEAD)):
                client.sendto(wire.ping_config(sonar_id, lines=lines, continuous_ms=100), (address, 52901))
            deadline = Deadline(PATIENCE_S)
            while not deadline.over() and daemon.poll() is None:
                try:
                    datagram = client.recv(4096)
                except TimeoutError:
                    continue
                if wire.message_type(datagram) == wire.PING_HEAD:
                    heads.add(int.from_bytes(datagram[2:4], "little"))
                output.seek(0)
                said = output.read()
                if 514 in heads and (513 in heads or "out of memory" in said):
                    break
            alive = daemon.poll() is None
            daemon.kill()
            daemon.wait(PATIENCE_S)
            output.seek(0)
            return (heads if alive else set()), output.read()

    def test_memory_that_ends_at_one_head_ends_no_other(self):
        limit = 100 << 20
        while self.pings_of_two_heads(limit) is None:
            limit += 32 << 20
            self.assertLess(limit, 8 << 30, "it is never ready")
        failed = 0
        for more in range(1, 9):  # at the first limit, memory may end as soon as it is ready, for all heads
            outcome = self.pings_of_two_heads(limit + (more * 24 << 20))
            if outcome is None:
                continue
            heads, said = outcome
            self.assertIn(514, heads, said)
            if 513 not in heads:
                failed += 1
                self.assertIn("head=bow: cannot render: out of memory for this ping", said)
        self.assertGreater(failed, 0, "memory was never short enough for this test to mean something")


class Faults(DaemonCase):
    """Faults of the machine (docs/reliability.md)."""

    def ended(self, command):
        """Exit code and output of a daemon that fails at the start."""
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=START_S)
        return done.returncode, done.stdout

    def test_it_writes_no_file_that_it_was_not_told_to(self):
        """Neither in the home folder nor in the working folder, where libraries put their logs."""
        with tempfile.TemporaryDirectory() as home, tempfile.TemporaryDirectory() as here:
            environment = {**os.environ, "HOME": home, "TMPDIR": home, "XDG_CACHE_HOME": "", "XDG_CONFIG_HOME": ""}
            daemon, client = self.start_bare(self.configuration(), env=environment, cwd=here)
            self.configured(client)
            self.lines(client, 3)
            daemon.send_signal(signal.SIGTERM)
            self.assertEqual(daemon.wait(PATIENCE_S), 0)
            self.assertEqual(os.listdir(here), [])
            self.assertEqual(os.listdir(home), [])
            self.assertEqual(os.listdir(self.folder.name), ["sonard.yaml"])

    def test_a_port_that_is_taken_is_named(self):
        with socket.socket() as other:
            other.bind(("127.0.0.1", self.port))
            other.listen()
            code, output = self.ended(self.configuration())
        self.assertEqual(code, 3, output)
        self.assertRegex(output, rf"sonard.yaml:\d+:\d+: heads\[0\].serial: cannot bind TCP 127.0.0.1:{self.port}: Address already")

    def test_the_second_of_two_daemons_with_one_address_ends_and_the_first_goes_on(self):
        head = GEMINI.format(head=HEAD, client_port=free_port())
        first = self.start(heads=head)
        client = self.client()
        self.configured(client)
        self.port = free_port()
        code, output = self.ended(self.configuration(heads=head))
        self.assertEqual(code, 3, output)
        self.assertRegex(output, rf"heads\[1\].network.bind: cannot bind UDP {re.escape(HEAD)}:52901: Address already")
        self.lines(client, 20)
        self.assertEqual(first.terminate(PATIENCE_S)[0], 0)

    def test_stopped_for_ten_seconds_it_goes_on_where_time_is_then(self):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as gemini_client:
            gemini_client.bind(("127.0.0.1", 0))
            gemini_client.settimeout(0.1)
            daemon = self.start(heads=GEMINI.format(head=HEAD, client_port=gemini_client.getsockname()[1]))
            client = self.client()
            self.configured(client)
            gemini_client.sendto(wire.ping_config(513, lines=64, continuous_ms=100), (HEAD, 52901))
            before = self.ping_heads(gemini_client, 5)
            daemon.signal(signal.SIGSTOP)
            time.sleep(10)
            daemon.signal(signal.SIGCONT)
            after = self.ping_heads(gemini_client, 10)[1:]  # but the one that was under way
        times_us = [time_us for _, time_us in after]
        self.assertTrue(all(later - earlier > 90_000 for earlier, later in zip(times_us, times_us[1:])),
                        f"it made up for pings that it had missed: {times_us}")
        numbers = [number for number, _ in after]
        self.assertEqual(numbers, [(numbers[0] + i) % 256 for i in range(len(numbers))])
        self.assertGreater(times_us[0] - before[-1][1], 9_500_000, "the clock of the head stood still")
        self.lines(client, 20)
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)

    def ping_heads(self, client, count):
        """Number and time of each ping, while the client keeps the connection alive."""
        heads, said, deadline = [], Deadline(0), Deadline(PATIENCE_S)
        while len(heads) < count:
            self.assertFalse(deadline.over(), heads)
            if said.over():
                client.sendto(wire.status_request(513), (HEAD, 52901))
                said = Deadline(0.5)
            try:
                datagram = client.recv(4096)
            except TimeoutError:
                continue
            if wire.message_type(datagram) == wire.PING_HEAD:
                heads.append(struct.unpack_from("<HxxQ", datagram, 8))
        return heads


class Leftovers(DaemonCase):
    """Descriptors and threads of clients that have gone must be free again."""

    def held(self, daemon):
        """Numbers of descriptors and threads."""
        return tuple(len(os.listdir(f"/proc/{daemon.pid}/{what}")) for what in ("fd", "task"))

    def held_at_rest(self, daemon):
        """What it holds once that has not changed for a second: it may still close files of its start."""
        deadline, held, since = Deadline(PATIENCE_S), self.held(daemon), time.monotonic()
        while time.monotonic() - since < 1 and not deadline.over():
            time.sleep(0.1)
            if (now := self.held(daemon)) != held:
                held, since = now, time.monotonic()
        return held

    def come_and_go(self, port, visit):
        """A client that requests lines, one that sends half a command, or one that resets the connection."""
        with (contextlib.suppress(ConnectionError),  # one too many is closed at once
              socket.create_connection(("127.0.0.1", port), timeout=PATIENCE_S) as client):
            client.sendall((frame("send_version"), frame("send_data")[:5], b"GET /hea")[visit % 3])
            if visit % 3 == 0:
                client.recv(1)
            elif visit % 3 == 2:
                client.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # a reset

    def wait_to_hold(self, daemon, wanted):
        deadline = Deadline(PATIENCE_S)
        while (held := self.held(daemon)) != wanted and not deadline.over():
            time.sleep(0.1)
        self.assertEqual(held, wanted)

    def test_of_clients_that_come_and_go_no_descriptor_and_no_thread(self):
        poses, page = free_port(), free_port()
        daemon = self.start(poses=f", tcp: {{bind: 127.0.0.1:{poses}}}", more=f"web: {{bind: 127.0.0.1:{page}}}")
        descriptors, threads = self.held_at_rest(daemon)
        with socket.create_connection(("127.0.0.1", self.port)), socket.create_connection(("127.0.0.1", page)):
            self.wait_to_hold(daemon, (descriptors + 2, threads))
        for visit in range(200):
            self.come_and_go(self.port, visit)
            for port in (poses, page):  # they answer no Micron's host
                self.come_and_go(port, 1 + visit % 2)
        self.wait_to_hold(daemon, (descriptors, threads))
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)


class Micron(DaemonCase):
    def test_a_client_of_one_second_is_served_right_after_ready(self):
        """This client waits one second for each answer; the first line must arrive in that time."""
        self.start()
        client = self.client()
        self.assertIsNotNone(client.read_until(ALIVE, 2.0), "the regular one, so that the next is an answer")
        client.write(frame("head_command_uxv"))
        answer = client.read(0.9)
        self.assertIsNotNone(answer)
        self.assertEqual(answer[10], ALIVE)
        self.assertEqual(answer[20] & 0x43, 0x02, "centred, with parameters")
        client.write(frame("send_data"))
        self.assertIsNotNone(client.read_until(HEAD_DATA, 1.0))

    def test_the_log_says_what_a_person_needs(self):
        daemon = self.start()
        client = self.client()
        self.configured(client)
        self.lines(client, 5)
        daemon.wait_for_line(r"head=stern: scanning$", PATIENCE_S)
        daemon.wait_for_line(r"pings range=10\.18m bins=400 .* scan=all_round step=1\.80deg direction=right inverted=no$",
                             PATIENCE_S)
        daemon.wait_for_line(r"head=stern: ready$", PATIENCE_S)

        command = bytearray(frame("head_command_ros"))
        command[14:16] = (0x2301).to_bytes(2, "little")
        command[37:41] = (2400).to_bytes(2, "little") + (4000).to_bytes(2, "little")
        client.write(command)
        self.lines(client, 2)
        daemon.wait_for_line(r"scan=sector from=-45\.00deg to=45\.00deg step=1\.80deg direction=left inverted=no$",
                             PATIENCE_S)
        command[37:41] = (6399).to_bytes(2, "little") * 2
        command[43] = 232
        command[14] |= 0x08
        for _ in range(5):
            client.write(command)
            self.lines(client, 2)
        daemon.wait_for_line(r"gain=80\.0dB .* scan=stares at=179\.94deg inverted=yes$", PATIENCE_S)
        client.write(b"@noise@")
        daemon.wait_for_line(r"head=stern: \d bytes from clients belonged to no command", PATIENCE_S)
        for once in ("equal limits", "gain byte 232", "left and right are swapped"):
            self.assertEqual(daemon.output().count(once), 1, daemon.output())
        self.assertEqual(daemon.terminate(PATIENCE_S)[0], 0)
        self.assertRegex(daemon.output(), r"head=stern: client faults dropped_bytes=\d out_of_range=5 ")

    def test_a_client_that_leaves_is_no_slow_reader(self):
        daemon = self.start()
        for _ in range(5):
            client = self.client()
            self.configured(client)
            for _ in range(2):
                client.write(frame("send_data"))
            self.assertIsNotNone(client.read_until(HEAD_DATA, PATIENCE_S))
            client.close()  # with lines on their way
        time.sleep(11)  # a report comes every ten seconds
        self.assertNotIn("too slowly", daemon.output())
        # A client that stays and does not read causes a warning with the port of its connection.
        slow = self.client()
        slow.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow.write(frame("head_command_ros"))
        asking = self.client()
        self.lines(asking, 500)
        daemon.wait_for_line(rf"tcp 127\.0\.0\.1:{self.port}: \d+ frames were dropped: a client reads too slowly",
                             PATIENCE_S)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True)
    arguments, rest = parser.parse_known_args()
    PROGRAMS = arguments.programs
    unittest.main(argv=[sys.argv[0], *rest])
