// SPDX-License-Identifier: Apache-2.0
// `sonard check --listen`: reports what the pose inputs of a configuration receive.
#pragma once

#include <chrono>

#include "renderer/scene/world.hpp"
#include "server/config/config.hpp"

namespace sonard::server {

/// Opens the live pose inputs and listens. For each input it prints the senders, their rate, the names they
/// send, and the last pose of the vehicle, with findings about the stream. It renders a ping of each head
/// from that pose on the CPU and prints findings about the place. If an input gives no pose, it prints the
/// likely cause. Warnings of the inputs go to the log.
/// @param config with the vehicle filled in (resolve_mounts())
/// @return exit_clean if any input gave a pose of the vehicle; exit_config if no input did, or if there is no
/// live input; exit_network if an input cannot be opened
int listen_to_poses(const DaemonConfig& config, const render::World& world,
                    std::chrono::nanoseconds duration);

}  // namespace sonard::server
