// SPDX-License-Identifier: Apache-2.0
// Spaces the datagrams of pings on the wire (docs/protocols/gemini.md 8.5, 3.6, 7.7).
#pragma once

#include <algorithm>
#include <chrono>

#include "protocol/gemini/device_config.hpp"

namespace sonard::gemini {

/// A leaky bucket: datagrams leave at one per period on average, and a few of them may leave back to back.
/// The allowance for that is what a real head does not need but a caller on a host does, whose timers are
/// coarser than 27 us and sometimes late. In any span of time t no more than burst + t / period datagrams
/// leave.
///
/// Being late therefore costs nothing up to about half a burst (the caller wakes up once per half a burst,
/// see wake_batch()), and beyond that it delays the rest of the ping by as much: the 100 Mbit/s link of a
/// real head could not make up for it either.
///
/// The interPacketGap of the topside is a least distance, not an average: when it is long enough to matter,
/// datagrams leave one by one.
class Pacer {
 public:
  Pacer(std::chrono::nanoseconds period, int burst) : configured_period_(period), configured_burst_(burst) {
    set_gap({});
  }

  /// Least distance as asked for by the topside. A host needs a few microseconds to hand over a datagram, so
  /// shorter gaps are met within a burst.
  void set_gap(std::chrono::nanoseconds gap) {
    period_ = std::max(configured_period_, gap);
    burst_ = gap > std::chrono::microseconds{5} ? 1 : configured_burst_;
  }

  /// When `count` datagrams can leave, the last of them at that time and the others then or before.
  TimePoint earliest(int count) const { return next_ + (count - burst_) * period_; }
  /// One may leave now.
  bool ready(TimePoint now) const { return now >= earliest(1); }
  /// One left at `now`.
  void sent(TimePoint now) { next_ = std::max(next_, now) + period_; }

  /// Datagrams worth waking up for when there are many: half a burst, so that the other half absorbs
  /// lateness.
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
