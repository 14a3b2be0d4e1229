// SPDX-License-Identifier: Apache-2.0
// What a configuration leaves to its world: mounts of heads, and which model is the vehicle.
#pragma once

#include <string>
#include <vector>

#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"

namespace sonard::server {

/// A key of the configuration that the world has no answer to.
struct WorldProblem {
  std::string key;  ///< "heads[0].mount.from_world"
  std::string message;
};

/// Fills in the mounts of heads that are mounted from the world, the vehicle's model where it follows from
/// these, and the entity of Gazebo that carries the sonars where only the model says it. The frame of the
/// vehicle is then the frame of that model.
/// @return what is wrong; nothing when all is filled in
std::vector<WorldProblem> resolve_mounts(DaemonConfig& config, const render::World& world);

}  // namespace sonard::server
