// SPDX-License-Identifier: Apache-2.0
#include "server/replay/replay.hpp"

#include <utility>

#include <spdlog/spdlog.h>

#include "server/daemon/daemon.hpp"
#include "server/devices/types/types.hpp"
#include "server/replay/replay_config.hpp"

namespace sonard::server {

int replay(const std::filesystem::path& log, std::optional<DaemonConfig> config, const ReplayTiming& timing) {
  const LogFile file(log);
  const std::unique_ptr<LogReader> reader = open_log(file, &open_packet_log);
  for (const std::string& problem : reader->problems()) {
    spdlog::warn("{}: {}", log.string(), problem);
  }
  const ReplayConfig replayed = replay_config(
      config ? std::move(*config) : loopback_config(reader->heads(), file), reader->heads(), file);
  for (const PlayedHead& head : replayed.played) {
    const std::vector<std::int64_t> times_ns = head.times_ns();
    spdlog::info("head={}: replays sonar {}: {} pings of {:.1f} s", head.name, head.logged->device_id,
                 times_ns.size(), 1e-9 * static_cast<double>(times_ns.back() - times_ns.front()));
  }
  render::World world;
  world.name = log.filename().string();
  LogPlayback playback(replayed.played, timing, SteadyClock().now());
  const int code = serve(replayed.daemon, world, make_log_renderer(*reader, replayed.played), &playback);
  playback.log_totals();
  return code;
}

}  // namespace sonard::server
