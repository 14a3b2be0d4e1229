# SPDX-License-Identifier: Apache-2.0
"""A daemon with heads of type oculus on a machine of its own (a network namespace), and its clients."""

import os
import re
import select
import socket
import sys

HERE = os.path.dirname(os.path.abspath(__file__))
SOURCE = os.path.abspath(os.path.join(HERE, "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "tests", "support")]
import head_case  # noqa: E402
import messages  # noqa: E402
from example_messages import example  # noqa: E402
from head_case import PATIENCE_S, WORLD, main  # noqa: E402
from lab import Deadline  # noqa: E402

DEMO = os.path.join(SOURCE, "configs", "demo-oculus.yaml")
STATUS_PORT = 52102
TOO_SLOW = r"\d+ messages were dropped: the client reads too slowly"

CONFIG = head_case.CONFIG + "water: {{temperature_c: 18, salinity_ppt: 35, depth_m: 10}}\n"


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


class HeadCase(head_case.HeadCase):
    CONFIG = CONFIG
    ADDRESS = "127.0.0.3"

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
