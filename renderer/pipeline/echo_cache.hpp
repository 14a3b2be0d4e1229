// SPDX-License-Identifier: Apache-2.0
// The last mean echo of a sonar, and whether it is still the one that is asked for.
#pragma once

#include <cstdint>

#include "renderer/ping.hpp"
#include "renderer/pipeline/ping_motion.hpp"

namespace sonard::render {

/// The last mean echo of a stream, and what it was made of (SkipRule::unchanged_scene).
struct CachedEcho {
  EchoImage image;
  SonarSettings settings;
  std::uint64_t seed = 0;
  SonarMotion motion;
  std::uint64_t world_revision = 0;  ///< 0: there is none yet
  bool sees_surface = true;          ///< PingStatistics::sees_surface

  /// Whether all that the mean echo depends on is what it was made of.
  bool fits(const PingRequest& wanted, const SonarMotion& motion_wanted, std::uint64_t revision) const;
};

}  // namespace sonard::render
