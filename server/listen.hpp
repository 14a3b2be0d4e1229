// SPDX-License-Identifier: Apache-2.0
// `sonard check --listen`: what arrives on the pose inputs of a configuration.
#pragma once

#include <chrono>

#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"

namespace sonard::server {

/// Opens the live pose inputs, listens, and prints for each of them who sends, how often, what it names, and
/// where the vehicle was last, with what looks wrong about the stream and, by a ping of each head rendered
/// from there on the CPU, about the place; of an input that gives no pose, what may be the cause. Complaints
/// of the inputs go to the log.
/// @param config with the vehicle filled in (resolve_mounts())
/// @return exit_clean when a pose of the vehicle came on any of them; exit_config when none did, or no input
/// is live; exit_network when one cannot be opened
int listen_to_poses(const DaemonConfig& config, const render::World& world,
                    std::chrono::nanoseconds duration);

}  // namespace sonard::server
