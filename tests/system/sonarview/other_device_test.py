#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""sonarview at a port where another type of device sends.

    other_device_test.py --programs DIR [TestCase.test_name ...]
"""

import argparse
import os
import socket
import subprocess
import sys
import threading
import unittest

PROGRAMS = None
PATIENCE_S = 60
SENTENCE = b"$SDDBT,36.1,f,11.0,M,6.0,F*0C\r\n"  # of an echo sounder, NMEA 0183
TEXTS = {
    "dvl_a50": rb"is open, but no report came within 2\.0 s: \d+ bytes arrived that are not of a DVL",
    "micron": rb"is open, but head 2 sent nothing within 2\.0 s: \d+ bytes arrived that are not of a Micron",
    "ping1d": rb"is open, but no head answered within 2\.0 s: \d+ bytes arrived that are not of a Ping1D",
    "ping360": rb"is open, but no head answered within 2\.0 s: \d+ bytes arrived that are not of a Ping360",
    "oculus": rb"no ping for 2\.0 s: \d+ bytes arrived that are not of an Oculus",
}


class OtherDevice(unittest.TestCase):
    def serve(self, sentence):
        """A TCP port that sends a sentence ten times a second to everybody."""
        server = socket.create_server(("127.0.0.1", 0))
        self.addCleanup(server.close)
        done = threading.Event()

        def send():
            connections = []
            server.settimeout(0.1)
            while not done.is_set():
                try:
                    connections.append(server.accept()[0])
                except TimeoutError:
                    pass
                for connection in connections:
                    try:
                        connection.sendall(sentence)
                    except OSError:
                        pass
            for connection in connections:
                connection.close()

        sender = threading.Thread(target=send)
        sender.start()
        self.addCleanup(sender.join)
        self.addCleanup(done.set)
        return server.getsockname()[1]

    def view(self, device, port):
        line = ["--head", "127.0.0.1", "--port", str(port), "--ping-wait", "2"] if device == "oculus" else \
            ["--tcp", f"127.0.0.1:{port}", "--wait", "2"]
        done = subprocess.run([os.path.join(PROGRAMS, "sonarview"), device, *line], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, timeout=PATIENCE_S, check=False)
        self.assertNotEqual(done.returncode, 0, done.stdout)
        return done.stdout

    def test_bytes_of_another_device_are_named(self):
        port = self.serve(SENTENCE)
        for device, text in TEXTS.items():
            with self.subTest(device):
                self.assertRegex(self.view(device, port), text)

    def test_silence_is_not_another_device(self):
        port = self.serve(b"")
        for device in TEXTS:
            with self.subTest(device):
                self.assertNotIn(b"bytes arrived", self.view(device, port))

    def test_help_of_samples(self):
        done = subprocess.run([os.path.join(PROGRAMS, "sonarview"), "ping360", "--help"], stdout=subprocess.PIPE,
                              timeout=PATIENCE_S, check=True)
        self.assertRegex(done.stdout, rb"--samples 200\.\.1200 or 0 \[0\]")


def main():
    global PROGRAMS
    parser = argparse.ArgumentParser()
    parser.add_argument("--programs", required=True)
    arguments, rest = parser.parse_known_args()
    PROGRAMS = arguments.programs
    unittest.main(argv=[sys.argv[0], *rest])


if __name__ == "__main__":
    main()
