// SPDX-License-Identifier: Apache-2.0
// The section `poses` of the configuration.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <vector>

#include "renderer/pose.hpp"

namespace sonard::server {

class PoseInput;

/// What a head does if the newest pose is older than the extrapolation limit.
enum class StalePolicy {
  hold,     ///< continues to ping from the last pose
  silence,  ///< sends status packets only, until a pose arrives
};

/// The clock that times the pings.
enum class PingClock {
  wall,                 ///< the time of this machine
  simulated,            ///< simulated time, the stamps of the poses; late pings are skipped to keep up
  simulated_lock_step,  ///< as `simulated`, but no ping is skipped: TCP publishers must wait
};

struct PoseConfig {
  /// T_world_vehicle until the first pose arrives. If nullopt, the heads answer but do not ping until then.
  std::optional<render::Pose> T_world_vehicle_initial;
  std::vector<std::shared_ptr<const PoseInput>> inputs;  ///< at most one of each type; not null
  /// Extrapolates this long after the newest pose with its twist (without a twist, holds the pose); >= 0.
  std::chrono::nanoseconds extrapolation_limit{std::chrono::milliseconds{500}};
  StalePolicy stale_policy = StalePolicy::hold;
  PingClock clock = PingClock::wall;
};

}  // namespace sonard::server
