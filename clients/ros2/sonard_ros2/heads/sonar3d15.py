# SPDX-License-Identifier: Apache-2.0
"""A Sonar 3D-15, whose pings are shots (sonard_client.Shot)."""

from contextlib import contextmanager

from sonard_client import Sonar3D15

from ..parameter import Parameter

IS_SCANNING = False
PARAMETERS = (
    Parameter("sonar3d15_host", "127.0.0.5", "address of the Sonar 3D-15"),
    Parameter("sonar3d15_port", 8080, "TCP port of the Sonar 3D-15; real heads have 80", 1, 65535),
)


@contextmanager
def connected(options):
    with Sonar3D15(options.sonar3d15_host, options.sonar3d15_port, options.local) as head:
        range_m = min(options.range_m, 15.0)
        yield (f"Sonar 3D-15 at {options.sonar3d15_host}:{options.sonar3d15_port}",
               head.shots(range_m, min(options.min_range_m, 0.5 * range_m), options.high_frequency, options.sound_speed_mps))
