// SPDX-License-Identifier: Apache-2.0
// A head in virtual time for as long as it takes: pings from a stand-in renderer, and clients that come and
// go.
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

/// Runs a head and its visitors, and throws at the first thing that is wrong:
/// * a ping has the samples that were rendered for it, and its stamp is when it was asked for;
/// * pings of one visit follow each other by number, or where the head looks, whatever wraps in between;
/// * they keep their period to the nanosecond, so nothing drifts;
/// * jobs are numbered 0, 1, 2, ..., records have the time of their job, and a wake-up lies in the future.
/// Every 997th image cannot be rendered. Not thread-safe.
class Soak {
 public:
  explicit Soak(HeadUnderSoak& head);

  /// Until visitors have this many pings, over all calls. @throws std::runtime_error saying when and what is
  /// wrong
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
  /// A job whose image the head was given.
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
  std::optional<SeenPing> last_seen_;  ///< nullopt: the next one need not follow it
  TimePoint last_transmit_{};
};

}  // namespace sonard::soak
