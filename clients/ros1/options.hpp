// SPDX-License-Identifier: Apache-2.0
// The command line of roscast.
#pragma once

#include <optional>
#include <string>

#include "clients/posecast/pose_link.hpp"
#include "clients/ros1/pose_bridge.hpp"

namespace sonard::client {

struct RoscastOptions {
  std::string odometry_topic;  ///< empty: the vehicle's pose comes from tf
  BridgeSettings bridge;
  Destination destination;

  bool uses_tf() const { return odometry_topic.empty() || !bridge.bodies.empty(); }
};

/// Reads the command line, without ROS's own arguments. Without a value the program ends at once with
/// `exit_status`: help was asked for, or something was wrong and has been said.
std::optional<RoscastOptions> read_roscast_options(int argc, char** argv, int& exit_status);

}  // namespace sonard::client
