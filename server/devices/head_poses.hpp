// SPDX-License-Identifier: Apache-2.0
// Times and poses of a head's pings.
#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include "protocol/common/ping_job.hpp"
#include "server/clock/clock.hpp"
#include "server/heads/head_config.hpp"
#include "server/pose/pose_history.hpp"
#include "server/pose/poses_used.hpp"
#include "server/pose/simulated_ping_times.hpp"

namespace sonard::server {

/// Belongs to the I/O thread.
class HeadPoses {
 public:
  /// @param config, history must outlive this object
  /// @param vehicle_model the body that moves with the vehicle; empty: no body does
  HeadPoses(const HeadConfig& config, const PoseHistory& history, std::string vehicle_model);

  /// True if stamps of poses time the pings.
  bool in_simulated_time() const { return ping_times_.has_value(); }
  /// In simulated time: begins `next` if its poses have arrived. Returns true if it did.
  /// @param rendering a ping of this head is being rendered
  bool begin_ping(TimePoint now, const std::optional<NextPing>& next, bool rendering);
  /// In simulated time: no client requests pings.
  void rest();
  /// Longest time between two requests of a client that requests single pings. After that, the head counts as
  /// idle.
  static constexpr std::chrono::seconds longest_pause{3};
  /// See SimulatedPingTimes::lead().
  std::optional<std::chrono::nanoseconds> lead() const;

  /// Time of the poses, on the clock of PoseHistory, of a ping transmitted at this time of the head: the time
  /// that SimulatedPingTimes returned, or else the same time.
  TimePoint pose_time(TimePoint transmit_time) const { return ping_time_.value_or(transmit_time); }

  /// The poses of a ping; for a future time, extrapolated by the twist of the newest pose. Bodies include the
  /// vehicle's model unless it is hidden. Null: there is no pose, or only a stale one that must not be used.
  std::shared_ptr<const PosesUsed> of_ping(const PingJob& job) const;
  /// The poses at a time on the clock of PoseHistory; nullopt: as null of of_ping().
  std::optional<PosesUsed> at(TimePoint time) const;
  /// PosesUsed::T_world_sonar at that time.
  std::optional<render::Pose> T_world_mount(TimePoint time) const;
  /// PosesUsed::sonar_velocity_mps at that time.
  glm::dvec3 mount_velocity_mps(TimePoint time) const;
  /// The body that the images of this head do not show; empty: they show all bodies.
  std::string hidden_body() const { return config_.hides_vehicle ? vehicle_model_ : ""; }

 private:
  void rest_when_idle(TimePoint now, bool rendering);

  const HeadConfig& config_;
  const PoseHistory& history_;
  std::string vehicle_model_;
  std::optional<SimulatedPingTimes> ping_times_;  ///< in simulated time
  std::optional<TimePoint> ping_time_;            ///< on that clock, of the ping that began last
  TimePoint last_wanted_{};                       ///< on the clock of this process
};

}  // namespace sonard::server
