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

/// Heads on loopback where the demo has its one: 127.0.0.2 and up, status to 127.0.0.1.
DaemonConfig loopback_config(const std::vector<RecordedHead>& recorded);

/// Gives every Gemini of `config` the recorded head with its sonar ID; where both have one head, that one
/// whatever its ID. Heads without a recording are left out, with a warning, and so are poses: nothing is
/// rendered. Recorded heads that a 720i cannot send as they are, or only with wrong ranges or bearings, are
/// told about.
/// @throws LogError when nothing is left, a recorded head has images that a 720i cannot send, or the times
/// make no sense
ReplayConfig replay_config(DaemonConfig config, const std::vector<RecordedHead>& recorded,
                           const LogFile& file);

}  // namespace sonard::server
