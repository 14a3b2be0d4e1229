// SPDX-License-Identifier: Apache-2.0
// Spaces the datagrams of pings on the wire (protocol/gemini/README.md 8.5, 3.6, 7.7).
#pragma once

#include <algorithm>
#include <chrono>

#include "protocol/gemini/device_config.hpp"

namespace sonard::gemini {

/// A leaky bucket: on average one datagram leaves per period, and a few may leave back to back. In any time t
/// at most burst + t / period datagrams leave. The burst exists because timers of a host are coarser than
/// 27 us and sometimes late; a real head does not need it.
///
/// A delay of up to about half a burst costs nothing: the caller wakes up once per half a burst, see
/// wake_batch(). A longer delay delays the rest of the ping by as much, because the 100 Mbit/s link of a real
/// head could not catch up either.
///
/// The interPacketGap of the client is a minimum time, not an average. If it exceeds 5 us, datagrams leave
/// one by one.
class Pacer {
 public:
  Pacer(std::chrono::nanoseconds period, int burst) : configured_period_(period), configured_burst_(burst) {
    set_gap({});
  }

  /// Sets the minimum time between datagrams that the client requests. A host needs a few microseconds per
  /// datagram, so a burst observes shorter gaps anyway.
  void set_gap(std::chrono::nanoseconds gap) {
    period_ = std::max(configured_period_, gap);
    burst_ = gap > std::chrono::microseconds{5} ? 1 : configured_burst_;
  }

  /// Earliest time by which `count` datagrams can have left.
  TimePoint earliest(int count) const { return next_ + (count - burst_) * period_; }
  /// True if a datagram may leave now.
  bool ready(TimePoint now) const { return now >= earliest(1); }
  /// Records that a datagram left at `now`.
  void sent(TimePoint now) { next_ = std::max(next_, now) + period_; }

  /// Number of datagrams to collect before a wake-up: half a burst, so that the other half absorbs delays.
  int wake_batch() const { return std::max(1, burst_ / 2); }

 private:
  std::chrono::nanoseconds configured_period_;
  int configured_burst_;
  std::chrono::nanoseconds period_{};
  int burst_ = 1;
  /// When the next datagram would leave if all kept the period exactly. Far in the past: the line is free.
  TimePoint next_ = TimePoint::min() / 2;
};

}  // namespace sonard::gemini
