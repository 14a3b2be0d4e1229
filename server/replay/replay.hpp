// SPDX-License-Identifier: Apache-2.0
// `sonard replay`: serves a recording as the device that made it.
#pragma once

#include <optional>

#include "server/config/config.hpp"
#include "server/replay/replay_schedule.hpp"

namespace sonard::server {

/// Serves until the last ping is sent or a signal arrives.
/// @param config addresses and timing of the heads; nullopt: on loopback
/// @return exit code of serve()
/// @throws Error, Error
int replay(const std::filesystem::path& log, std::optional<DaemonConfig> config, const ReplayTiming& timing);

}  // namespace sonard::server
