// SPDX-License-Identifier: Apache-2.0
// Due times of the pings of a recording. Pure: time is an argument.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "server/clock/clock.hpp"

namespace sonard::server {

struct ReplayTiming {
  double speed = 1.0;      ///< > 0; 2: twice as fast as recorded
  bool as_asked = false;   ///< ignores recorded times: one ping per request of a client
  bool loop = false;       ///< restarts after the last ping; a recording of one ping lasts a second
  bool start_now = false;  ///< the clock starts at once, with or without clients; else with the first ping
};

/// Keeps the heads of a recording in step.
///
/// The clock starts at the first ping that a client requests, and waits for clients: a ping requested late is
/// sent late, and the next ones catch up. If a ping was more than `most_behind` late, the clock shifts by
/// that time, so nothing is left out. With `start_now` the clock runs without clients too. A ping is then
/// skipped if no client requests it before the next one is due, or within `most_behind`.
class ReplaySchedule {
 public:
  static constexpr std::chrono::nanoseconds most_behind = std::chrono::seconds{1};

  struct Ping {
    std::size_t image = 0;         ///< index into the head's times
    std::optional<TimePoint> due;  ///< nullopt: as soon as a client requests it
  };

  /// @param times_ns of each head, in rising order, within 90 days; every head has a ping
  /// @param now start of the clock, for ReplayTiming::start_now
  ReplaySchedule(std::vector<std::vector<std::int64_t>> times_ns, const ReplayTiming& timing, TimePoint now);

  /// The next ping at `now`; nullopt: the last one was started or skipped.
  std::optional<Ping> next(std::size_t head, TimePoint now);
  /// Call it when the ping of next() leaves, at `transmit_time`.
  void started(std::size_t head, TimePoint transmit_time);

  /// True if no head has pings left at `now`.
  bool over(TimePoint now);
  std::uint64_t skipped() const { return skipped_; }

 private:
  struct Head {
    std::vector<std::chrono::nanoseconds> offsets;  ///< from the first ping of all heads
    std::size_t next = 0;                           ///< keeps counting over laps
  };

  bool has_next(const Head& head) const { return timing_.loop || head.next < head.offsets.size(); }
  TimePoint due(const Head& head, std::size_t ping) const;
  void skip_missed(Head& head, TimePoint now);

  ReplayTiming timing_;
  std::vector<Head> heads_;
  std::chrono::nanoseconds lap_{};  ///< at recorded speed
  std::optional<TimePoint> start_;
  std::uint64_t skipped_ = 0;
};

}  // namespace sonard::server
