// SPDX-License-Identifier: Apache-2.0
// Diagnosis of a head's place in the world, for its status and, once, the log.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/devices/head_status.hpp"
#include "server/diagnosis/finding.hpp"
#include "server/diagnosis/sight.hpp"
#include "server/heads/head_config.hpp"
#include "server/pose/pose_history.hpp"
#include "server/pose/poses_used.hpp"

namespace sonard::server {

/// Tracks whether a scanning head has seen something within the last turn: it is not blind just because its
/// newest ping saw nothing.
class LastTurn {
 public:
  /// @param ever true if it counts as seen before the first ping
  explicit LastTurn(bool ever) : ever_(ever) {}
  /// @param seen true if the newest ping saw it
  /// @return true if it was seen by this ping, or within the last turn or minute
  bool note(TimePoint now, double bearing_rad, bool seen);

 private:
  std::optional<TimePoint> lost_;  ///< nullopt: seen by the newest ping
  bool ever_;
  double turned_rad_ = 0.0;  ///< since it was lost
  double bearing_rad_ = 0.0;
};

/// Belongs to the I/O thread.
class HeadDiagnosis {
 public:
  /// @param config, history, world must outlive this object
  /// @param vehicle_model the body that moves with the vehicle; empty: no body does
  /// @param world null: nothing is looked at
  HeadDiagnosis(const HeadConfig& config, const PoseHistory& history, std::string vehicle_model,
                const render::World* world)
      : config_(config), history_(history), vehicle_model_(std::move(vehicle_model)), world_(world) {}

  /// Looks around at once if the head's view has changed, else every few seconds.
  /// @param ping the newest
  /// @param poses of this ping
  /// @param sees_surface PingStatistics::sees_surface
  /// @param echo_over_floor PingStatistics::echo_over_floor
  void look(TimePoint now, const NewestPing& ping, const PosesUsed& poses, bool sees_surface,
            double echo_over_floor);
  /// Called if a ping was not made, or waits, because no pose is known.
  /// @param time of the ping, on the clock of PoseHistory
  void no_pose(TimePoint time);

  /// Called if a client's command was for another head.
  /// @param what Actions::misaddressed
  void misaddressed(TimePoint now, std::string what) { misaddressed_ = Misaddressed{now, std::move(what)}; }

  /// The current findings; without those of no_pose() if a pose has arrived since.
  std::vector<Finding> findings(TimePoint now) const;

 private:
  bool has_pose(TimePoint now) const;
  void found(std::vector<Finding> findings);

  struct Misaddressed {
    TimePoint at{};
    std::string what;
  };

  const HeadConfig& config_;
  const PoseHistory& history_;
  const std::string vehicle_model_;
  const render::World* const world_;
  std::vector<Finding> findings_;
  std::optional<Misaddressed> misaddressed_;  ///< the newest command for another head
  std::vector<BodyBox> boxes_;                ///< of the world, once they are needed
  std::optional<bool> sees_surface_, stands_out_;
  TimePoint looked_at_{};
  LastTurn surface_seen_{false};
  LastTurn echo_seen_{true};
};

}  // namespace sonard::server
