#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A machine whose interface gets its address late, changes it or loses it, and a client at the other end of its wire.

    addresses_test.py --programs DIR [TestCase.test_name ...]
"""

import argparse
import json
import os
import signal
import socket
import subprocess
import sys
import tempfile
import unittest

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", "..", ".."))
sys.path[:0] = [os.path.join(SOURCE, "tests", "system", name) for name in ("gemini", "oculus")]
import messages  # noqa: E402
from lab import Deadline, Namespace, Program, need  # noqa: E402

WORLD = os.path.join(SOURCE, "tests", "data", "system", "sphere_to_port.sdf")
PROGRAMS = None  # folder of the programs under test
START_S = 60
PATIENCE_S = 30
OLD, NEW, FAR = "10.61.19.200", "10.61.19.201", "10.61.19.10"
STATUS_OF_GEMINI, STATUS_OF_OCULUS = 52900, 52102
EXIT_CONFIG, EXIT_NETWORK = 2, 3

CONFIG = """
engine: cpu
world: {{file: {world}}}
poses: {{initial: {{position_m: [0, 0, 0]}}}}
sampling: {{preset: fast}}
web: {{bind: "127.0.0.1:8014"}}
heads:
{heads}
"""
GEMINI = """
  - name: g
    type: gemini_720i
    sonar_id: 513
    network: {{alternate_address: {address}, netmask: {mask}, status: {status}, allow: [10.61.0.0/16]}}
"""
OCULUS = """
  - name: o
    type: oculus
    network: {{address: {address}, netmask: {mask}, allow: [10.61.0.0/16]}}
"""
PING360 = """
  - name: p
    type: ping360
    udp: [{{bind: "{address}:12345", allow: [10.61.19.0/24]}}]
"""
MICRON = """
  - name: m
    type: micron
    serial: {{tcp: [{{bind: "{address}:4001", allow: [10.61.19.0/24]}}]}}
