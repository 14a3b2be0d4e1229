// SPDX-License-Identifier: Apache-2.0
// What looks wrong about a head's place in the world, in its status and once in the log.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "server/clock/clock.hpp"
#include "server/config/config.hpp"
#include "server/devices/head.hpp"
#include "server/devices/head_status.hpp"
#include "server/diagnosis/finding.hpp"
#include "server/diagnosis/sight.hpp"

namespace sonard::server {

/// What a head that scans has seen within a turn. One that saw nothing in the direction of its newest ping is
/// not blind.
class LastTurn {
 public:
  /// @param ever whether it counts as seen before the first ping
  explicit LastTurn(bool ever) : ever_(ever) {}
  /// @param seen by the newest ping
  /// @return whether it was seen then, or within the last turn or minute before
  bool note(TimePoint now, double bearing_rad, bool seen);

 private:
  std::optional<TimePoint> lost_;  ///< nullopt: seen by the newest ping
  bool ever_;
  double turned_rad_ = 0.0;  ///< since
  double bearing_rad_ = 0.0;
};

/// Belongs to the I/O thread, as its head does.
class HeadDiagnosis {
 public:
  HeadDiagnosis(const HeadConfig& config, const HeadServices& services)
      : config_(config), services_(services) {}

  /// Looks around at once where what the head sees has changed, else now and then.
  /// @param ping the newest, with the pose of its mount
  /// @param time of its pose, as PoseHistory takes it
  /// @param bodies that are not where the world has them
  /// @param sees_surface PingStatistics::sees_surface
  /// @param echo_over_floor PingStatistics::echo_over_floor
  void look(TimePoint now, TimePoint time, const NewestPing& ping, const std::vector<PosedBody>& bodies,
            bool sees_surface, double echo_over_floor);
  /// A ping was not made, as no pose is known.
  void no_pose();

  const std::vector<Finding>& findings() const { return findings_; }

 private:
  void found(std::vector<Finding> findings);

  const HeadConfig& config_;
  HeadServices services_;
  std::vector<Finding> findings_;
  std::vector<BodyBox> boxes_;  ///< of the world, once they were wanted
  std::optional<bool> sees_surface_, stands_out_;
  TimePoint looked_at_{};
  LastTurn surface_seen_{false};
  LastTurn echo_seen_{true};
};

}  // namespace sonard::server
