// SPDX-License-Identifier: Apache-2.0
// Estimates the publisher's time from its stamps and their arrival times.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/clock/clock.hpp"

namespace sonard::server {

/// Maps our time to the publisher's. Each message gives an offset, arrival minus stamp: the offset of the two
/// clocks plus the message's delay. The smallest offset of the last seconds is the best estimate, and keeps
/// network jitter out of the poses.
///
/// If the publisher's clock is slow (a simulation below real time) or stopped (paused), offsets grow without
/// limit. Therefore a message's delay is assumed to be at most `longest_delay`. A fast clock needs no rule:
/// its newest offset is the smallest.
class PublisherClock {
 public:
  /// `longest_delay` >= 0.
  explicit PublisherClock(std::chrono::nanoseconds longest_delay);

  /// Adds a message. `arrival` must not go backwards.
  void observe(std::int64_t stamp_ns, TimePoint arrival);
  /// Forgets all messages: the publisher's clock was set.
  void restart();

  /// The publisher's time at `local`; requires a message since the last restart.
  std::int64_t stamp_at(TimePoint local) const;

 private:
  // The minimum runs over this half window and the one before it: between one and two seconds.
  static constexpr std::chrono::nanoseconds half_window = std::chrono::seconds{1};

  std::chrono::nanoseconds longest_delay_;
  bool empty_ = true;
  TimePoint half_start_{};
  std::int64_t least_offset_ns_ = 0;         // in the current half window
  std::int64_t least_offset_before_ns_ = 0;  // in the previous half window
  std::int64_t newest_stamp_ns_ = 0;
  std::int64_t newest_offset_ns_ = 0;  // of the message with the newest stamp
};

}  // namespace sonard::server
