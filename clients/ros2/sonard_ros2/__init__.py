# SPDX-License-Identifier: Apache-2.0
"""ROS 2 nodes for sonard: `pose_bridge` sends poses to sonard, `sonar_bridge` publishes the pings of a head."""
