# SPDX-License-Identifier: Apache-2.0
"""A daemon with heads of type ping360 on a machine of its own (a network namespace), and its clients."""

import argparse
import os
import select
import sys
import tempfile
import tty
import unittest
import uuid

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [os.path.join(HERE, "..", "gemini"), os.path.join(SOURCE, "tests", "support")]
import messages  # noqa: E402
from example_messages import example  # noqa: E402
from lab import Deadline, Namespace, Program, need  # noqa: E402

DEMO = os.path.join(SOURCE, "configs", "demo-ping360.yaml")
WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
START_S = 60
PATIENCE_S = 30  # for what has no time of its own
QUIET_S = 0.3  # that long nothing more comes

CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
{more}
heads:
{heads}
"""


class Client:
    """The client's end of a link: sends bytes and receives frames one by one."""

    def __init__(self):
        self._parser = messages.Parser()
        self._frames = []

    def write(self, data):
        raise NotImplementedError

    def read(self, seconds):
        """Some received bytes; None after the time-out."""
        raise NotImplementedError

    def next(self, seconds=PATIENCE_S):
        """The next frame of any kind; None after the time-out."""
        deadline = Deadline(seconds)
        while not self._frames:
            piece = self.read(deadline.left())
            if piece is not None:
                self._frames += self._parser.feed(piece)
            elif deadline.over():
                return None
        return self._frames.pop(0)

    def wait(self, *wanted, seconds=PATIENCE_S):
        """The next frame with one of these numbers; skips others, as clients do."""
        deadline = Deadline(seconds)
        while True:
            got = self.next(deadline.left())
            if got is None or got.message in wanted:
                return got

    def ask(self, data, *wanted, seconds=PATIENCE_S):
        self.write(data)
        return self.wait(*wanted, seconds=seconds)

    def all_until_quiet(self, seconds=QUIET_S):
        """All frames until no frame arrives for this time."""
        got = []
        while (one := self.next(seconds)) is not None:
            got.append(one)
        return got

    def all_for(self, seconds):
        deadline = Deadline(seconds)
        got = []
        while not deadline.over():
            got += [one] if (one := self.next(deadline.left())) is not None else []
        return got

    def junk(self):
        return self._parser.junk

    def end(self):
        """Stops its scan, and drops a half-received frame."""
        self._parser = messages.Parser()
        self.ask(messages.MOTOR_OFF_FRAME, messages.ACK, seconds=5)


class UdpClient(Client):
    """`buffer`: bytes of each datagram that it reads."""

    def __init__(self, socket, head, buffer=4096):
        super().__init__()
        self.socket = socket
        self.head = head
        self.buffer = buffer
        self.sizes = []  # of all datagrams

    def write(self, data):
        self.socket.sendto(data, self.head)

    def read(self, seconds):
        if not select.select([self.socket], [], [], seconds)[0]:
            return None
        piece, sender = self.socket.recvfrom(self.buffer)
        if sender != self.head:
            raise AssertionError(f"an answer from {sender}, of {self.head} asked")
        self.sizes.append(len(piece))
        return piece

    def close(self):
        self.socket.close()


class SerialClient(Client):
    """On the slave end of a pseudo terminal."""

    def __init__(self, path):
        super().__init__()
        self._file = os.open(path, os.O_RDWR | os.O_NOCTTY)
        tty.setraw(self._file)

    def write(self, data):
        os.write(self._file, data)

    def read(self, seconds):
        return os.read(self._file, 4096) if select.select([self._file], [], [], seconds)[0] else None

    def close(self):
        os.close(self._file)


class HeadCase(unittest.TestCase):
    """One daemon for all cases of a class, because it starts slower than they run; each case has its own clients and leaves
    the heads at rest."""

    PROGRAMS = None  # folder of the programs under test
    HEADS = ""  # YAML
    MORE = ""  # YAML beside the heads

    @classmethod
    def setUpClass(cls):
        need("ip")
        folder = tempfile.TemporaryDirectory(prefix="sonard-ping360-")
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        cls.make_machines()
        cls.daemon = cls.start_daemon()

    @classmethod
    def make_machines(cls):
        cls.machine = Namespace("sonard-" + uuid.uuid4().hex[:8])
        cls.addClassCleanup(cls.machine.remove)

    @classmethod
    def configuration(cls):
        path = os.path.join(cls.folder, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=WORLD, heads=cls.HEADS.replace("FOLDER", cls.folder),
                                     more=cls.MORE.replace("FOLDER", cls.folder)))
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

    def client(self, port=12345, address="127.0.0.1", machine=None, own="127.0.0.1", **settings):
        socket = (machine or self.machine).udp_socket(own, 0)
        return self.keep(UdpClient(socket, (address, port), **settings))

    def serial_client(self, path):
        return self.keep(SerialClient(path))

    def keep(self, client):
        """Stops and closes the client when the case ends."""
        self.addCleanup(client.close)
        self.addCleanup(client.end)
        return client

    # ---- Checks of frames

    def assert_ack(self, got, message):
        self.assertIsNotNone(got, "no answer")
        self.assertEqual((got.message, got.payload), (messages.ACK, message.to_bytes(2, "little")))

    def assert_nack(self, got, message, text):
        self.assertIsNotNone(got, "no answer")
        self.assertEqual(got.message, messages.NACK)
        self.assertEqual(messages.nack(got), (message, text))

    def assert_ping(self, got, command, angle=None):
        """Checks that it is an answer to `command`. Returns its data."""
        self.assertIsNotNone(got, "no answer")
        if got.message == messages.NACK:
            self.fail(f"refused: {messages.nack(got)}")
        data = messages.data_of(got)
        self.assertTrue(data.echoes(command), f"{data} is no answer to {command}")
        self.assertEqual(data.angle, command.angle if angle is None else angle)
        transmits = getattr(command, "transmit", 1) != 0
        self.assertEqual(len(data.data), command.samples if transmits else 0)
        return data


def main():
    """Runs the cases of the calling script."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True, help="folder with sonard and sonarview")
    arguments, rest = parser.parse_known_args()
    HeadCase.PROGRAMS = os.path.abspath(arguments.programs)
    unittest.main(argv=[sys.argv[0], "-v", *rest])
