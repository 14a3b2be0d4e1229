# SPDX-License-Identifier: Apache-2.0
"""A Ping1D or Ping2."""

from contextlib import contextmanager

from sonard_client import Ping1D

from ..parameter import Parameter

IS_SCANNING = False
PARAMETERS = (
    Parameter("ping1d_host", "127.0.0.1", "address of the Ping1D, or of the bridge of its vehicle"),
    Parameter("ping1d_port", 9090, "UDP port of the Ping1D", 1, 65535),
    Parameter("auto_range", True, "the head chooses range and gain; Ping1D"),
)


@contextmanager
def connected(options):
    with Ping1D(options.ping1d_host, options.ping1d_port) as head:
        yield (f"Ping{'2' if head.revision == 2 else '1D'} at {options.ping1d_host}:{options.ping1d_port}",
               head.pings(0.0 if options.auto_range else min(options.range_m, 100.0), gain=round(0.06 * options.gain_percent),
                          interval_s=options.interval_s, sound_speed_mps=options.sound_speed_mps))
