#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Heads and clients on two machines (network namespaces on one wire): how clients find heads, and how a link that loses,
duplicates, reorders and delays affects them.

    network_test.py --programs DIR [Discovery.test_name ...]
"""

import os
import re
import socket
import time

import messages
from head import PATIENCE_S, HeadCase, UdpClient, main
from lab import HEAD_ADDRESS, CLIENT_ADDRESS, Lab, receive
from messages import ACK, AUTO_DEVICE_DATA, DEVICE_DATA, DEVICE_INFORMATION, AutoTransmit, Transducer

DISCOVERY_PORT = 30303
TEXT = (b"SONAR PING360\r\nBlue Robotics\r\nMAC Address:- 54-10-EC-79-7D-C5\r\nIP Address:- 010.061.019.200\r\n")


class TwoMachines(HeadCase):
    @classmethod
    def make_machines(cls):
        cls.lab = Lab()
        cls.lab.__enter__()
        cls.addClassCleanup(cls.lab.__exit__)
        cls.machine = cls.lab.head


class Discovery(TwoMachines):
    HEADS = """
  - name: found
    type: ping360
    udp: [{bind: 10.61.19.200:12345, allow: [10.61.19.0/24]}]
    discovery: {address: 10.61.19.200, mac: "54:10:ec:79:7d:c5", allow: [10.61.19.0/24]}
"""

    def asker(self, address=CLIENT_ADDRESS, port=0, machine=None):
        made = (machine or self.lab.client).udp_socket(address, port, reuse=True)
        made.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
        self.addCleanup(made.close)
        return made

    def ask(self, asker, text=b"Discovery", to="255.255.255.255", seconds=2):
        asker.sendto(text, (to, DISCOVERY_PORT))
        return receive(asker, seconds)

    def test_both_kinds_of_askers_get_the_text_byte_for_byte(self):
        blueos = self.asker(port=DISCOVERY_PORT)  # from the same port, by the limited broadcast, again and again
        ping_viewer = self.asker()  # from any port, by the broadcast of its network
        for _ in range(3):
            self.assertEqual(self.ask(blueos), (TEXT, (HEAD_ADDRESS, DISCOVERY_PORT)))
            self.assertEqual(self.ask(ping_viewer, to="10.61.19.255"), (TEXT, (HEAD_ADDRESS, DISCOVERY_PORT)))
        self.assertEqual(self.ask(ping_viewer, to=HEAD_ADDRESS), (TEXT, (HEAD_ADDRESS, DISCOVERY_PORT)))
        self.assertEqual(self.ask(ping_viewer, b" Discovery\r\n")[0], TEXT)

    def test_blueos_on_the_machine_of_the_head(self):
        """It holds the port at one address; the head holds it at all addresses."""
        blueos = self.asker(HEAD_ADDRESS, DISCOVERY_PORT, self.lab.head)
        self.assertEqual(self.ask(blueos), (TEXT, (HEAD_ADDRESS, DISCOVERY_PORT)))

    def test_at_the_address_of_the_text_a_head_answers(self):
        lines = self.ask(self.asker())[0].split(b"\r\n")
        self.assertEqual(len(lines), 5, "ping-viewer wants four, and nothing behind the last")
        address = ".".join(str(int(group)) for group in lines[3].split(b"- ")[1].split(b"."))
        client = self.keep(UdpClient(self.lab.client.udp_socket(CLIENT_ADDRESS, 0), (address, 12345)))
        self.assertIsNotNone(client.ask(messages.request(DEVICE_INFORMATION), DEVICE_INFORMATION))

    def test_an_order_to_move_is_answered_and_not_followed(self):
        asker = self.asker()
        self.assertEqual(self.ask(asker, b"SetSS1IP 010.061.019.077", to=HEAD_ADDRESS)[0], TEXT)
        self.assertIsNone(self.ask(asker, b"SetSS1IP 000.000.000.000", to=HEAD_ADDRESS, seconds=0.3), "it would reboot")
        self.daemon.wait_for_line(r"warning head=found: 10\.61\.19\.10 requested the address 10\.61\.19\.77: ", 5)
        self.assertEqual(self.ask(asker, to=HEAD_ADDRESS)[0], TEXT)

    def test_all_else_gets_no_answer(self):
        asker = self.asker()
        for text in (b"", b"discovery", b"Discovery2", 2000 * b"Discovery", b"SetSS1IP", b"SetSS1IP 1.2.3",
                     b"SetSS1IP 1.2.3.256"):
            self.assertIsNone(self.ask(asker, text, to=HEAD_ADDRESS, seconds=0.1), text)
        local = self.asker("127.0.0.1", machine=self.lab.head)
        self.assertIsNone(self.ask(local, to="127.0.0.1", seconds=0.1), "who is not in its `allow`")
        self.assertIsNotNone(self.ask(asker))


HEAD = """
  - name: {name}
    type: ping360
    udp: [{{bind: 10.61.19.200:{port}, allow: [10.61.19.0/24]}}]
    device: {{queue_length: 100}}    # commands that wait for each other's pings are not what this is about
    timing: {{scale: {scale}}}
    link: {{seed: 360, {link}}}
