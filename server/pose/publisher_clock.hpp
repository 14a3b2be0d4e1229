// SPDX-License-Identifier: Apache-2.0
// What time it is at the publisher of the poses, told from its time stamps and when they arrived.
#pragma once

#include <chrono>
#include <cstdint>

#include "server/clock/clock.hpp"

namespace sonard::server {

/// Maps our time to the publisher's. Each message gives an offset, arrival minus stamp: the true offset of
/// the two clocks plus the time the message was under way. The smallest offset of the last seconds comes
/// nearest to the truth, and keeps jitter of the network out of the poses.
///
/// A publisher whose clock runs slow (a simulation below real time) or stands still (paused) lets the offsets
/// grow for ever; therefore a message is never believed to have been under way for longer than
/// `longest_delay`. A clock that runs fast needs no rule: its newest offset is the smallest.
class PublisherClock {
 public:
  /// `longest_delay` >= 0.
  explicit PublisherClock(std::chrono::nanoseconds longest_delay);

  /// A message. `arrival` does not go backwards.
  void observe(std::int64_t stamp_ns, TimePoint arrival);
  /// Forgets everything: the publisher's clock was set.
  void restart();

  /// The publisher's time at `local`; needs a message observed since the last restart.
  std::int64_t stamp_at(TimePoint local) const;

 private:
  // The minimum runs over this half window and the one before it: between one and two seconds.
  static constexpr std::chrono::nanoseconds half_window = std::chrono::seconds{1};

  std::chrono::nanoseconds longest_delay_;
  bool empty_ = true;
  TimePoint half_start_{};
  std::int64_t least_offset_ns_ = 0;         // in the present half window
  std::int64_t least_offset_before_ns_ = 0;  // in the half window before
  std::int64_t newest_stamp_ns_ = 0;
  std::int64_t newest_offset_ns_ = 0;  // of the message with the newest stamp
};

}  // namespace sonard::server
