// SPDX-License-Identifier: Apache-2.0
// A recording as heads play it back: which ping is next, what clients asked for instead, when it is over.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/devices/playback.hpp"
#include "server/logs/recording.hpp"
#include "server/rendering/render_service.hpp"
#include "server/replay/replay_schedule.hpp"

namespace sonard::server {

/// The head of a recording that plays the part of a head of the configuration.
struct PlayedHead {
  std::string name;
  const LoggedHead* logged = nullptr;  ///< outlives the playback; its kind of device can send all of it

  std::vector<std::int64_t> times_ns() const;
};

/// By stream. I/O thread.
class LogPlayback final : public Playback {
 public:
  /// Clients may ask for lost lines of the last ping this long after it, or after the last they asked for.
  static constexpr std::chrono::nanoseconds linger = std::chrono::seconds{2};

  LogPlayback(std::vector<PlayedHead> heads, const ReplayTiming& timing, TimePoint now);

  std::optional<RecordedPing> next_ping(int stream, TimePoint now) override;
  void started(int stream, const PingJob& job) override;
  void progress(int stream, TimePoint now, const PingProgress& done) override;
  bool finished(TimePoint now) const override;

  /// Once, at the end.
  void log_totals() const;

 private:
  struct Head {
    PlayedHead played;
    /// Pings that differ from what was asked for, by kind of difference in the order in which they came.
    std::vector<std::pair<std::string, std::uint64_t>> differences{};
    std::uint64_t pings = 0;             ///< begun
    std::uint64_t ended = 0;             ///< of those, at the last progress()
    std::uint64_t messages = 0;          ///< at the last progress()
    std::optional<TimePoint> idle_at{};  ///< last time at which the head had something to send
  };

  Head& head(int stream) { return heads_.at(static_cast<std::size_t>(stream)); }
  static void count(Head& head, const Difference& difference);

  std::vector<Head> heads_;
  mutable ReplaySchedule schedule_;  ///< forgets what is missed as time goes by
};

/// In place of the renderer: hands out the samples of the record that a ping's number names. Render thread.
RendererFactory make_log_renderer(const Recording& recording, std::vector<PlayedHead> heads);

}  // namespace sonard::server
