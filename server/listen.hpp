// SPDX-License-Identifier: Apache-2.0
// `sonard check --listen`: what arrives on the pose inputs of a configuration.
#pragma once

#include <chrono>

#include "server/config/config.hpp"

namespace sonard::server {

/// Opens the live pose inputs, listens, and prints for each of them who sends, how often, what it names, and
/// where the vehicle was last; of an input that gives no pose, what may be the cause. Their complaints go to
/// the log.
/// @param poses with the vehicle filled in (resolve_mounts())
/// @return exit_clean when a pose of the vehicle came on any of them; exit_config when none did, or no input
/// is live; exit_network when one cannot be opened
int listen_to_poses(const PoseConfig& poses, std::chrono::nanoseconds duration);

}  // namespace sonard::server
