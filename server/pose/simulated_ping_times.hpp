// SPDX-License-Identifier: Apache-2.0
// Ping times of a head in simulated time.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "server/clock/clock.hpp"
#include "server/pose/pose_history.hpp"

namespace sonard::server {

/// Counters; they only grow.
struct SimulatedPingTimesCounters {
  std::uint64_t left_out = 0;  ///< with PingClock::simulated: the head was too slow
  std::uint64_t unknown = 0;   ///< the source was silent for too long, or set its clock
  std::uint64_t lost = 0;      ///< in lock-step: the poses of that time were dropped
};

/// The times of one head's pings, on the publisher's clock. A ping is due one period after the last one, the
/// first at a whole number of periods. It can begin when every pose until its last echo has arrived, so that
/// no pose is extrapolated. The pings and their images depend only on the stamps.
///
/// Belongs to the I/O thread; reads no clock.
class SimulatedPingTimes {
 public:
  /// `poses` must outlive this object; its PingClock is not PingClock::wall.
  explicit SimulatedPingTimes(const PoseHistory& poses) : poses_(poses) {}

  /// Begins a requested ping and returns its transmit time; nullopt: its poses have not arrived yet.
  /// `period` > 0, `listening` >= 0.
  std::optional<TimePoint> begin(std::chrono::nanoseconds period, std::chrono::nanoseconds listening);
  /// No more pings are requested: the next one counts as the first.
  void rest();

  /// By how much the newest pose exceeds the need of the next ping, if it is like the last requested one.
  /// Negative: it must wait for poses. nullopt: no pings are requested.
  std::optional<std::chrono::nanoseconds> lead() const;

  const SimulatedPingTimesCounters& counters() const { return counters_; }

 private:
  void follow_restart();
  /// nullopt: the first ping is at the newest pose when it is requested.
  std::optional<TimePoint> first_of_new_life() const;
  void leave_out(std::chrono::nanoseconds period, std::chrono::nanoseconds listening);

  const PoseHistory& poses_;
  std::uint64_t restarts_ = 0;
  std::optional<TimePoint> last_;                    ///< of the last ping begun
  std::optional<TimePoint> next_;                    ///< of the awaited ping
  std::chrono::nanoseconds period_{}, listening_{};  ///< of the last request
  SimulatedPingTimesCounters counters_;
};

}  // namespace sonard::server
