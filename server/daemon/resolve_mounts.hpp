// SPDX-License-Identifier: Apache-2.0
// Configuration values that come from the world: mounts of heads, and which model is the vehicle.
#pragma once

#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"

namespace sonard::server {

/// A configuration key that the world cannot resolve.
struct WorldProblem {
  std::string key;  ///< "heads[0].mount.from_world"
  std::string message;
};

/// Fills in the mounts of heads that are mounted from the world, the vehicle's model if it follows from
/// these, and the Gazebo entity that carries the sonars if only the model names it. The vehicle frame is then
/// the frame of that model.
/// @return the problems; empty if all is filled in
std::vector<WorldProblem> resolve_mounts(DaemonConfig& config, const render::World& world);

}  // namespace sonard::server
