# SPDX-License-Identifier: Apache-2.0
"""Two machines on one wire, as network namespaces, and the programs on them.

Every wait has a deadline. When the test ends, all programs are stopped and all namespaces are removed.
"""

import ctypes
import os
import re
import select
import shutil
import signal
import socket
import subprocess
import tempfile
import threading
import time
import unittest

HEAD_ADDRESS = "10.61.19.200"
CLIENT_ADDRESS = "10.61.19.10"
SECOND_HEAD_ADDRESS = "10.61.19.201"
SECOND_CLIENT_ADDRESS = "10.61.19.11"
COMMAND_PORT = 52901
REPORT_PORT = 52900

CLONE_NEWNET = 0x40000000
SO_RCVBUFFORCE = 33
_libc = ctypes.CDLL(None, use_errno=True)


class Deadline:
    """Remaining time."""

    def __init__(self, seconds):
        self._end = time.monotonic() + seconds

    def left(self):
        return max(0.0, self._end - time.monotonic())

    def over(self):
        return self.left() == 0.0


def _ip(*arguments):
    _run("ip", *arguments)


def _run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(
            f"'{' '.join(command)}' failed: {done.stderr.strip()}\n"
            "The system tests need iproute2 and the right to make network namespaces (root, CAP_SYS_ADMIN and "
            "CAP_NET_ADMIN); in a container start it with these capabilities.")


class Namespace:
    """A machine: one network namespace."""

    def __init__(self, name):
        self.name = name
        _ip("netns", "add", name)
        self.ip("link", "set", "lo", "up")

    def ip(self, *arguments):
        _ip("-netns", self.name, *arguments)

    def command(self, *arguments):
        """Command line that runs `arguments` in this namespace, in the started process (ip replaces itself)."""
        return ["ip", "netns", "exec", self.name, *arguments]

    def udp_socket(self, address, port, reuse=False):
        """A socket of this process in this namespace: a socket stays in the namespace in which it was made. With `reuse` it
        shares its port with other sockets that set it."""
        def make():
            made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            # Exceeds net.core.rmem_max, because Python reads slower than a head sends.
            made.setsockopt(socket.SOL_SOCKET, SO_RCVBUFFORCE, 16 << 20)
            made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, int(reuse))
            made.bind((address, port))
            return made
        return self._inside(make)

    def tcp_socket(self):
        """A TCP socket in this namespace, not connected."""
        return self._inside(lambda: socket.socket(socket.AF_INET, socket.SOCK_STREAM))

    def _inside(self, make):
        own = os.open("/proc/self/ns/net", os.O_RDONLY)
        there = os.open(f"/run/netns/{self.name}", os.O_RDONLY)
        try:
            _enter(there)
            try:
                return make()
            finally:
                _enter(own)
        finally:
            os.close(there)
            os.close(own)

    def enter(self):
        """From now on, sockets of this thread and programs that it starts are in this namespace."""
        with open(f"/run/netns/{self.name}", "rb") as there:
            _enter(there.fileno())

    def remove(self):
        subprocess.run(["ip", "netns", "del", self.name], capture_output=True)


def _enter(namespace_fd):
    if _libc.setns(namespace_fd, CLONE_NEWNET) != 0:
        raise OSError(ctypes.get_errno(), "setns")


class OwnMachine(unittest.TestCase):
    """Tests whose process and programs have a machine (namespace) of their own, with a folder for each test."""

    @classmethod
    def setUpClass(cls):
        cls.namespace = Namespace(f"sonard-{cls.__name__.lower()}-{os.getpid()}")
        cls.namespace.enter()

    @classmethod
    def tearDownClass(cls):
        cls.namespace.remove()

    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)


