#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Text of peers and files wherever the programs print it: it forges no line and commands no terminal.

    text_test.py --programs DIR [TestCase.test_name ...]
"""

import argparse
import json
import os
import socket
import struct
import subprocess
import sys
import time
import unittest

import daemon_test
from daemon_test import PATIENCE_S, START_S, WORLD, DaemonCase, free_port

SOURCE = daemon_test.SOURCE
sys.path += [os.path.join(SOURCE, *folder) for folder in (("clients", "python"), ("tests", "support"))]
import glf_writer  # noqa: E402
from sonard_client.poses import _message_field, _quaternion, encode_pose  # noqa: E402

# A line of its own that clears the screen: by ESC, by the one-character CSI, and behind a mark of direction.
HOSTILE = "x'\n2026-11-20T14:22:33.250Z error FORGED\r\x1b[2J\x9b2J\u202e\x7f"
AS_YAML = json.dumps(HOSTILE)  # YAML takes the strings of JSON
AS_XML = "x'&#10;FORGED&#13;&#9;&#x9b;2J&#x202e;&#x7f;"  # XML 1.0 has no ESC
LOGS_MESSAGE = 0x80  # of an Oculus


class HostileText(DaemonCase):
    def path(self, name):
        return os.path.join(self.folder.name, name)

    def expect_clean(self, output):
        """`output`: bytes. The hostile text is in it, and does nothing."""
        text = output.decode(errors="surrogateescape")
        self.assertIn("FORGED", text)
        commands = [c for c in text if (c < " " and c != "\n") or "\x7f" <= c <= "\x9f" or c == "\u202e"]
        self.assertEqual(commands, [], text)
        for line in text.split("\n"):
            self.assertNotRegex(line, r"^(2026-11-20T14:22:33.250Z error )?FORGED", text)

    def run_to_end(self, program, *arguments, codes):
        done = subprocess.run([os.path.join(daemon_test.PROGRAMS, program), *arguments], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=2 * START_S, check=False)
        self.assertIn(done.returncode, codes, done.stdout)
        return done.stdout

    def serve_hostile_bodies(self, *options):
        """What the daemon prints whose pose stream names bodies."""
        port = free_port()
        command = self.configuration(poses=f", udp: {{bind: 127.0.0.1:{port}}}")
        with open(self.path("log"), "w+b") as log:
            daemon = subprocess.Popen(command + list(options), stderr=log)
            self.processes.append(daemon)
            body = _message_field(1, HOSTILE.encode()) + _message_field(2, _message_field(2, _quaternion((0, 0, 0, 1))))
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as publisher:
                deadline = daemon_test.Deadline(START_S)
                client = None
                while not deadline.over():
                    log.seek(0)
                    output = log.read()
                    if b"FORGED" in output:
                        break
                    publisher.sendto(encode_pose(time.monotonic_ns(), (0, 0, 0), (0, 0, 0, 1)) + _message_field(5, body),
                                     ("127.0.0.1", port))
                    if b"sonard ready" in output:
                        if client is None:
                            client = self.client()
                            self.configured(client)
                        client.write(daemon_test.frame("send_data"))
                    time.sleep(0.05)
            daemon.terminate()
            daemon.wait(PATIENCE_S)
            log.seek(0)
            return log.read()

    def test_bodies_of_a_publisher_in_the_log(self):
        self.expect_clean(self.serve_hostile_bodies())

    def test_bodies_of_a_publisher_in_a_log_of_json(self):
        output = self.serve_hostile_bodies("--log-format", "json")
        self.expect_clean(output)
        for line in output.decode().splitlines():
            json.loads(line)

    def test_names_in_a_world(self):
        with open(WORLD, encoding="utf-8") as file:
            text = file.read().replace('name="sphere"', f'name="{AS_XML}"')
        world = self.path("world.sdf")
        with open(world, "w", encoding="utf-8") as file:
            file.write(text.replace("</link>", f'</link><plugin filename="p" name="{AS_XML}"/>'))
        _, _, path = self.configuration()
        with open(path, encoding="utf-8") as file:
            text = file.read().replace(WORLD, world)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        self.expect_clean(self.run_to_end("sonard", "check", "--no-network", path, codes=(0, 2)))
        self.expect_clean(self.run_to_end("sonard", "check", "--json", "--no-network", path, codes=(0, 2)))

    def test_values_in_a_configuration(self):
        for more in (f"engine: {AS_YAML}", f"{AS_YAML}: 1", f"extra: {{{AS_YAML}: [}}"):
            path = self.path("bad.yaml")
            with open(path, "w", encoding="utf-8") as file:
                file.write(f"world: empty\nposes: {{initial: {{position_m: [0, 0, 0]}}}}\n{more}\nheads: []\n")
            for command in (("check", path), ("run", path), ("run", "--log-format", "json", path)):
                with self.subTest(more=more, command=command[0]):
                    output = self.run_to_end("sonard", *command, codes=(2,))
                    if b"FORGED" in output:
                        self.expect_clean(output)
        self.expect_clean(self.run_to_end("sonard", "check", self.path(HOSTILE), codes=(2,)))

    def test_names_of_logs(self):
        log, empty = (self.path(HOSTILE.replace("x", letter) + ".glf") for letter in "le")
        glf_writer.write_glf(log, glf_writer.noise(2, 50), [])
        with open(empty, "wb"):
            pass
        for command in (("info", log), ("info", "--json", log), ("info", empty), ("replay", empty)):
            with self.subTest(command):
                self.expect_clean(self.run_to_end("sonard", *command, codes=(0, 2)))

    def test_the_page_makes_no_html_of_text(self):
        page = os.path.join(SOURCE, "server", "web", "page")
        scripts = [name for name in os.listdir(page) if name.endswith(".js")]
        self.assertTrue(scripts)
        for name in scripts:
            with open(os.path.join(page, name), encoding="utf-8") as file:
                self.assertNotRegex(file.read(), r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(", name)

    def test_what_a_head_says_in_sonarview(self):
        with socket.create_server(("127.0.0.1", 0)) as head:
            port = head.getsockname()[1]
            view = subprocess.Popen([os.path.join(daemon_test.PROGRAMS, "sonarview"), "oculus", "--head", "127.0.0.1",
                                     "--port", str(port), "--ping-wait", "2"], stdout=subprocess.PIPE,
                                    stderr=subprocess.STDOUT)
            self.processes.append(view)
            self.addCleanup(view.stdout.close)
            head.settimeout(PATIENCE_S)
            with head.accept()[0] as connection:
                text = HOSTILE.encode()
                connection.sendall(struct.pack("<HHHHHIH", 0x4F53, 1, 0, LOGS_MESSAGE, 1, len(text), 0) + text)
                output, _ = view.communicate(timeout=PATIENCE_S)
        self.expect_clean(output)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True)
    arguments, rest = parser.parse_known_args()
    daemon_test.PROGRAMS = arguments.programs
    unittest.main(argv=[sys.argv[0], *rest])
