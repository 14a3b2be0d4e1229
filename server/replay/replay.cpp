#include "server/replay/replay.hpp"

#include <utility>

#include <spdlog/spdlog.h>

#include "server/daemon.hpp"
#include "server/replay/replay_config.hpp"

namespace sonard::server {

int replay(const std::filesystem::path& log, std::optional<DaemonConfig> config, const ReplayTiming& timing) {
  const LogFile file(log);
  const std::unique_ptr<Recording> recording = open_recording(file);
  for (const std::string& problem : recording->problems()) {
    spdlog::warn("{}: {}", log.string(), problem);
  }
  const ReplayConfig replayed = replay_config(
      config ? std::move(*config) : loopback_config(recording->heads()), recording->heads(), file);
  for (const PlayedHead& head : replayed.played) {
    const std::vector<RecordedImage>& images = head.recorded->images;
    spdlog::info("head={} plays sonar {}: {} images of {:.1f} s", head.name, head.recorded->device_id,
                 images.size(), 1e-9 * static_cast<double>(images.back().time_ns - images.front().time_ns));
  }
  render::World world;
  world.name = log.filename().string();
  LogPlayback playback(replayed.played, timing, SteadyClock().now());
  const int code = serve(replayed.daemon, world, make_log_renderer(*recording, replayed.played), &playback);
  playback.log_totals();
  return code;
}

}  // namespace sonard::server
