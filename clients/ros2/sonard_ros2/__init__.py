# SPDX-License-Identifier: Apache-2.0
"""ROS 2 and sonard: `pose_bridge` passes poses on to sonard, `sonar_bridge` publishes the pings of a head."""
