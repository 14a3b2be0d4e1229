// SPDX-License-Identifier: Apache-2.0
// Configuration values that come from the world: mounts of heads, and which model is the vehicle.
#pragma once

#include <vector>

#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"
#include "server/yaml/config_error.hpp"

namespace sonard::server {

/// Fills in the mounts of heads that are mounted from the world, the vehicle's model if it follows from
/// these, and the values that pose inputs need of the world (PoseInput::in_world()). The vehicle frame is
/// then the frame of that model.
/// @return the problems, without their places; empty if all is filled in
std::vector<ConfigProblem> resolve_mounts(DaemonConfig& config, const render::World& world);

}  // namespace sonard::server
