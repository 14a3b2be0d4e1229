// SPDX-License-Identifier: Apache-2.0
// Which head of the network plays which head of a recording.
#pragma once

#include <vector>

#include "server/config/config.hpp"
#include "server/replay/log_playback.hpp"

namespace sonard::server {

/// What `sonard replay` serves: DaemonConfig::heads and `played` go together, one by one.
struct ReplayConfig {
  DaemonConfig daemon;
  std::vector<PlayedHead> played;
};

/// Heads on loopback where the demo has its one: 127.0.0.2 and up, first the multibeam ones, then the
/// scanning ones, each of the kind that the log names, or whose logs these are.
/// @throws LogError when a head is of no kind that is known
DaemonConfig loopback_config(const std::vector<LoggedHead>& logged, const LogFile& file);

/// Gives every head of `config` the recorded one with its name, or else with its device ID, of those that are
/// scanning as it is, or not; where both sides have one of these, that one whatever it is called. Heads
/// without a recording are left out, with a warning, and so are poses: nothing is rendered. What clients will
/// see wrongly is told.
/// @throws LogError when nothing is left, a head is to play what it cannot send, or the times make no sense
ReplayConfig replay_config(DaemonConfig config, const std::vector<LoggedHead>& logged, const LogFile& file);

}  // namespace sonard::server
