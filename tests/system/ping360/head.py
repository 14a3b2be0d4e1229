# SPDX-License-Identifier: Apache-2.0
"""A daemon with heads of type ping360 on a machine of its own (a network namespace), and its clients."""

import os
import select
import sys
import tty

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "tests", "support")]
import head_case  # noqa: E402
import messages  # noqa: E402
from example_messages import example  # noqa: E402
from head_case import PATIENCE_S, main  # noqa: E402
from lab import Deadline  # noqa: E402

DEMO = os.path.join(SOURCE, "configs", "demo-ping360.yaml")
QUIET_S = 0.3  # that long nothing more comes


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


class HeadCase(head_case.HeadCase):
    """Each case leaves the heads at rest."""

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
