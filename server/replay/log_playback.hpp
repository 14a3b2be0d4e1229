// SPDX-License-Identifier: Apache-2.0
// Plays a recording: the next ping, differences from clients' requests, and the end.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/devices/playback.hpp"
#include "server/logs/log_reader.hpp"
#include "server/rendering/render_service.hpp"
#include "server/replay/replay_schedule.hpp"

namespace sonard::server {

/// A head of a recording that a head of the configuration plays.
struct PlayedHead {
  std::string name;
  const LoggedHead* logged = nullptr;  ///< outlives the playback; its type of device can send all of it

  std::vector<std::int64_t> times_ns() const;
};

/// All heads, by index. Belongs to the I/O thread.
class LogPlayback final : public Playback {
 public:
  /// Clients may request lost lines for so long after the last ping, or after their last request.
  static constexpr std::chrono::nanoseconds linger = std::chrono::seconds{2};

  LogPlayback(std::vector<PlayedHead> heads, const ReplayTiming& timing, TimePoint now);

  std::optional<ReplayedPing> next_ping(int index, TimePoint now) override;
  void started(int index, const PingJob& job) override;
  void progress(int index, TimePoint now, const PingProgress& done) override;
  bool finished(TimePoint now) const override;

  /// Call it once, at the end.
  void log_totals() const;

 private:
  struct Head {
    PlayedHead played;
    /// Pings that differ from the request, by kind of difference, in order of appearance.
    std::vector<std::pair<std::string, std::uint64_t>> differences{};
    std::uint64_t pings = 0;             ///< begun
    std::uint64_t ended = 0;             ///< ended pings, at the last progress()
    std::uint64_t messages = 0;          ///< at the last progress()
    std::optional<TimePoint> idle_at{};  ///< last time at which the head had data to send
  };

  Head& head(int index) { return heads_.at(static_cast<std::size_t>(index)); }
  static void count(Head& head, const Difference& difference);

  std::vector<Head> heads_;
  mutable ReplaySchedule schedule_;  ///< drops missed pings as time passes
};

/// Replaces the renderer: returns the samples of the record with the ping's number. Render thread.
RendererFactory make_log_renderer(const LogReader& reader, std::vector<PlayedHead> heads);

}  // namespace sonard::server
