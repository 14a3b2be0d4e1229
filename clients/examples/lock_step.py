#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Moves a vehicle in lock-step with the pings: each run gives the same images (docs/ci.md).

Run it beside `sonard run configs/lock-step.yaml`. Needs NumPy, and clients/python in the PYTHONPATH. Prints the stamp of
each ping and the CRC-32 of its samples.
"""
import argparse
import time
import zlib

from sonard_client import Gemini, PosePublisher

PERIOD_NS, STEP_NS = 100_000_000, 20_000_000  # from ping to ping, from pose to pose
RANGE_M, SOUND_SPEED_MPS = 20.0, 1450.0  # slower than in the water, so that the last echo arrives in time
LISTENING_NS = round(2e9 * RANGE_M / SOUND_SPEED_MPS)

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("--pings", type=int, default=5)
args = parser.parse_args()


def send_pose(poses, time_ns):
    """The path leads ahead at 0.5 m/s, past the docking station."""
    x, y = -2.136 + 0.087 * 1e-9 * time_ns, -11.913 + 0.492 * 1e-9 * time_ns
    poses.send(time_ns, position_m=(x, y, -25.6), quaternion_xyzw=(0, 0, 0.643, 0.766))


with Gemini() as sonar, PosePublisher("127.0.0.1", 14601, tcp=True) as poses:
    pings = sonar.pings(interval_s=1e-9 * PERIOD_NS, range_m=RANGE_M)  # requests the pings
    for _ in range(10):  # time stands still until the head has received the request
        send_pose(poses, 0)
        time.sleep(0.05)
    time_ns = 0
    for number in range(args.pings):
        while time_ns < number * PERIOD_NS + LISTENING_NS:
            time_ns += STEP_NS
            send_pose(poses, time_ns)
        ping = next(pings)
        print(f"{number * PERIOD_NS / 1e9:.3f} {zlib.crc32(ping.samples.tobytes()):08x}", flush=True)
