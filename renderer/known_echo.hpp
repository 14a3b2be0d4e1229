// The last mean echo of a sonar, and whether it is still the one that is asked for.
#pragma once

#include <cstdint>
#include <optional>

#include "renderer/sonar_renderer.hpp"

namespace sonard::render {

/// Where the sonar is while it pings.
struct SonarMotion {
  Pose T_world_sonar;          ///< when the ping is sent
  std::optional<Pose> at_end;  ///< when its last line is heard; nullopt: as if at rest
  bool operator==(const SonarMotion&) const = default;
};

/// The last mean echo of a stream, and what it was made of (SkipRule::unchanged_scene).
struct KnownEcho {
  EchoImage image;
  SonarSettings settings;
  std::uint64_t seed = 0;
  SonarMotion motion;
  std::uint64_t world_revision = 0;  ///< 0: there is none yet

  /// Whether all that the mean echo depends on is what it was made of.
  bool fits(const PingRequest& wanted, const SonarMotion& motion_wanted, std::uint64_t revision) const;
};

}  // namespace sonard::render