"""
EVERY_FAULT = "{loss: 0.1, duplicate: 0.1, reorder: 0.1, delay_ms: 3, jitter_ms: 4}"
FEWER = "{loss: 0.04, duplicate: 0.1, reorder: 0.1, delay_ms: 3, jitter_ms: 2}"


class Link(TwoMachines):
    """The faults are set in `link`; their effects are read from the counters that the daemon prints at its end."""

    HEADS = (HEAD.format(name="asked", port=12345, scale=0, link=f"to_client: {EVERY_FAULT}, from_client: {EVERY_FAULT}")
             + HEAD.format(name="scans", port=12346, scale=0.1, link="to_client: " + EVERY_FAULT)
             + HEAD.format(name="viewed", port=12347, scale=0.1, link=f"to_client: {FEWER}, from_client: {FEWER}")
             + HEAD.format(name="doubled", port=12348, scale=0.1, link="to_client: {duplicate: 1}"))

    def client_of(self, port):
        client = UdpClient(self.lab.client.udp_socket(CLIENT_ADDRESS, 0), (HEAD_ADDRESS, port))
        self.addCleanup(client.close)
        return client

    def test_each_request_gets_one_answer_and_scans_have_gaps_where_pings_were_lost(self):
        sent, answers = self.ask_four_hundred_times()
        scan, pings, stops = self.scan_and_stop()
        self.view_turns()
        code, _ = self.daemon.terminate(10)
        self.assertEqual(code, 0, self.daemon.tail())
        self.check_one_answer_to_each(sent, answers)
        self.check_gaps(scan, pings, stops)

    def counts(self, head):
        """The daemon's counters of this head and of its link."""
        said = " ".join(re.findall(rf"head={head}: (?:ended|transport) (.*)", self.daemon.output()))
        return {name: int(value) for name, value in re.findall(r"(\w+)=(\d+)(?= |$)", said)}

    def check_faults(self, counts, side):
        for fault in ("lost", "duplicated", "reordered"):
            self.assertGreater(counts[f"{side}_{fault}"], 10)

    def ask_four_hundred_times(self):
        """Commands with different numbers of samples, to tell them apart; every eighth is a ping. They are sent as slowly as
        the head works, because it drops the oldest waiting commands."""
        client = self.client_of(12345)
        sent = {}
        for number in range(400):
            command = Transducer(angle=number, samples=200 + number, transmit=number % 8 == 0)
            sent[command.samples] = command
            client.write(command.bytes())
            time.sleep(0.002)
        return sent, client.all_until_quiet(1)

    def check_one_answer_to_each(self, sent, answers):
        counts = self.counts("asked")
        self.check_faults(counts, "from_client")
        self.check_faults(counts, "to_client")
        self.assertEqual(counts["received"], len(sent))
        self.assertEqual(counts["commands"], counts["from_client_passed"], "every request that arrived was understood")
        answered = counts["to_client_passed"] - counts["to_client_duplicated"] + counts["to_client_lost"]
        # A copy of a waiting command is not executed again (protocol/ping360/README.md).
        self.assertEqual(answered, counts["commands"] - counts["commands_joined"], "and was answered once")
        self.assertEqual(counts["commands_dropped"] + counts["refused"] + counts["dropped_bytes"], 0)
        self.assertEqual(len(answers), counts["to_client_passed"])
        for got in answers:
            self.assertEqual(got.message, DEVICE_DATA)
            self.assert_ping(got, sent[messages.data_of(got).samples])

    def scan_and_stop(self):
        """The scan, all its frames, and the number of stop commands; less than a turn, so an angle identifies a ping."""
        client = self.client_of(12346)
        scan = AutoTransmit(samples=200)
        client.write(scan.bytes())
        pings, stops = [], 0
        while not pings or pings[-1].angle < 250:
            pings.append(self.assert_auto(client.next(), scan))
        stopped = False
        while not stopped:
            client.write(messages.MOTOR_OFF_FRAME)
            stops += 1
            for got in client.all_until_quiet():
                stopped = stopped or got.message == ACK
                pings += [self.assert_auto(got, scan)] if got.message != ACK else []
        return scan, pings, stops

    def assert_auto(self, got, scan):
        self.assertIsNotNone(got)
        self.assertEqual(got.message, AUTO_DEVICE_DATA)
        return self.assert_ping(got, scan, messages.data_of(got).angle)

    def check_gaps(self, scan, pings, stops):
        counts = self.counts("scans")
        self.check_faults(counts, "to_client")
        angles = {ping.angle for ping in pings}
        self.assertLess(max(angles), counts["pings_sent"])
        self.assertLess(counts["pings_sent"], 400)
        missing = counts["pings_sent"] - len(angles)
        self.assertGreaterEqual(missing, counts["to_client_lost"] - stops, "a ping was lost or is there")
        self.assertLessEqual(missing, counts["to_client_lost"])
        by_angle = {}
        for ping in pings:
            self.assertEqual(by_angle.setdefault(ping.angle, ping), ping, "the second copy is the first")

    def view(self, port, *options):
        viewer = self.start(os.path.join(self.PROGRAMS, "sonarview"), "ping360", "--udp", f"{HEAD_ADDRESS}:{port}", "--quiet",
                            *options, machine=self.lab.client)
        self.assertEqual(viewer.wait(PATIENCE_S), 0, viewer.tail())
        return {name: int(value) for name, value in re.findall(r"(\w+)=(\d+)(?= |$)", viewer.lines[-1])}

    def view_turns(self):
        """It repeats requests for lost frames only; duplicated frames cause no more requests."""
        summary = self.view(12347, "--auto", "--turns", "2", "--step", "4")
        self.assertEqual((summary["turns"], summary["frames_bad"], summary["bytes_dropped"]), (2, 0, 0))
        self.assertGreater(summary["pings"], 170)
        summary = self.view(12348, "--pings", "40")
        self.assertEqual((summary["pings"], summary["commands"], summary["timeouts"]), (40, 40, 0))
        self.assertGreaterEqual(summary["pings_unwanted"], 39)


if __name__ == "__main__":
    main()
