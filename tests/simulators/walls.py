# SPDX-License-Identifier: Apache-2.0
"""A daemon in a world of two walls and a floor; its image shows the pose of the vehicle."""

import math
import os
import sys

SOURCE = os.path.abspath(os.path.join(os.path.dirname(__file__), "..", ".."))
sys.path.insert(0, os.path.join(SOURCE, "tests", "system", "gemini"))

import link_test  # noqa: E402
import wire  # noqa: E402
from lab import Deadline  # noqa: E402

WORLD = os.path.join(SOURCE, "tests", "data", "system", "two_walls.sdf")

DAEMON = """
world:
  file: {world}
engine: cpu
poses:
{poses}
  extrapolation_limit_ms: 300
sampling:
  preset: grid
  views: 3
  columns_per_view: 64
  rows: 32
heads:
{head}
"""

UDP_POSES = """
  udp:
    bind: 127.0.0.1:14600
"""

PORT_MOST, AHEAD, STARBOARD_MOST = 0, 128, 255  # beams
# Bearings of the outer and inner edges of the outermost beams (docs/frames-and-units.md).
OUTER_RAD = math.radians(60)
INNER_RAD = math.asin(254 / 256 * math.sin(OUTER_RAD))


class WallTest(link_test.LinkTest):
    """The north wall is at y = 4 m, the east wall at x = 6 m, the floor at z = -5 m; above the walls, z > 4 m, is open water."""

    def start_walls(self, poses=UDP_POSES):
        self.lab = self.make_lab()
        path = os.path.join(self.folder.name, "sonard.yaml")
        with open(path, "w", encoding="utf-8") as file:
            file.write(DAEMON.format(world=WORLD, poses=poses.strip("\n"), head=self.head_config(noisy=False)))
        self.daemon = self.lab.start(self.lab.head, os.path.join(link_test.PROGRAMS, "sonard"), "run", path)
        self.daemon.wait_for_line(r"sonard ready heads=1 ", link_test.START_S)
        self.client = link_test.RawClient(self.lab)
        self.addCleanup(self.client.close)

    def ranges(self, beams):
        """Range of the first echo in each beam, metres; 0 without an echo. None without a ping, as there is no pose yet."""
        self.client.send(wire.ping_config(513, lines=1200, spreading=293))  # 10 m
        try:
            ping = self.client.next_ping(seconds=2)
        except AssertionError:
            return None
        step_m = wire.line_step_m(1500.0)
        return [next((i * step_m for i in range(ping.count) if ping.lines[i][beam] > 0), 0) for beam in beams]

    def check_ranges(self, expected_m):
        """{beam: metres, 0 for open water}. The first pings may still show the pose before."""
        beams, wanted = list(expected_m), list(expected_m.values())
        deadline = Deadline(link_test.PATIENCE_S)
        seen = []
        while not deadline.over():
            seen.append(self.ranges(beams))
            # Two lines, plus the footprint of a sample and the width of a beam.
            if len(seen) >= 3 and all(ranges and all(abs(a - b) < 0.04 for a, b in zip(ranges, wanted))
                                      for ranges in seen[-3:]):
                return
        self.fail(f"expected {expected_m} three times in a row, saw {seen[-8:]}; {self.lab.tails()}")
