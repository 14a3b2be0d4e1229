// SPDX-License-Identifier: Apache-2.0
// What ROS says about a frame, without the headers of ROS, which do not compile as C++20.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/pose/transform.hpp"

namespace sonard::client {

/// A nav_msgs/Odometry, or one transform of tf. As received: nothing is checked yet.
struct RosPose {
  std::string frame;        ///< header.frame_id
  std::string child_frame;  ///< child_frame_id
  std::int64_t stamp_ns = 0;
  pose::Transform T_frame_child;
  std::optional<pose::Velocity> twist;  ///< in the axes of the child frame; only of Odometry
};

/// Frame names of tf's first version begin with a slash and mean the same without it.
inline std::string without_slash(const std::string& frame) {
  return frame.empty() || frame.front() != '/' ? frame : frame.substr(1);
}

}  // namespace sonard::client
