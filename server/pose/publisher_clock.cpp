// SPDX-License-Identifier: Apache-2.0
#include "server/pose/publisher_clock.hpp"

#include <algorithm>

namespace sonard::server {

PublisherClock::PublisherClock(std::chrono::nanoseconds longest_delay) : longest_delay_(longest_delay) {}

void PublisherClock::observe(std::int64_t stamp_ns, TimePoint arrival) {
  const std::int64_t offset_ns = arrival.count() - stamp_ns;
  const std::chrono::nanoseconds since_start = arrival - half_start_;
  if (empty_ || since_start >= 2 * half_window) {
    half_start_ = arrival;
    least_offset_before_ns_ = least_offset_ns_ = offset_ns;
  } else if (since_start >= half_window) {
    half_start_ += half_window;
    least_offset_before_ns_ = least_offset_ns_;
    least_offset_ns_ = offset_ns;
  } else {
    least_offset_ns_ = std::min(least_offset_ns_, offset_ns);
  }
  // A late message does not show how far the clock has advanced.
  if (empty_ || stamp_ns >= newest_stamp_ns_) {
    newest_stamp_ns_ = stamp_ns;
    newest_offset_ns_ = offset_ns;
  }
  empty_ = false;
}

void PublisherClock::restart() {
  empty_ = true;
}

std::int64_t PublisherClock::stamp_at(TimePoint local) const {
  const std::int64_t least_ns = std::min(least_offset_ns_, least_offset_before_ns_);
  return local.count() - std::max(least_ns, newest_offset_ns_ - longest_delay_.count());
}

}  // namespace sonard::server
