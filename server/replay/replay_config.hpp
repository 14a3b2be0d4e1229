// SPDX-License-Identifier: Apache-2.0
// Maps heads of the network to heads of a recording.
#pragma once

#include <vector>

#include "server/config/config.hpp"
#include "server/replay/log_playback.hpp"

namespace sonard::server {

/// Configuration of `sonard replay`: DaemonConfig::heads and `played` have the same order and size.
struct ReplayConfig {
  DaemonConfig daemon;
  std::vector<PlayedHead> played;
};

/// Heads on loopback, from 127.0.0.2 up: first the multibeam heads, then the scanning ones. The log gives
/// their type, by name or by its format.
/// @throws Error if a head is of an unknown type
DaemonConfig loopback_config(const std::vector<LoggedHead>& logged, const LogFile& file);

/// Gives every head of `config` the recorded head with its name, or else with its device ID, among the heads
/// that are scanning, or not, as it is. If `config` has only one head of that sort and so has the recording,
/// the two match whatever their names. Heads without a recording are left out, with a warning. Poses are left
/// out, because nothing is rendered. Errors that clients will see are logged.
/// @throws Error if no head is left, a head cannot send its recording, or the times span too long
ReplayConfig replay_config(DaemonConfig config, const std::vector<LoggedHead>& logged, const LogFile& file);

}  // namespace sonard::server
