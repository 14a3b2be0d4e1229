// SPDX-License-Identifier: Apache-2.0
// All poses of one ping, asked for once.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "renderer/pose.hpp"
#include "server/clock/clock.hpp"
#include "server/pose/posed_body.hpp"

namespace sonard::server {

/// Renderer, logs, viewers and diagnosis share this value.
struct PosesUsed {
  TimePoint time{};  ///< of the transmission
  render::Pose T_world_vehicle;
  render::Pose T_world_sonar;     ///< of the mount
  std::vector<PosedBody> bodies;  ///< moved by poses so far
  /// Of the mount when the last echo returns; nullopt: not known.
  std::optional<render::Pose> T_world_sonar_at_end{};
  std::int64_t stamp_ns = 0;           ///< of the transmission, on the clock of the poses
  glm::dvec3 sonar_velocity_mps{0.0};  ///< of the mount over ground, in its axes
};

}  // namespace sonard::server
