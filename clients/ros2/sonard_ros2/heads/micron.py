# SPDX-License-Identifier: Apache-2.0
"""A Micron behind a device server."""

from contextlib import contextmanager

from sonard_client import Micron

from ..parameter import Parameter

IS_SCANNING = True
PARAMETERS = (
    Parameter("micron_host", "127.0.0.1", "address of the Micron's device server"),
    Parameter("micron_port", 4001, "TCP port of the Micron's device server", 1, 65535),
)


@contextmanager
def connected(options):
    with Micron(options.micron_host, options.micron_port) as head:
        yield (f"Micron at {options.micron_host}:{options.micron_port}",
               head.lines(options.range_m, options.bins, options.step_deg, options.gain_percent, options.sound_speed_mps))
