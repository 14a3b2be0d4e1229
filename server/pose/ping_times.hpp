// SPDX-License-Identifier: Apache-2.0
// When a head pings by the clock of the source of the poses.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "server/clock/clock.hpp"
#include "server/pose/pose_history.hpp"

namespace sonard::server {

/// Counters, which only grow.
struct PingTimesCounters {
  std::uint64_t left_out = 0;  ///< by PingClock::source: the head could not keep up
  std::uint64_t unknown =
      0;  ///< the source was silent for longer than the extrapolation limit, or set its clock
  std::uint64_t lost = 0;  ///< in lock-step: the poses of the time were no longer kept
};

/// The times of one head's pings, on the publisher's clock. A ping is due one period after the last one, the
/// first one at a whole number of periods; and it may begin when every pose until its last echo is there, so
/// that no pose is extrapolated. Which pings there are, and what they show, follows from the stamps alone.
///
/// Belongs to the I/O thread; reads no clock.
class PingTimes {
 public:
  /// `poses` outlives it; its PingClock is not PingClock::wall.
  explicit PingTimes(const PoseHistory& poses) : poses_(poses) {}

  /// The transmit time of a ping that is wanted, which is then taken to begin; nullopt: its poses are not
  /// there yet. `period` > 0, `listening` >= 0.
  std::optional<TimePoint> begin(std::chrono::nanoseconds period, std::chrono::nanoseconds listening);
  /// No pings are wanted any more: the next one counts as the first.
  void rest();

  /// By how much the poses there are exceed what the next ping needs, if it is like the last one that was
  /// wanted; negative: it has to wait for poses. nullopt: no pings are wanted.
  std::optional<std::chrono::nanoseconds> lead() const;

  const PingTimesCounters& counters() const { return counters_; }

 private:
  void follow_restart();
  /// nullopt: the first ping is that of the newest pose when it is asked for.
  std::optional<TimePoint> first_of_new_life() const;
  void leave_out(std::chrono::nanoseconds period, std::chrono::nanoseconds listening);

  const PoseHistory& poses_;
  std::uint64_t restarts_ = 0;
  std::optional<TimePoint> last_;                    ///< begun
  std::optional<TimePoint> next_;                    ///< awaited
  std::chrono::nanoseconds period_{}, listening_{};  ///< of the last request
  PingTimesCounters counters_;
};

}  // namespace sonard::server