"""


class Machine(unittest.TestCase):
    def setUp(self):
        need("ip")
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        name = f"sonard-addresses-{os.getpid()}"
        self.head, self.far = Namespace(name + "-head"), Namespace(name + "-far")
        for machine in (self.head, self.far):
            self.addCleanup(machine.remove)
        self.head.ip("link", "add", "eth0", "type", "veth", "peer", "name", "eth0", "netns", self.far.name)
        self.far.ip("address", "add", FAR + "/16", "brd", "+", "dev", "eth0")
        for machine in (self.head, self.far):
            machine.ip("link", "set", "eth0", "up")

    def give(self, address, length=24):
        self.head.ip("address", "add", f"{address}/{length}", "brd", "+", "dev", "eth0")

    def take(self, address, length=24):
        self.head.ip("address", "del", f"{address}/{length}", "dev", "eth0")

    def config(self, *heads, address="eth0", mask="eth0", status="limited_broadcast"):
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(CONFIG.format(world=WORLD, heads="".join(head.format(address=address, mask=mask, status=status)
                                                                for head in heads)))
        return path

    def sonard(self, *arguments):
        program = Program(self.head.command(os.path.join(PROGRAMS, "sonard"), *arguments), "sonard")
        self.addCleanup(program.kill)
        return program

    def run_daemon(self, *heads, **config):
        daemon = self.sonard("run", self.config(*heads, **config))
        daemon.wait_for_line("sonard ready", START_S)
        return daemon

    def ended(self, command, *heads, **config):
        """(exit code, output) of a program that ends by itself."""
        program = self.sonard(*command.split(), self.config(*heads, **config))
        return program.wait(START_S), program.output()

    def far_socket(self, port):
        made = self.far.udp_socket("0.0.0.0", port)
        self.addCleanup(made.close)
        made.settimeout(PATIENCE_S)
        return made

    def wait_for_status_from(self, listener, address):
        """The first status packet from this address."""
        deadline = Deadline(PATIENCE_S)
        while not deadline.over():
            datagram, sender = listener.recvfrom(2048)
            if sender[0] == address:
                return datagram
        self.fail(f"no status packet from {address}")

    def findings(self):
        done = subprocess.run(self.head.command(sys.executable, "-c", "import urllib.request as u; "
                                                "print(u.urlopen('http://127.0.0.1:8014/api/status').read().decode())"),
                              capture_output=True, text=True, timeout=PATIENCE_S, check=True)
        return [finding["text"] for head in json.loads(done.stdout)["heads"] for finding in head["findings"]]


class AddressThatComesLate(Machine):
    def test_an_interface_without_an_address_is_said_and_the_service_tries_again(self):
        for head in (GEMINI, OCULUS):
            for command in ("run", "check", "check --json"):
                with self.subTest(head=head, command=command):
                    code, printed = self.ended(command, head)
                    self.assertEqual(code, EXIT_NETWORK, printed)
                    self.assertIn("eth0 has no IPv4 address (yet)", printed)

    def test_one_that_is_down_is_said_to_be(self):
        self.give(OLD)
        self.head.ip("link", "set", "eth0", "down")
        code, printed = self.ended("run", GEMINI)
        self.assertEqual(code, EXIT_NETWORK, printed)
        self.assertIn("eth0 has no IPv4 address (yet): it is down", printed)

    def test_one_that_is_not_plugged_in_is_told_with_those_that_are(self):
        code, printed = self.ended("run", GEMINI, address="usb0", mask="255.255.255.0")
        self.assertEqual(code, EXIT_NETWORK, printed)
        self.assertRegex(printed, r"alternate_address: there is no interface 'usb0' \(yet\); this machine has .*eth0")

    def test_what_is_wrong_with_the_file_goes_before_it(self):
        code, printed = self.ended("run", GEMINI, mask="255.0.255.0")
        self.assertEqual(code, EXIT_CONFIG, printed)

    def test_the_shipped_service_tries_again_after_3_and_not_after_2(self):
        with open(os.path.join(SOURCE, "packaging", "sonard.service"), encoding="utf-8") as file:
            lines = dict(line.strip().split("=", 1) for line in file if "=" in line and not line.startswith("#"))
        self.assertEqual(lines["Restart"], "on-failure")
        self.assertNotIn(str(EXIT_NETWORK), lines["RestartPreventExitStatus"].split())
        self.assertIn(str(EXIT_CONFIG), lines["RestartPreventExitStatus"].split())
        self.assertEqual(lines["StartLimitIntervalSec"], "0", "or systemd gives up after five tries")
        self.assertGreaterEqual(int(lines["RestartSec"]), 1)

    def test_with_the_address_it_starts(self):
        self.give(OLD)
        self.run_daemon(GEMINI)
        self.wait_for_status_from(self.far_socket(STATUS_OF_GEMINI), OLD)


class AddressThatChanges(Machine):
    def setUp(self):
        super().setUp()
        self.give(OLD)

    def test_a_gemini_follows_its_interface(self):
        listener = self.far_socket(STATUS_OF_GEMINI)
        daemon = self.run_daemon(GEMINI)
        first = self.wait_for_status_from(listener, OLD)
        self.assertIn(socket.inet_aton(OLD)[::-1], first)
        self.take(OLD)
        self.give(NEW)
        daemon.wait_for_line(f"head=g: follows eth0: its address is {NEW} now", PATIENCE_S)
        status = self.wait_for_status_from(listener, NEW)
        self.assertIn(socket.inet_aton(NEW)[::-1], status)
        self.take(NEW)
        self.give(OLD)
        daemon.wait_for_line(f"head=g: follows eth0: its address is {OLD} now", PATIENCE_S)
        self.wait_for_status_from(listener, OLD)
        self.assertEqual(self.findings(), [])

    def test_directed_broadcasts_and_the_mask_follow_too(self):
        # The far machine receives the broadcasts of networks in which it has an address.
        self.far.ip("address", "add", OLD.rpartition(".")[0] + ".9/24", "brd", "+", "dev", "eth0")
        listener = self.far_socket(STATUS_OF_GEMINI)
        daemon = self.run_daemon(GEMINI, status="directed_broadcast")
        self.wait_for_status_from(listener, OLD)
        self.take(OLD)
        self.give("10.61.0.7", 16)
        daemon.wait_for_line("head=g: now answers on 10.61.0.7 mask 255.255.0.0", PATIENCE_S)
        status = self.wait_for_status_from(listener, "10.61.0.7")
        self.assertIn(socket.inet_aton("255.255.0.0")[::-1], status)

    def test_an_oculus_follows_its_interface(self):
        listener = self.far_socket(STATUS_OF_OCULUS)
        daemon = self.run_daemon(OCULUS)
        self.assertEqual(messages.status_of(self.wait_for_status_from(listener, OLD)).address, OLD)
        self.take(OLD)
        self.give(NEW)
        daemon.wait_for_line(f"head=o: follows eth0: its address is {NEW} now", PATIENCE_S)
        self.assertEqual(messages.status_of(self.wait_for_status_from(listener, NEW)).address, NEW)
        client = self.far.tcp_socket()
        self.addCleanup(client.close)
        client.settimeout(PATIENCE_S)
        client.connect((NEW, 52100))
        self.assertGreater(len(client.recv(100)), 0, "the greeting of a head")

    def test_a_mask_that_changes_alone_is_followed(self):
        listeners = {GEMINI: self.far_socket(STATUS_OF_GEMINI), OCULUS: self.far_socket(STATUS_OF_OCULUS)}
        daemon = self.run_daemon(GEMINI, OCULUS)
        self.take(OLD)
        self.give(OLD, 16)
        for name in ("g", "o"):
            daemon.wait_for_line(f"head={name}: follows eth0: its netmask is 255.255.0.0 now", PATIENCE_S)
        deadline = Deadline(PATIENCE_S)
        while socket.inet_aton("255.255.0.0")[::-1] not in self.wait_for_status_from(listeners[GEMINI], OLD):
            self.assertFalse(deadline.over())
        self.wait_for_status_from(listeners[OCULUS], OLD)

    def test_a_reload_goes_on_with_the_address_that_was_followed(self):
        for head, name in ((GEMINI, "g"), (OCULUS, "o")):
            with self.subTest(name):
                daemon = self.run_daemon(head)
                self.take(OLD)
                self.give(NEW)
                daemon.wait_for_line(f"head={name}: follows eth0: its address is {NEW} now", PATIENCE_S)
                daemon.signal(signal.SIGHUP)
                daemon.wait_for_line("configuration valid, restarting", PATIENCE_S)
                daemon.wait_for_line("sonard ready", START_S, count=2)
                daemon.kill()
                self.take(NEW)
                self.give(OLD)

    def test_a_second_address_of_the_interface_moves_nothing(self):
        listener = self.far_socket(STATUS_OF_GEMINI)
        daemon = self.run_daemon(GEMINI)
        self.give(NEW)
        for _ in range(3):  # three seconds of status packets
            self.wait_for_status_from(listener, OLD)
        self.assertNotIn("follows", daemon.output())

    def test_an_address_that_is_gone_is_said_each_time_and_so_is_its_return(self):
        daemon = self.run_daemon(GEMINI, OCULUS, PING360.replace("{address}", OLD), MICRON.replace("{address}", OLD))
        for time in (1, 2):
            self.take(OLD)
            for head in "gopm":
                daemon.wait_for_line(f"warning head={head}: its address {OLD} is gone from this machine", PATIENCE_S, count=time)
            self.assertEqual(len([text for text in self.findings() if f"The address {OLD} is gone" in text]), 4)
            self.give(OLD)
            for head in "gopm":
                daemon.wait_for_line(f"head={head}: its address {OLD} is back", PATIENCE_S, count=time)
            self.assertEqual([text for text in self.findings() if "is gone" in text], [])
        self.wait_for_status_from(self.far_socket(STATUS_OF_GEMINI), OLD)

    def test_the_address_that_discovery_names_is_missed_too(self):
        head = PING360.replace("{address}", "0.0.0.0") + f"    discovery: {{{{address: {OLD}, allow: [10.61.0.0/16]}}}}\n"
        daemon = self.run_daemon(head)
        self.take(OLD)
        daemon.wait_for_line(f"warning head=p: its address {OLD} is gone from this machine", PATIENCE_S)
        self.give(OLD)
        daemon.wait_for_line(f"head=p: its address {OLD} is back", PATIENCE_S)

    def test_a_head_that_is_named_by_its_address_stays_there(self):
        daemon = self.run_daemon(GEMINI, address=OLD, mask="255.255.255.0")
        self.take(OLD)
        self.give(NEW)
        daemon.wait_for_line(f"warning head=g: its address {OLD} is gone", PATIENCE_S)
        self.assertNotIn("follows", daemon.output())


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--programs", required=True, help="folder of sonard")
    options, rest = parser.parse_known_args()
    PROGRAMS = os.path.abspath(options.programs)
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
