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
  void look(TimePoint now, TimePoint time, const NewestPing& ping, const std::vector<PosedBody>& bodies,
            bool sees_surface);
  /// A ping was not made, as no pose is known.
  void no_pose();

  const std::vector<Finding>& findings() const { return findings_; }

 private:
  void found(std::vector<Finding> findings);

  const HeadConfig& config_;
  HeadServices services_;
  std::vector<Finding> findings_;
  std::vector<BodyBox> boxes_;  ///< of the world, once they were wanted
  std::optional<bool> sees_surface_;
  TimePoint looked_at_{};
};

}  // namespace sonard::server
