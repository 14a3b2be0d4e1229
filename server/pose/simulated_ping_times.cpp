// SPDX-License-Identifier: Apache-2.0
#include "server/pose/simulated_ping_times.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <bit>
#include <utility>

namespace sonard::server {
namespace {

using std::chrono::nanoseconds;

// Logs the 1st, 2nd, 4th, 8th ... time.
void note(std::uint64_t& count, std::uint64_t more, const char* reason) {
  const std::uint64_t before = std::exchange(count, count + more);
  if (std::bit_width(before) != std::bit_width(count)) {
    spdlog::warn("pose stream: pings skipped: {} ({} so far)", reason, count);
  }
}

// Rounds up, for either sign.
nanoseconds whole_periods(nanoseconds way, nanoseconds period) {
  const auto whole = way / period;
  return (whole + (way > whole * period ? 1 : 0)) * period;
}

}  // namespace

std::optional<TimePoint> SimulatedPingTimes::begin(nanoseconds period, nanoseconds listening) {
  follow_restart();
  period_ = period;
  listening_ = listening;
  const auto newest = poses_.newest();
  if (!newest) {
    return std::nullopt;
  }
  if (last_) {
    next_ = *last_ + period;
  } else if (!next_) {
    next_ = whole_periods(*newest, period);
  }
  leave_out(period, listening);
  if (*next_ + listening > *newest) {
    return std::nullopt;
  }
  last_ = next_;
  next_.reset();
  return last_;
}

void SimulatedPingTimes::leave_out(nanoseconds period, nanoseconds listening) {
  const auto skip_to = [&](TimePoint time) {
    const nanoseconds way = whole_periods(time - *next_, period);
    *next_ += way;
    if (last_) {
      *last_ += way;
    }
    return static_cast<std::uint64_t>(way / period);
  };
  const TimePoint newest = *poses_.newest();
  if (const TimePoint oldest = *poses_.oldest(); *next_ < oldest) {
    note(counters_.lost, skip_to(oldest), "too many newer poses arrived before they were rendered");
  }
  if (poses_.ping_clock() == PingClock::simulated && *next_ + listening + period <= newest) {
    // Skips to the last ping that can begin.
    counters_.left_out += skip_to(newest - listening - period + nanoseconds{1});
  }
  for (auto known = poses_.known_from(*next_); known && *known > *next_; known = poses_.known_from(*next_)) {
    note(counters_.unknown, skip_to(*known),
         "the nearest poses are further apart than poses.extrapolation_limit_ms");
  }
}

void SimulatedPingTimes::follow_restart() {
  if (restarts_ != poses_.counters().clock_restarts) {
    const std::optional<TimePoint> first = first_of_new_life();
    restarts_ = poses_.counters().clock_restarts;
    rest();
    next_ = first;
  }
}

// In lock-step this depends only on the stamps, not on how long the head is busy with its last ping.
std::optional<TimePoint> SimulatedPingTimes::first_of_new_life() const {
  const auto oldest = poses_.oldest();
  const bool wanted = next_ || last_;
  if (!wanted || !oldest || poses_.ping_clock() != PingClock::simulated_lock_step) {
    return std::nullopt;
  }
  return whole_periods(*oldest, period_);
}

void SimulatedPingTimes::rest() {
  last_.reset();
  next_.reset();
}

std::optional<nanoseconds> SimulatedPingTimes::lead() const {
  const auto newest = poses_.newest();
  const bool of_this_clock = restarts_ == poses_.counters().clock_restarts;
  const auto next = !of_this_clock ? first_of_new_life() : last_ ? std::optional{*last_ + period_} : next_;
  if (!newest || !next) {
    return std::nullopt;
  }
  return *newest - listening_ - *next;
}

}  // namespace sonard::server
