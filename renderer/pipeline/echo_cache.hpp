// SPDX-License-Identifier: Apache-2.0
// Stores the last mean echo of a sonar, and checks whether a new request would give the same.
#pragma once

#include <cstdint>

#include "renderer/ping.hpp"
#include "renderer/pipeline/ping_motion.hpp"

namespace sonard::render {

/// The last mean echo of a head, and its inputs (SkipRule::unchanged_scene).
struct CachedEcho {
  EchoImage image;
  DirectionEchoes directions;  ///< instead of the image, if the settings have directions
  SonarSettings settings;
  std::uint64_t seed = 0;
  SonarMotion motion;
  std::uint64_t world_revision = 0;  ///< 0: empty
  bool sees_surface = true;          ///< PingStatistics::sees_surface

  /// Whether all inputs of the mean echo are the stored ones.
  bool fits(const PingRequest& wanted, const SonarMotion& motion_wanted, std::uint64_t revision) const;
  /// Stores the inputs of `image`. Copies the settings only if they give another echo than the stored ones.
  void keep_inputs(const PingRequest& request, const SonarMotion& motion_used, std::uint64_t revision);
};

}  // namespace sonard::render