class Lab:
    """A head machine and one or two client machines on one Ethernet. `with Lab() as lab: ...`"""

    _count = 0

    def __init__(self, clients=1):
        Lab._count += 1
        self._prefix = f"sonard-{os.getpid()}-{Lab._count}"
        self._namespaces = []
        self._programs = []
        self._wanted_clients = clients

    def __enter__(self):
        try:
            self._build()
        except BaseException:
            self._remove()
            raise
        return self

    def __exit__(self, *_):
        self._remove()

    def _add(self, role):
        namespace = Namespace(f"{self._prefix}-{role}")
        self._namespaces.append(namespace)
        return namespace

    def _build(self):
        self.head = self._add("head")
        self.clients = [self._add(f"client{i}") for i in range(self._wanted_clients)]
        self.client = self.clients[0]
        # One wire; with two clients a switch (a bridge, which is then the interface of the head machine).
        switched = self._wanted_clients > 1
        if switched:
            self.head.ip("link", "add", "eth0", "type", "bridge")
        for i, client in enumerate(self.clients):
            head_end = f"port{i}" if switched else "eth0"
            self.head.ip("link", "add", head_end, "type", "veth", "peer", "name", "eth0", "netns", client.name)
            if switched:
                self.head.ip("link", "set", head_end, "master", "eth0")
                self.head.ip("link", "set", head_end, "up")
            address = [CLIENT_ADDRESS, SECOND_CLIENT_ADDRESS][i]
            client.ip("address", "add", f"{address}/24", "brd", "+", "dev", "eth0")
            client.ip("link", "set", "eth0", "up")
        for address in (HEAD_ADDRESS, SECOND_HEAD_ADDRESS):
            self.head.ip("address", "add", f"{address}/24", "brd", "+", "dev", "eth0")
        self.head.ip("link", "set", "eth0", "up")

    def start(self, namespace, *arguments):
        program = Program(namespace.command(*arguments), os.path.basename(arguments[0]))
        self._programs.append(program)
        return program

    def tails(self):
        """The last output of every program, for messages of failed tests."""
        return "\n".join(program.tail() for program in self._programs)

    def tc(self, namespace, *arguments):
        """Shapes the traffic that leaves through an interface."""
        _run("tc", "-netns", namespace.name, *arguments)

    def _remove(self):
        for program in self._programs:
            program.kill()
        for namespace in self._namespaces:
            namespace.remove()


class Program:
    """A process whose output is collected line by line."""

    def __init__(self, command, name):
        self.name = name
        self.lines = []
        self._news = threading.Condition()  # its lock may be taken twice by one thread
        self._ended = False
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                         errors="replace")
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    @property
    def pid(self):
        return self._process.pid

    def _read(self):
        for line in self._process.stdout:
            with self._news:
                self.lines.append(line.rstrip("\n"))
                self._news.notify_all()
        with self._news:
            self._ended = True
            self._news.notify_all()

    def output(self):
        with self._news:
            return "\n".join(self.lines)

    def tail(self, count=40):
        """The last lines of output, for messages of failed tests."""
        with self._news:
            return f"{self.name} ends with:\n" + "\n".join(self.lines[-count:])

    def wait_for_line(self, pattern, seconds, count=1):
        """Waits for the `count`-th line that matches the pattern."""
        deadline = Deadline(seconds)
        with self._news:
            while True:
                found = [line for line in self.lines if re.search(pattern, line)]
                if len(found) >= count:
                    return found[count - 1]
                if self._ended or deadline.over():
                    why = "ended" if self._ended else f"was silent for {seconds} s"
                    raise AssertionError(f"{self.name} {why} before line {count} of '{pattern}'; {self.tail()}")
                self._news.wait(deadline.left())

    def running(self):
        return self._process.poll() is None

    def wait(self, seconds):
        """The exit code."""
        try:
            code = self._process.wait(seconds)
        except subprocess.TimeoutExpired:
            raise AssertionError(f"{self.name} has not ended within {seconds} s; {self.tail()}")
        self._reader.join(5)
        return code

    def signal(self, number):
        self._process.send_signal(number)

    def terminate(self, seconds):
        """Sends SIGTERM. Returns exit code and time taken."""
        start = time.monotonic()
        self.signal(signal.SIGTERM)
        return self.wait(seconds), time.monotonic() - start

    def kill(self):
        if self._process.poll() is None:
            self._process.kill()
            self._process.wait(10)
        self._reader.join(5)
        self._process.stdout.close()


def receive(sock, seconds):
    """(bytes, sender); None after the time-out."""
    ready, _, _ = select.select([sock], [], [], seconds)
    return sock.recvfrom(2048) if ready else None


def need(tool):
    if shutil.which(tool) is None:
        raise RuntimeError(f"{tool} is not installed; docker/packages.txt lists what the tests need")
