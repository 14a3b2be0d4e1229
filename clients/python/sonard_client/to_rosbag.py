# SPDX-License-Identifier: Apache-2.0
"""Writes the pings of a log of sonard (.mcap, .glf, .dat) as a bag of ROS 2, an MCAP file of profile ros2. Needs no ROS.

    python3 -m sonard_client.to_rosbag logs/log_2026-11-25-124527.mcap bag.mcap

Topics: /HEAD/sonar (marine_acoustic_msgs/ProjectedSonarImage) and /HEAD/points (sensor_msgs/PointCloud2) for each ping or
line, /tf from `world` to HEAD and to HEAD_beams, /clock. All have the time of transmission.
"""

from __future__ import annotations

import argparse
import re
import sys
import warnings
from pathlib import Path
from typing import Iterable, Iterator, Optional, Sequence

import numpy as np

from . import cdr
from . import ros2_messages as contents
from .log import read_log
from .mcap_writer import McapWriter
from .ping import LoggedPing

_WORLD = "world"
_END_NS = 2**31 * 10**9  # seconds of ROS have 31 bits


def messages(ping: LoggedPing, echoes: contents.EchoFilter) -> Iterator[tuple[str, contents.Content]]:
    """Topic and content of each message of a ping."""
    frame = re.sub(r"[^A-Za-z0-9_]", "_", ping.head) or "sonar"
    frame = frame if not frame[0].isdigit() else "sonar_" + frame  # no name of ROS begins with a digit
    yield "/clock", contents.clock(ping.time_ns)
    transforms = [contents.beams_transform(ping.time_ns, frame)]
    if np.isfinite([*ping.sonar_position_m, *ping.sonar_quaternion_xyzw]).all():
        transforms.insert(0, contents.transform(ping.time_ns, _WORLD, frame, ping.sonar_position_m,
                                                ping.sonar_quaternion_xyzw))
    yield "/tf", contents.content("tf2_msgs/TFMessage", transforms=transforms)
    yield f"/{frame}/sonar", contents.projected_sonar_image(ping, ping.time_ns, frame)
    yield f"/{frame}/points", contents.points(ping, ping.time_ns, frame, echoes)


def write(pings: Iterable[LoggedPing], bag: Path, echoes: contents.EchoFilter) -> int:
    """Writes a new file. Returns the number of pings; raises OSError, FileExistsError if there is such a file."""
    count = 0
    with open(bag, "xb") as file:
        writer = McapWriter(file, "ros2", "sonard_client")
        for ping in pings:
            if not 0 <= ping.time_ns < _END_NS:
                warnings.warn(f"a ping at {ping.time_ns} ns is left out: ROS has no such time", stacklevel=2)
                continue
            count += 1
            for topic, content in messages(ping, echoes):
                writer.add(topic, content.kind.replace("/", "/msg/"), "ros2msg", cdr.schema(content.kind), "cdr", ping.time_ns,
                           cdr.encode(content))
        writer.close()
    return count


def main(arguments: Optional[Sequence[str]] = None) -> int:
    defaults = contents.EchoFilter()
    parser = argparse.ArgumentParser(prog="sonard_client.to_rosbag", description="Writes a log of sonard as a bag of ROS 2.")
    parser.add_argument("log", type=Path, help=".mcap, .glf or .dat of sonard")
    parser.add_argument("bag", type=Path, help="the .mcap to write")
    parser.add_argument("--threshold-percent", type=float, default=defaults.threshold_percent,
                        help="least sample of an echo in points, in percent of full scale (%(default)g)")
    parser.add_argument("--min-range-m", type=float, default=defaults.min_range_m,
                        help="least range of an echo in points (%(default)g)")
    options = parser.parse_args(arguments)
    try:
        with warnings.catch_warnings():
            warnings.showwarning = lambda message, *_, **__: print(f"to_rosbag: {message}", file=sys.stderr)
            count = write(read_log(options.log), options.bag,
                          contents.EchoFilter(options.threshold_percent, options.min_range_m))
    except FileExistsError as error:
        print(f"to_rosbag: {error.filename} exists", file=sys.stderr)
        return 2
    except (OSError, ValueError) as error:
        print(f"to_rosbag: {error}", file=sys.stderr)
        options.bag.unlink(missing_ok=True)
        return 2
    print(f"{options.bag}: {count} pings")
    return 0


if __name__ == "__main__":
    sys.exit(main())
