// SPDX-License-Identifier: Apache-2.0
// The only place where the daemon reads time.
#pragma once

#include <time.h>

#include <chrono>

namespace sonard::server {

/// Nanoseconds on the monotonic clock of this process; only differences matter. All times in the daemon use
/// it: arrival of a pose, deadline of a head, transmit time of a ping.
using TimePoint = std::chrono::nanoseconds;

/// Source of time. Components take a Clock, so that a test can step time. Can be called from any thread.
class Clock {
 public:
  virtual ~Clock() = default;
  virtual TimePoint now() const = 0;
};

/// Real time: std::chrono::steady_clock, which is also the clock of Asio's steady_timer.
class SteadyClock final : public Clock {
 public:
  TimePoint now() const override { return std::chrono::steady_clock::now().time_since_epoch(); }
};

/// Offset from SteadyClock to nanoseconds since the Unix epoch, as of now: the wall clock may be set later.
inline std::chrono::nanoseconds unix_time_offset() {
  const TimePoint before = std::chrono::steady_clock::now().time_since_epoch();
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const TimePoint after = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(wall) - (before + (after - before) / 2);
}

/// Processor time used so far; it does not include waiting.
struct ProcessorTime {
  std::chrono::nanoseconds thread{};   ///< by the calling thread
  std::chrono::nanoseconds process{};  ///< by all threads
};

inline ProcessorTime processor_time() {
  const auto read = [](clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return std::chrono::seconds{time.tv_sec} + std::chrono::nanoseconds{time.tv_nsec};
  };
  return {read(CLOCK_THREAD_CPUTIME_ID), read(CLOCK_PROCESS_CPUTIME_ID)};
}

/// Converts to the time type of an Asio steady_timer.
inline std::chrono::steady_clock::time_point to_steady(TimePoint time) {
  return std::chrono::steady_clock::time_point{time};
}

}  // namespace sonard::server
