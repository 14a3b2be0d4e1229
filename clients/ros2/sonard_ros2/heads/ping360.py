# SPDX-License-Identifier: Apache-2.0
"""A Ping360."""

from contextlib import contextmanager

from sonard_client import Ping360

from ..parameter import Parameter

IS_SCANNING = True
PARAMETERS = (
    Parameter("ping360_host", "127.0.0.1", "address of the Ping360"),
    Parameter("ping360_port", 12345, "UDP port of the Ping360", 1, 65535),
)


@contextmanager
def connected(options):
    with Ping360(options.ping360_host, options.ping360_port) as head:
        yield (f"Ping360 at {options.ping360_host}:{options.ping360_port}",
               head.lines(options.range_m, options.bins, options.step_deg, options.gain_percent, options.sound_speed_mps))
