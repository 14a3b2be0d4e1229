// SPDX-License-Identifier: Apache-2.0
// Where the vehicle and the moving bodies are at the transmit time of a ping.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "protocol/pose/pose_codec.hpp"
#include "renderer/pose.hpp"
#include "server/clock/clock.hpp"
#include "server/config/config.hpp"
#include "server/pose/pose_track.hpp"
#include "server/pose/posed_body.hpp"
#include "server/pose/publisher_clock.hpp"

namespace sonard::server {

/// Where a pose comes from, best first.
enum class PoseQuality {
  interpolated,  ///< between two poses, or at one
  extrapolated,  ///< past the newest pose, along its twist
  held,          ///< past the newest pose, which has no twist; or before the oldest that is kept
  initial,       ///< no pose has arrived yet: the configured one
  stale,         ///< past the extrapolation limit, under StalePolicy::hold
};

struct PoseEstimate {
  render::Pose T_world_vehicle;
  PoseQuality quality = PoseQuality::initial;
  /// Time since the newest pose, by the publisher's clock; 0 for a time before it, and for `initial`.
  std::chrono::nanoseconds age{0};
};

/// Counters, which only grow.
struct PoseHistoryCounters {
  std::uint64_t samples = 0;
  std::uint64_t late = 0;            ///< came after a newer one; still used
  std::uint64_t repeated = 0;        ///< same time stamp as one before, which they replace
  std::uint64_t too_old = 0;         ///< older than everything that is kept: dropped
  std::uint64_t clock_restarts = 0;  ///< the publisher's clock went back: simulation reset, log played again
  std::uint64_t bodies_ignored = 0;  ///< poses of bodies beyond max_bodies
};

/// One vehicle and any named bodies. Belongs to the I/O thread, which both inserts and asks, so there is no
/// lock. Reads no clock: times are arguments, in the time of the daemon.
///
/// Time stamps are the publisher's and stay so; PublisherClock tells what they mean here. A stamp more than
/// `reset_threshold` behind the newest is not a late message but a clock that was set back: everything older
/// is forgotten then. Two publishers with different clocks would make that happen at every message; it is
/// counted and logged (the 1st, 2nd, 4th, 8th ... time).
///
/// With a PingClock of the source, times asked about are the publisher's own, and PublisherClock is not
/// needed: the answers then follow from the stamps alone, whenever they came.
///
/// Before the first pose the initial one holds, without ever getting stale. Without one there is no pose.
class PoseHistory {
 public:
  explicit PoseHistory(const PoseConfig& config);

  PingClock ping_clock() const { return ping_clock_; }

  /// A message of a publisher (decode() and the trajectory parser vouch for its numbers) and when it arrived,
  /// which does not go backwards.
  void insert(const pose::PoseSample& sample, TimePoint arrival);

  /// A message with this stamp would be taken for one of a clock that was set back.
  bool would_restart(std::int64_t time_ns) const;

  /// The vehicle at a time, usually about now. nullopt: no pose yet and no initial one, or the newest is too
  /// old and the policy is `silence`.
  std::optional<PoseEstimate> at(TimePoint time) const;

  /// The time to ask at() about for what is now: `now`, or, by the clock of the source, its newest stamp.
  TimePoint present(TimePoint now) const;
  /// The publisher's time at a time that at() may be asked about; 0 before the first pose.
  std::int64_t stamp_at(TimePoint time) const;
  /// By the clock of the source: of the poses of the vehicle that are kept; nullopt: there are none.
  std::optional<TimePoint> oldest() const;
  std::optional<TimePoint> newest() const;
  /// By the clock of the source: the earliest time from `time` on at which the vehicle is known, not after
  /// its newest pose, and not in a gap that is longer than the extrapolation limit. nullopt: there is none
  /// yet.
  std::optional<TimePoint> known_from(TimePoint time) const;

  /// Every named body received since the last clock restart, at a time. Bodies have no twist: past their
  /// newest pose they rest. They never get stale.
  std::vector<PosedBody> bodies_at(TimePoint time) const;

  const PoseHistoryCounters& counters() const { return counters_; }

  static constexpr std::chrono::nanoseconds reset_threshold = std::chrono::milliseconds{250};
  /// Points kept of the vehicle, and of each body; a quarter of a second at 1 kHz. Pings look at the newest
  /// ones.
  static constexpr std::size_t vehicle_points = 256;
  static constexpr std::size_t body_points = 64;
  /// Points kept of each body with pings by the clock of the source, which come after the poses, in lock-step
  /// possibly long after: 40 s at 100 Hz.
  static constexpr std::size_t source_points = 512;
  static constexpr std::size_t lock_step_points = 4096;
  /// Whole-world pose lists of a simulator fit.
  static constexpr std::size_t max_bodies = 1024;

 private:
  void restart_if_clock_went_back(std::int64_t time_ns);
  void count(PoseTrack::Placed placed);
  void insert_body(const pose::NamedTransform& body, std::int64_t time_ns);

  std::optional<render::Pose> initial_;
  std::chrono::nanoseconds limit_;
  StalePolicy stale_policy_;
  PingClock ping_clock_;
  PublisherClock clock_;
  PoseTrack vehicle_;
  std::map<std::string, PoseTrack> bodies_;
  PoseHistoryCounters counters_;
};

}  // namespace sonard::server
