// SPDX-License-Identifier: Apache-2.0
// Poses of the vehicle and the moving bodies at the transmit time of a ping.
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
#include "server/pose/pose_config.hpp"
#include "server/pose/pose_track.hpp"
#include "server/pose/posed_body.hpp"
#include "server/pose/publisher_clock.hpp"

namespace sonard::server {

/// Quality of a pose, best first.
enum class PoseQuality {
  interpolated,  ///< between two poses, or at one
  extrapolated,  ///< past the newest pose, along its twist
  held,          ///< past the newest pose, which has no twist; or before the oldest kept pose
  initial,       ///< the configured initial pose; no pose has arrived yet
  stale,         ///< past the extrapolation limit, with StalePolicy::hold
};

struct PoseEstimate {
  render::Pose T_world_vehicle;
  PoseQuality quality = PoseQuality::initial;
  /// Time since the newest pose, on the publisher's clock; 0 for an earlier time, and for `initial`.
  std::chrono::nanoseconds age{0};
};

/// A newest pose that pings must not use, because of StalePolicy::silence.
struct StalePose {
  std::chrono::nanoseconds age{0};    ///< on the publisher's clock
  std::chrono::nanoseconds limit{0};  ///< PoseConfig::extrapolation_limit
};
/// "the pose is stale: the newest one is 2.0 s old, and poses.extrapolation_limit_ms allows 500 ms"
std::string stale_text(const StalePose& pose);

/// Counters; they only grow.
struct PoseHistoryCounters {
  std::uint64_t samples = 0;
  std::uint64_t late = 0;            ///< arrived after a newer one; still used
  std::uint64_t repeated = 0;        ///< same time stamp as an earlier one; replaces it
  std::uint64_t too_old = 0;         ///< older than every kept pose: dropped
  std::uint64_t clock_restarts = 0;  ///< the publisher's clock went back: simulation reset, log replayed
  std::uint64_t bodies_ignored = 0;  ///< poses of bodies beyond max_bodies
};

/// The vehicle and any named bodies. Belongs to the I/O thread, so there is no lock. Reads no clock: times
/// are arguments, on the daemon's clock.
///
/// Stamps stay on the publisher's clock; PublisherClock converts times. A stamp more than `reset_threshold`
/// behind the newest is not late: the clock was set back, and all older poses are dropped. Two publishers
/// with different clocks cause this at every message. It is counted and logged (the 1st, 2nd, 4th, 8th ...
/// time).
///
/// In simulated time, time arguments are on the publisher's clock and PublisherClock is not used. Results
/// then depend only on the stamps, not on arrival times.
///
/// Before the first pose, the configured initial pose holds and is never stale. Without it there is no pose.
class PoseHistory {
 public:
  explicit PoseHistory(const PoseConfig& config);

  PingClock ping_clock() const { return ping_clock_; }

  /// Adds a message of a publisher, checked by decode() or the trajectory parser. `arrival` must not go
  /// backwards.
  void insert(const pose::PoseSample& sample, TimePoint arrival);

  /// True if insert() would take this stamp as a clock that was set back.
  bool would_restart(std::int64_t time_ns) const;

  /// The vehicle at a time, usually about now. nullopt: no pose has arrived and there is no initial one, or
  /// the newest is too old and the policy is `silence`.
  std::optional<PoseEstimate> at(TimePoint time) const;

  /// The vehicle's twist at a time for which at() has a pose, in its own frame; see PoseTrack::twist_at().
  /// Zero before the first pose.
  pose::Velocity twist_at(TimePoint time) const;

  /// The newest pose if at() refuses it because it is too old.
  std::optional<StalePose> stale_at(TimePoint time) const;

  /// The argument of at() for the present: `now`; in simulated time the newest stamp.
  TimePoint present(TimePoint now) const;
  /// The publisher's time at a time of at(); 0 before the first pose.
  std::int64_t stamp_at(TimePoint time) const;
  /// In simulated time: times of the kept poses of the vehicle; nullopt if there are no poses.
  std::optional<TimePoint> oldest() const;
  std::optional<TimePoint> newest() const;
  /// In simulated time: the earliest time, from `time` on, at which the vehicle is known: not after
  /// its newest pose, and not in a gap longer than the extrapolation limit. nullopt: not yet known.
  std::optional<TimePoint> known_from(TimePoint time) const;

  /// All named bodies received since the last clock restart, at a time. Past its newest pose a body follows
  /// its twist, if it has one, until the extrapolation limit, and then stays there. It is never stale.
  std::vector<PosedBody> bodies_at(TimePoint time) const;

  const PoseHistoryCounters& counters() const { return counters_; }

  static constexpr std::chrono::nanoseconds reset_threshold = std::chrono::milliseconds{250};
  /// Kept points of the vehicle and of each body; 256 are a quarter of a second at 1 kHz. Pings use the
  /// newest ones.
  static constexpr std::size_t vehicle_points = 256;
  static constexpr std::size_t body_points = 64;
  /// Kept points of the vehicle and of each body in simulated time. Pings then come after
  /// the poses, in lock-step possibly long after: 40 s at 100 Hz.
  static constexpr std::size_t simulated_points = 512;
  static constexpr std::size_t lock_step_points = 4096;
  /// Enough for whole-world pose lists of a simulator.
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
