// SPDX-License-Identifier: Apache-2.0
// Runs a head in virtual time: a stand-in renderer makes pings, and clients come and go.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "protocol/common/device.hpp"
#include "tests/soak/visitor.hpp"

namespace sonard::soak {

/// Runs a head and its visitors, and throws at the first error:
/// * a ping must have the samples rendered for it, and its stamp must be the time of its request;
/// * pings of one visit must follow each other by number, or by angle, across wraps;
/// * they must keep their period to the nanosecond, so that nothing drifts;
/// * jobs must be numbered 0, 1, 2, ..., records must have the time of their job, wake-ups must be in the
/// future. Every 997th image cannot be rendered. Not thread-safe.
class Soak {
 public:
  explicit Soak(HeadUnderSoak& head);

  /// Runs until visitors have this many pings in total. @throws std::runtime_error with the time and the
  /// error
  void run_until(std::uint64_t pings);

  std::uint64_t pings() const { return pings_; }
  std::uint64_t visits() const { return visits_; }
  TimePoint now() const { return now_; }

 private:
  struct Work {
    PingJob job;
    TimePoint done{};
    bool wanted = true;
  };
  /// A job whose image was passed to the head.
  struct Rendered {
    std::uint64_t number = 0;
    TimePoint transmit_time{};
    std::vector<std::uint8_t> samples;
  };

  void advance();
  void step(const Event& event);
  void answer();
  void check_job(const PingJob& job) const;
  void come();
  void leave();
  void see(const SeenPing& ping);

  HeadUnderSoak& head_;
  TimePoint now_{};
  std::optional<TimePoint> wake_at_{TimePoint{}};
  std::optional<Work> work_;
  std::uint64_t next_job_ = 0;
  Rendered rendered_;

  std::unique_ptr<Visitor> visitor_;
  TimePoint next_visit_{};
  std::uint64_t visits_ = 0;
  std::uint64_t seen_in_visit_ = 0;
  std::uint64_t pings_ = 0;
  std::optional<SeenPing> last_seen_;  ///< nullopt: the next ping need not follow
  TimePoint last_transmit_{};
};

}  // namespace sonard::soak
