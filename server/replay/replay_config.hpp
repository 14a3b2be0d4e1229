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

/// Heads on loopback where the demo has its one: 127.0.0.2 and up, first the Geminis, whose status goes to
/// 127.0.0.1, then the Microns, each on TCP port 4001.
DaemonConfig loopback_config(const std::vector<RecordedHead>& heads, const std::vector<RecordedScan>& scans);

/// Gives every Gemini of `config` the recorded head with its sonar ID, and every Micron the recorded scan
/// with its name, or else with its node; where both sides have one of a kind, that one whatever it is called.
/// Heads without a recording are left out, with a warning, and so are poses: nothing is rendered. Recorded
/// heads that a 720i cannot send as they are, or only with wrong ranges or bearings, are told about.
/// @throws LogError when nothing is left, a head is to play what cannot be sent, or the times make no sense
ReplayConfig replay_config(DaemonConfig config, const std::vector<RecordedHead>& heads,
                           const std::vector<RecordedScan>& scans, const LogFile& file);

}  // namespace sonard::server
