// SPDX-License-Identifier: Apache-2.0
// Statistics of received poses: the first thing to check if an image does not move.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "protocol/pose/pose_codec.hpp"
#include "server/clock/clock.hpp"
#include "server/pose/stamp_watch.hpp"

namespace sonard::server {

/// Statistics of the poses of one source. Reads no clock; times must not go backwards. Belongs to the I/O
/// thread.
class PoseStatistics {
 public:
  struct Summary {
    std::uint64_t poses = 0;
    double rate_hz = 0.0;  ///< rate of arrival
    /// Seconds of the publisher's stamps per second of ours: 1 in real time, 0 in a pause; nullopt: fewer
    /// than two poses.
    std::optional<double> time_rate;
    std::optional<std::chrono::nanoseconds> age;  ///< since the newest arrived; nullopt: no pose has arrived
    /// Between arrivals, and from the last arrival until now.
    std::chrono::nanoseconds longest_gap{0};
    std::uint64_t gaps = 0;   ///< gaps longer than the limit
    std::uint64_t jumps = 0;  ///< steps faster than PoseTrack::teleport_mps: the vehicle was moved
    /// Stamps that went back by more than PoseHistory::reset_threshold: a reset simulation, or two
    /// publishers.
    std::uint64_t clock_restarts = 0;
    std::optional<std::chrono::nanoseconds> since_restart;  ///< since the last restart; nullopt: no restart
  };

  /// `gap_limit`: PoseConfig::extrapolation_limit.
  explicit PoseStatistics(std::chrono::nanoseconds gap_limit) : gap_limit_(gap_limit) {}

  void observe(const pose::PoseSample& sample, TimePoint arrival);

  /// Summary since the last call; the first call: since the first pose.
  Summary take(TimePoint now);
  /// Summary since the first pose.
  Summary in_all(TimePoint now) const { return summary(all_, now); }

  /// The newest pose; nullopt before the first.
  const std::optional<pose::PoseSample>& newest() const { return newest_; }
  const StampWatch& stamps() const { return stamps_; }

  /// Steps above this are slow: publishers usually send 10 poses per second or more.
  static constexpr std::chrono::milliseconds slow_step{200};
  /// Rate of a publisher whose newest steps were all slow, in poses per second; nullopt: it is not slow, or
  /// it has stopped.
  /// @param by_stamps true: per second of its stamps; false: per second of arrivals
  std::optional<double> slow_rate_hz(bool by_stamps, TimePoint now) const;

 private:
  /// The newest consecutive slow steps.
  struct SlowSteps {
    std::uint64_t count = 0;
    std::chrono::nanoseconds sum{0};

    void note(std::chrono::nanoseconds step);
  };

  struct Period {
    std::optional<TimePoint> begin;  // nullopt: before the first pose
    std::uint64_t poses = 0;
    std::int64_t stamps_ns = 0;            // sum of the steps of stamps
    std::chrono::nanoseconds arrivals{0};  // sum of the steps of arrivals
    std::chrono::nanoseconds longest_gap{0};
    std::uint64_t gaps = 0;
    std::uint64_t jumps = 0;
    std::uint64_t clock_restarts = 0;
    std::optional<TimePoint> last_restart;
  };

  void observe_step(Period& period, const pose::PoseSample& sample, TimePoint arrival) const;
  Summary summary(const Period& period, TimePoint now) const;

  std::chrono::nanoseconds gap_limit_;
  std::optional<pose::PoseSample> newest_;
  TimePoint newest_arrival_{};
  Period recent_, all_;
  StampWatch stamps_;
  SlowSteps slow_arrivals_, slow_stamps_;
};

/// "poses=500 rate_hz=50.0 time_rate=1.00 age_ms=12 longest_gap_ms=34 gaps=0 jumps=0 clock_restarts=0";
/// unknown values are "-".
std::string to_string(const PoseStatistics::Summary& summary);

}  // namespace sonard::server
