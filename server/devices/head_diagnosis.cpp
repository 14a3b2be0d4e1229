// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head_diagnosis.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <spdlog/spdlog.h>

#include "server/devices/device_kind.hpp"
#include "server/pose/pose_history.hpp"

namespace sonard::server {
namespace {

// All boxes of a world are looked at, and where nothing is seen also triangles.
constexpr std::chrono::seconds while_seeing{5};
constexpr std::chrono::seconds while_blind{1};

}  // namespace

void HeadDiagnosis::look(TimePoint now, TimePoint time, const NewestPing& ping,
                         const std::vector<PosedBody>& bodies, bool sees_surface) {
  const std::optional<PoseEstimate> vehicle = services_.poses.at(time);
  const bool as_before = std::exchange(sees_surface_, sees_surface) == sees_surface;
  const auto period = sees_surface ? while_seeing : while_blind;
  if (services_.world == nullptr || !vehicle || !ping.T_world_mount ||
      (as_before && now - looked_at_ < period)) {
    return;
  }
  looked_at_ = now;
  if (boxes_.empty()) {
    boxes_ = boxes_of(*services_.world);
  }
  found(look_around(*services_.world, boxes_, bodies,
                    {.T_world_vehicle = vehicle->T_world_vehicle,
                     .T_world_sonar = T_world_transducer(*ping.T_world_mount, ping.bearing_rad),
                     .range_m = ping.range_m,
                     .sees_surface = sees_surface,
                     .vehicle_model = services_.vehicle_model,
                     .hides_vehicle = config_.hides_vehicle}));
}

void HeadDiagnosis::no_pose() {
  sees_surface_.reset();
  found({{"no_pose", "No pose of the vehicle has come, or only a stale one: no ping is made."}});
}

void HeadDiagnosis::found(std::vector<Finding> findings) {
  for (const Finding& finding : findings) {
    const bool known =
        std::ranges::any_of(findings_, [&](const Finding& before) { return before.code == finding.code; });
    if (!known) {
      spdlog::warn("head={} {}", config_.name, finding.text);
    }
  }
  if (findings.empty() && !findings_.empty()) {
    spdlog::info("head={} nothing looks wrong any more", config_.name);
  }
  findings_ = std::move(findings);
}

}  // namespace sonard::server
