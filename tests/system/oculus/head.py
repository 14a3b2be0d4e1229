# SPDX-License-Identifier: Apache-2.0
"""A daemon with heads of type oculus on a machine of its own (a network namespace), and its clients."""

import argparse
import os
import re
import select
import socket
import sys
import tempfile
import unittest
import uuid

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [os.path.join(HERE, "..", "gemini"), os.path.join(SOURCE, "tests", "support")]
import messages  # noqa: E402
from example_messages import example  # noqa: E402
from lab import Deadline, Namespace, Program, need  # noqa: E402

DEMO = os.path.join(SOURCE, "configs", "demo-oculus.yaml")
WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
START_S = 60
PATIENCE_S = 30  # for what has no time of its own
STATUS_PORT = 52102
TOO_SLOW = r"\d+ messages were dropped: the client reads too slowly"

CONFIG = """
engine: cpu
world: {{file: {world}}}
water: {{temperature_c: 18, salinity_ppt: 35, depth_m: 10}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
{more}
heads:
{heads}
"""


def tcp_client(machine, address, port=52100, receive_buffer=None):
    """A connected socket; it stays in the namespace in which it was made."""
    made = machine.tcp_socket()
    if receive_buffer:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
    made.settimeout(PATIENCE_S)
    made.connect((address, port))
    return made


class Client:
    """One connection. Messages come one by one."""

    def __init__(self, connection):
        self.connection = connection
        self._stream = messages.Stream()
        self._messages = []

    def write(self, data):
        self.connection.sendall(data)

    def next(self, seconds=PATIENCE_S):
        """The next message; None after the time-out, or if the head has closed the connection."""
        deadline = Deadline(seconds)
        while not self._messages:
            if not select.select([self.connection], [], [], deadline.left())[0]:
                return None
            try:
                data = self.connection.recv(1 << 20)
            except ConnectionResetError:
                data = b""
            if not data:
                return None
            self._messages += self._stream.feed(data)
        return self._messages.pop(0)

    def wait(self, wanted, seconds=PATIENCE_S):
        """The next message of this kind; skips others, as clients do."""
        deadline = Deadline(seconds)
        while (got := self.next(deadline.left())) is not None and got.id != wanted:
            pass
        return got

    def ping(self, seconds=PATIENCE_S):
        got = self.wait(messages.PING, seconds)
        return None if got is None else messages.ping_of(got)

    def all_for(self, seconds):
        deadline = Deadline(seconds)
        got = []
        while not deadline.over():
            got += [one] if (one := self.next(deadline.left())) is not None else []
        return got

    def is_closed(self, seconds=PATIENCE_S):
        """Reads everything that has arrived. True if the head has closed the connection."""
        deadline = Deadline(seconds)
        while select.select([self.connection], [], [], deadline.left())[0]:
            try:
                if not self.connection.recv(1 << 20):
                    return True
            except ConnectionResetError:
                return True
        return False

    def close(self):
        self.connection.close()


class HeadCase(unittest.TestCase):
    """One daemon for all cases of a class, because it starts slower than they run; each case has its own clients."""

    PROGRAMS = None  # folder of the programs under test
    HEADS = ""  # YAML
    MORE = ""  # YAML beside the heads
    ADDRESS = "127.0.0.3"

    @classmethod
    def setUpClass(cls):
        need("ip")
        folder = tempfile.TemporaryDirectory(prefix="sonard-oculus-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.make_machines()
        cls.daemon = cls.start_daemon()

    @classmethod
    def make_machines(cls):
        cls.machine = cls.client_machine = Namespace("sonard-" + uuid.uuid4().hex[:8])
        cls.addClassCleanup(cls.machine.remove)

    @classmethod
    def configuration(cls):
        path = os.path.join(cls.folder, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=WORLD, heads=cls.HEADS, more=cls.MORE))
        return path

    @classmethod
    def start(cls, *arguments, machine=None):
        program = Program((machine or cls.machine).command(*arguments), os.path.basename(arguments[0]))
        cls.addClassCleanup(program.kill)
        return program

    @classmethod
    def start_daemon(cls):
        daemon = cls.start(os.path.join(cls.PROGRAMS, "sonard"), "run", cls.configuration())
        daemon.wait_for_line("sonard ready", START_S)
        return daemon

    def tearDown(self):
        self.assertNotRegex(self.daemon.output(), "Z (error|critical) ")

    def view(self, pings, *options):
        """Receives pings with sonarview. Returns its output. A busy machine may make it miss pings that the daemon counts as
        dropped."""
        told = self.times_too_slow()
        viewer = self.start(os.path.join(self.PROGRAMS, "sonarview"), "oculus", "--pings", str(pings), *options,
                            machine=self.client_machine)
        code = viewer.wait(PATIENCE_S)
        summary = re.search(rf"summary pings={pings} .* pings_missed=(\d+) ", viewer.output())
        self.assertIsNotNone(summary, viewer.tail())
        missed = int(summary[1])
        self.assertEqual(code, 4 if missed else 0, viewer.tail())
        if missed:
            self.daemon.wait_for_line(TOO_SLOW, PATIENCE_S, told + 1)
        return viewer.output()

    def times_too_slow(self):
        return sum(bool(re.search(TOO_SLOW, line)) for line in self.daemon.lines)

    def client(self, address=None, greeted=True, **settings):
        """Waits until the head has noticed that its last client is gone."""
        deadline = Deadline(PATIENCE_S)
        while True:
            client = Client(tcp_client(self.client_machine, address or self.ADDRESS, **settings))
            if not greeted:
                break
            greeting = client.next()
            if greeting is not None:
                self.assertEqual(greeting.id, messages.LOGS)
                break
            client.close()
            self.assertFalse(deadline.over(), "the head takes no client")
        self.addCleanup(client.close)
        return client

    def statuses(self, address="127.0.0.1", **settings):
        made = self.client_machine.udp_socket(address, STATUS_PORT, **settings)
        made.settimeout(PATIENCE_S)
        self.addCleanup(made.close)
        return made


def main():
    """Runs the cases of the calling script."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    arguments, rest = parser.parse_known_args()
    HeadCase.PROGRAMS = os.path.abspath(arguments.programs)
    unittest.main(argv=[sys.argv[0], "-v", *rest])
