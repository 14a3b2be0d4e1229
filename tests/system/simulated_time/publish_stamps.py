#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A simulator for tests: a vehicle that moves evenly along x by its own clock, and sends its poses by TCP or UDP.

    publish_stamps.py --modules DIR --to HOST:PORT [--udp] STEP ...

Steps, one after the other:
    stand:SECONDS       the clock stands still, and the last pose is sent again and again
    silent:SECONDS      nothing is sent
    run:SECONDS@RATE    seconds of the clock, RATE times as fast as real time (0: as fast as possible)
    set:SECONDS         sets the clock; the next step continues from there
Ends when all steps are done and, by TCP, received.
"""

import argparse
import socket
import sys
import time

STEP_NS = 10_000_000
SPEED_MPS = 0.4  # from x = 0 at time 0; a reset takes the vehicle back


def varint(number):
    out = bytearray()
    while number > 0x7F:
        out.append(0x80 | number & 0x7F)
        number >>= 7
    out.append(number)
    return bytes(out)


class Publisher:
    def __init__(self, address, udp, pose_pb2):
        self.pose_pb2 = pose_pb2
        self.udp = udp
        if udp:
            self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.socket.connect(address)
        else:
            self.socket = socket.create_connection(address, timeout=30)
        self.now_ns = 0

    def send(self):
        update = self.pose_pb2.PoseUpdate(time_ns=self.now_ns, frame=self.pose_pb2.FRAME_ENU_FLU)
        update.vehicle.position_m.x = SPEED_MPS * self.now_ns * 1e-9
        update.vehicle.orientation.w = 1.0
        message = update.SerializeToString()
        self.socket.sendall(message if self.udp else varint(len(message)) + message)

    def step(self, text):
        kind, value = text.split(":")
        if kind == "stand":
            end = time.monotonic() + float(value)
            while time.monotonic() < end:
                self.send()
                time.sleep(0.01)
        elif kind == "silent":
            time.sleep(float(value))
        elif kind == "set":
            self.now_ns = round(float(value) * 1e9)
        elif kind == "run":
            seconds, rate = (float(part) for part in value.split("@"))
            self.run(round(seconds * 1e9), rate)
        else:
            sys.exit(f"publish_stamps.py: no such step: {text}")

    def run(self, length_ns, rate):
        begin, begin_ns = time.monotonic(), self.now_ns
        while self.now_ns < begin_ns + length_ns:
            self.now_ns += STEP_NS
            if rate > 0:
                due = begin + (self.now_ns - begin_ns) * 1e-9 / rate
                time.sleep(max(0.0, due - time.monotonic()))
            self.send()

    def close(self):
        if not self.udp:
            self.socket.shutdown(socket.SHUT_WR)
            self.socket.settimeout(None)  # a busy machine takes long; the test watches its pings
            while self.socket.recv(1024):  # until the daemon has taken all of it
                pass


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--modules", required=True, help="folder with pose_pb2.py")
    parser.add_argument("--to", required=True)
    parser.add_argument("--udp", action="store_true")
    parser.add_argument("steps", nargs="+")
    arguments = parser.parse_args()
    sys.path.insert(0, arguments.modules)
    import pose_pb2

    host, port = arguments.to.split(":")
    publisher = Publisher((host, int(port)), arguments.udp, pose_pb2)
    for text in arguments.steps:
        publisher.step(text)
    publisher.close()


if __name__ == "__main__":
    main()
