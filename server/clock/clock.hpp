// SPDX-License-Identifier: Apache-2.0
// The one place where the daemon reads time.
#pragma once

#include <time.h>

#include <chrono>

namespace sonard::server {

/// Nanoseconds on the clock of this process; only differences matter, and it never goes backwards. Everything
/// in the daemon that has a time (arrival of a pose, deadline of a head, transmit time of a ping) has it
/// here.
using TimePoint = std::chrono::nanoseconds;

/// Tells the time. Components take a Clock, so a test can step time by hand. Callable from any thread.
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

/// What to add to a time of SteadyClock to have nanoseconds since the Unix epoch, as of now: the wall clock
/// may be set meanwhile.
inline std::chrono::nanoseconds unix_time_offset() {
  const TimePoint before = std::chrono::steady_clock::now().time_since_epoch();
  const auto wall = std::chrono::system_clock::now().time_since_epoch();
  const TimePoint after = std::chrono::steady_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(wall) - (before + (after - before) / 2);
}

/// Processor time that was used so far; it stands still while a thread waits, or others have the core.
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
