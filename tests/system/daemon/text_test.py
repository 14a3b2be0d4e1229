#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Text from peers and files, in every place that the programs print: it forges no line and controls no terminal.

    text_test.py --programs DIR [TestCase.test_name ...]
"""

import argparse
import glob
import json
import os
import re
import shutil
import socket
import struct
import subprocess
import sys
import time
import unittest

import daemon_test
from daemon_test import PATIENCE_S, START_S, WORLD, DaemonCase, free_port

SOURCE = daemon_test.SOURCE
sys.path += [os.path.join(SOURCE, *folder) for folder in (("clients", "python"), ("tests", "support"),
                                                       ("tests", "system", "ping360"))]
import glf_writer  # noqa: E402
import messages  # noqa: E402
from sonard_client.poses import _message_field, _quaternion, encode_pose  # noqa: E402

# A forged line that clears the screen: by ESC, by the one-character CSI, and behind a mark of direction.
HOSTILE = "x'\n2026-11-20T14:22:33.250Z error FORGED\r\x1b[2J\x9b2J\u202e\x7f"
AS_YAML = json.dumps(HOSTILE)  # YAML takes the strings of JSON
AS_XML = "x'&#10;FORGED&#13;&#9;&#x9b;2J&#x202e;&#x7f;"  # XML 1.0 has no ESC
LOGS_MESSAGE = 0x80  # of an Oculus


def write_script(path, text):
    with open(path, "w", encoding="utf-8") as file:
        file.write("#!/bin/sh\n" + text)
    os.chmod(path, 0o755)


class HostileText(DaemonCase):
    def path(self, name):
        return os.path.join(self.folder.name, name)

    def expect_clean(self, output):
        """`output`: bytes. They contain the hostile text without its control characters."""
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
        """Output of a daemon whose pose stream sends hostile names of bodies."""
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

    def test_no_program_prints_an_error_or_a_path_as_it_is(self):
        """The tests above cover known paths; this one searches the sources for new ones."""
        argument = r"\((?:[^()]|\((?:[^()]|\([^()]*\))*\))*\)"
        prints = 0
        for path in glob.glob(os.path.join(SOURCE, "server", "**", "*.cpp"), recursive=True) + \
                glob.glob(os.path.join(SOURCE, "clients", "**", "*.cpp"), recursive=True):
            with open(path, encoding="utf-8") as file:
                for statement in re.findall(r"fmt::print\(.*?\);", file.read(), re.DOTALL):
                    prints += 1
                    self.assertNotRegex(re.sub("printable" + argument, "", statement), r"what\(\)|\.string\(\)|argv|\.name\b(?!\()", path)
        self.assertGreater(prints, 40)

    def test_the_page_makes_no_html_of_text(self):
        page = os.path.join(SOURCE, "server", "web", "page")
        scripts = [name for name in os.listdir(page) if name.endswith(".js")]
        self.assertTrue(scripts)
        for name in scripts:
            with open(os.path.join(page, name), encoding="utf-8") as file:
                self.assertNotRegex(file.read(), r"innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(", name)

    def test_what_a_head_refuses_in_the_line_viewer(self):
        with socket.create_server(("127.0.0.1", 0)) as head:
            view = subprocess.Popen([os.path.join(daemon_test.PROGRAMS, "sonarview"), "ping360", "--tcp",
                                     f"127.0.0.1:{head.getsockname()[1]}", "--ping-wait", "10"],
                                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            self.processes.append(view)
            self.addCleanup(view.stdout.close)
            head.settimeout(PATIENCE_S)
            answers = {messages.PROTOCOL_VERSION: bytes(4), messages.DEVICE_INFORMATION: bytes(6),
                       messages.DEVICE_DATA: bytes(14)}
            parser = messages.Parser()
            with head.accept()[0] as connection:
                while data := connection.recv(4096):
                    for asked in parser.feed(data):
                        if asked.message == messages.GENERAL_REQUEST:
                            wanted = struct.unpack("<H", asked.payload)[0]
                            connection.sendall(messages.frame(wanted, answers[wanted], source=2))
                        elif asked.message == messages.TRANSDUCER:
                            refusal = struct.pack("<H", asked.message) + HOSTILE.encode()
                            connection.sendall(messages.frame(messages.NACK, refusal, source=2))
                output, _ = view.communicate(timeout=PATIENCE_S)
        self.expect_clean(output)

    def test_names_of_lines_and_trajectories_in_the_clients(self):
        for device in ("micron", "ping360"):
            with self.subTest(device):
                self.expect_clean(self.run_to_end("sonarview", device, "--tty", self.path(HOSTILE), "--wait", "0.2",
                                                  codes=range(1, 128)))
        self.expect_clean(self.run_to_end("posecast", self.path(HOSTILE), codes=range(1, 128)))
        path = self.path(HOSTILE + ".csv")
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"t,x,y,z,qx,qy,qz,qw\n{HOSTILE}\n")
        self.expect_clean(self.run_to_end("posecast", path, codes=range(1, 128)))

    def test_what_render_prints_and_the_names_of_its_files(self):
        way = self.path("way.csv")
        with open(way, "w", encoding="ascii") as file:
            file.write("t,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n1,0,0,0,0,0,0,1\n")
        _, _, configuration = self.configuration()
        with open(configuration, encoding="utf-8") as file:
            text = file.read()
        out = self.path(HOSTILE + "out")
        for _ in range(2):  # the second run finds what the first has made
            self.expect_clean(self.run_to_end("sonard", "render", configuration, "--trajectory", way, "--out", out,
                                              "--still", codes=(0,)))
        self.assertTrue(os.listdir(out))
        for name in os.listdir(out):
            self.assertRegex(name, r"^[A-Za-z0-9_.-]+$")
        with open(configuration, "w", encoding="utf-8") as file:
            file.write(text.replace("engine: cpu", f"engine: cpu\n{AS_YAML}: 1"))
        self.expect_clean(self.run_to_end("sonard", "render", configuration, "--trajectory", way, "--out", out, codes=(2,)))

    def copied_demo(self):
        """A copy of sonard in a folder in which the demo finds its configurations; and this folder."""
        programs = self.path("a/b/bin")
        os.makedirs(programs)
        os.symlink(os.path.join(SOURCE, "configs"), self.path("configs"))
        demo = os.path.join(programs, "the_demo")
        shutil.copy(os.path.join(daemon_test.PROGRAMS, "sonard"), demo)
        return demo, programs

    def run_demo(self, demo, *arguments):
        done = subprocess.run([demo, "demo", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              timeout=START_S, check=False)
        return done.returncode, done.stdout

    def test_what_the_demo_passes_on(self):
        """The demo starts programs from its own folder; here these programs print hostile text."""
        demo, programs = self.copied_demo()
        line = HOSTILE.replace("\n", "")
        for name, last in (("sonard", "sonard ready"), ("posecast", ""), ("sonarview", f"summary rate_hz={line}")):
            write_script(os.path.join(programs, name), f"cat <<'END'\n{line}\n{last}\nEND\n"
                         + ("" if name == "sonarview" else "exec sleep 60\n"))
        for arguments, codes in ((["--out", self.path(HOSTILE)], (0,)), ([HOSTILE], (2, 64))):
            code, output = self.run_demo(demo, *arguments)
            self.assertIn(code, codes, output)
            self.expect_clean(output)

    def test_exit_codes_of_the_demo(self):
        """A failure that the user can mend is no defect (70) of sonard; docs/configuration.md lists the codes."""
        demo, programs = self.copied_demo()
        code, output = self.run_demo(demo)
        self.assertEqual(code, 2, output)
        self.assertIn(b"beside sonard", output)
        for name, ends_with, expected in (
                ("sonard", "exit 2", 2), ("sonard", "exit 3", 3), ("sonard", "exit 71", 71), ("sonard", "exit 0", 70),
                ("sonard", "exit 70", 70), ("sonard", "kill -ILL $$", 70), ("posecast", "exit 1", 3), ("posecast", "exit 2", 70),
                ("sonarview", "exit 3", 3), ("sonarview", "exit 2", 70)):
            for each in ("sonard", "posecast", "sonarview"):
                ends = f"sleep 0.1; echo the last words; {ends_with}\n" if each == name else "exec sleep 60\n"
                ready = "echo sonard ready\n" if each == "sonard" and name != "sonard" else ""
                write_script(os.path.join(programs, each), ready + ends)
            with self.subTest(name=name, ends_with=ends_with):
                code, output = self.run_demo(demo)
                self.assertEqual(code, expected, output)
                self.assertIn(b"the last words", output)

    def test_a_demo_whose_port_is_taken(self):
        with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as taken:
            taken.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            taken.bind(("127.0.0.1", 4001))
            taken.listen()
            code, output = self.run_demo(os.path.join(daemon_test.PROGRAMS, "sonard"), "micron")
        self.assertEqual(code, 3, output)
        self.assertIn(b"127.0.0.1:4001", output)

    def test_the_name_of_a_gpu_in_the_selftest(self):
        os.environ["force_gl_renderer"] = HOSTILE  # Mesa's own switch for the name of its renderer
        try:
            output = self.run_to_end("sonard", "selftest", codes=(0,))
        finally:
            del os.environ["force_gl_renderer"]
        if b"Mesa" not in output:
            self.skipTest("no OpenGL of Mesa here")
        self.expect_clean(output)

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
