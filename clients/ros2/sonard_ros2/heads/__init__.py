# SPDX-License-Identifier: Apache-2.0
"""The heads that sonar_bridge is a client of: an adapter for each type. An adapter is a module with

    PARAMETERS            the parameters that only this type has. Those for several types are in parameters.py
    IS_SCANNING           whether a ping is one line of a turn
    connected(options)    a context with the head: its name for the log, and an iterator of its pings (sonard_client.Ping
                          or Shot).
                          Raises NoHead, NoPing or OSError, after which the node tries again
"""

from . import gemini, micron, oculus, ping1d, ping360, sonar3d15

HEADS = {"gemini": gemini, "micron": micron, "oculus": oculus, "ping1d": ping1d, "ping360": ping360,
         "sonar3d15": sonar3d15}
