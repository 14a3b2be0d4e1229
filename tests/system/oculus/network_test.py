#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A head and its client on two machines (network namespaces on one wire): how the client finds the head, and how a slow
wire that loses packets affects pings.

    network_test.py --programs DIR [TwoMachines.test_name ...]
"""

import json
import os
import re
import subprocess

import messages
from head import PATIENCE_S, HeadCase, main
from lab import HEAD_ADDRESS, CLIENT_ADDRESS, Lab
from messages import LOW


class TwoMachines(HeadCase):
    ADDRESS = HEAD_ADDRESS
    HEADS = f"""
  - name: bow
    type: oculus
    network: {{address: {HEAD_ADDRESS}, netmask: 255.255.255.0, allow: [10.61.19.0/24]}}
"""

    @classmethod
    def make_machines(cls):
        cls.lab = Lab()
        cls.lab.__enter__()
        cls.addClassCleanup(cls.lab.__exit__)
        cls.machine = cls.lab.head
        cls.client_machine = cls.lab.client

    def test_the_status_comes_by_broadcast_from_where_the_head_is(self):
        statuses = self.statuses("")
        datagram, sender = statuses.recvfrom(2048)
        status = messages.status_of(datagram)
        self.assertEqual((status.address, status.mask), (HEAD_ADDRESS, "255.255.255.0"))
        self.assertEqual(sender[0], HEAD_ADDRESS)
        self.assertNotEqual(sender[1], 52102)
        self.client()
        while (status := messages.status_of(statuses.recv(2048))).client == "0.0.0.0":
            pass
        self.assertEqual(status.client, CLIENT_ADDRESS)

    def test_sonarview_finds_it_and_misses_only_what_the_head_dropped(self):
        self.view(10)

    def test_over_a_wire_that_loses_every_ping_that_comes_is_whole(self):
        """A bucket of 60 Mbit/s that holds 20 kB drops bursts. TCP sends them again, more slowly than the head pings, so
        some pings are skipped."""
        self.lab.tc(self.machine, "qdisc", "add", "dev", "eth0", "root", "tbf", "rate", "60mbit", "burst", "10kb", "limit",
                    "20kb")
        try:
            client = self.client()
            client.write(messages.fire(mode=LOW, rate=1, flags=0x4B, range_m=20.0, gamma=255))  # 144 Mbit/s
            ids = [client.ping().id for _ in range(12)]
        finally:
            dropped = self.dropped()
            self.lab.tc(self.machine, "qdisc", "del", "dev", "eth0", "root")
        self.assertGreater(dropped, 0, "the wire lost nothing")
        self.assertEqual(ids, sorted(set(ids)))
        self.assertGreater(ids[-1] - ids[0], 11, "pings were left out")
        for _ in range(3):
            self.assertIsNotNone(client.ping(), "and it goes on")

    def dropped(self):
        shown = subprocess.run(["tc", "-netns", self.machine.name, "-s", "-j", "qdisc", "show", "dev", "eth0"],
                               capture_output=True, text=True, check=True)
        return json.loads(shown.stdout)[0]["drops"]

    def test_who_is_not_allowed_is_turned_away(self):
        self.lab.client.ip("address", "add", "10.61.20.9/24", "dev", "eth0")
        self.lab.head.ip("route", "add", "10.61.20.0/24", "dev", "eth0")
        connection = self.client_machine.tcp_socket()
        self.addCleanup(connection.close)
        connection.settimeout(PATIENCE_S)
        connection.bind(("10.61.20.9", 0))
        connection.connect((HEAD_ADDRESS, 52100))
        try:
            self.assertEqual(connection.recv(100), b"")
        except ConnectionResetError:
            pass
        line = self.daemon.wait_for_line(r"10\.61\.20\.9:\d+ refused: not in the allow list", PATIENCE_S)
        self.assertTrue(re.search(r"tcp 10\.61\.19\.200:52100", line))


if __name__ == "__main__":
    main()
