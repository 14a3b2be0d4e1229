// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head_diagnosis.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/devices/device_type.hpp"

namespace sonard::server {
namespace {

// Intervals: a look tests all boxes of the world and, if nothing is seen, also triangles.
constexpr std::chrono::seconds while_seeing{5};
constexpr std::chrono::seconds while_blind{1};
constexpr std::chrono::seconds longest_turn{60};  // of a scanning head
constexpr double full_turn_rad = 2.0 * std::numbers::pi;

// Codes, which the page also knows.
constexpr const char* no_pose_code = "no_pose";
constexpr const char* stale_pose_code = "stale_pose";
constexpr const char* misaddressed_code = "misaddressed";
constexpr std::chrono::minutes worth_saying{1};  // a command for another head

}  // namespace

bool LastTurn::note(TimePoint now, double bearing_rad, bool seen) {
  const double turned_rad = std::abs(std::remainder(bearing_rad - bearing_rad_, full_turn_rad));
  bearing_rad_ = bearing_rad;
  if (seen) {
    ever_ = true;
    lost_.reset();
    turned_rad_ = 0.0;
    return true;
  }
  if (!lost_) {
    lost_ = now;
  }
  turned_rad_ += turned_rad;
  return ever_ && turned_rad_ < full_turn_rad && now - *lost_ < longest_turn;
}

void HeadDiagnosis::look(TimePoint now, const NewestPing& ping, const PosesUsed& poses, bool sees_surface,
                         double echo_over_floor) {
  // Hysteresis: to stand out again, an echo must be twice as strong. Otherwise a moving vehicle would log a
  // line each time that it passes the limit.
  const double least = stands_out_.value_or(true) ? least_visible_echo : 2.0 * least_visible_echo;
  bool stands_out = echo_over_floor >= least;
  if (type_of(config_).turns()) {
    sees_surface = surface_seen_.note(now, ping.bearing_rad, sees_surface);
    stands_out = echo_seen_.note(now, ping.bearing_rad, stands_out);
  }
  const bool saw_as_much = std::exchange(sees_surface_, sees_surface) == sees_surface;
  const bool as_before = std::exchange(stands_out_, stands_out) == stands_out && saw_as_much;
  const auto period = sees_surface && stands_out ? while_seeing : while_blind;
  if (world_ == nullptr || (as_before && now - looked_at_ < period)) {
    return;
  }
  looked_at_ = now;
  if (boxes_.empty()) {
    boxes_ = boxes_of(*world_);
  }
  found(look_around(*world_, boxes_, poses.bodies,
                    {.T_world_vehicle = poses.T_world_vehicle,
                     .T_world_sonar = T_world_transducer(poses.T_world_sonar, ping.bearing_rad),
                     .range_m = ping.range_m,
                     .sees_surface = sees_surface,
                     .echo_over_floor = stands_out ? std::max(echo_over_floor, least_visible_echo)
                                                   : std::min(echo_over_floor, 0.99 * least_visible_echo),
                     .vehicle_model = vehicle_model_,
                     .hides_vehicle = config_.hides_vehicle}));
}

void HeadDiagnosis::no_pose(TimePoint time) {
  sees_surface_.reset();
  stands_out_.reset();
  if (const std::optional<StalePose> stale = history_.stale_at(time)) {
    found({{stale_pose_code, fmt::format("The head does not ping: {}.", stale_text(*stale))}});
  } else if (history_.at(time)) {
    found({{no_pose_code,
            "No pose of the vehicle has arrived, so the head does not ping: pings follow the stamps of poses "
            "(poses.clock), and poses.initial has no stamp."}});
  } else {
    found({{no_pose_code, "No pose of the vehicle has arrived, so the head does not ping."}});
  }
}

bool HeadDiagnosis::has_pose(TimePoint now) const {
  return history_.at(history_.present(now)) &&
         (history_.ping_clock() == PingClock::wall || history_.newest());
}

std::vector<Finding> HeadDiagnosis::findings(TimePoint now) const {
  std::vector<Finding> current = findings_;
  if (has_pose(now)) {
    std::erase_if(current, [](const Finding& finding) {
      return finding.code == no_pose_code || finding.code == stale_pose_code;
    });
  }
  if (misaddressed_ && now - misaddressed_->at < worth_saying) {
    current.push_back({misaddressed_code, misaddressed_->what});
  }
  return current;
}

void HeadDiagnosis::found(std::vector<Finding> findings) {
  for (const Finding& finding : findings) {
    const bool known =
        std::ranges::any_of(findings_, [&](const Finding& before) { return before.code == finding.code; });
    if (!known) {
      spdlog::warn("head={}: {}", config_.name, finding.text);
    }
  }
  if (findings.empty() && !findings_.empty()) {
    spdlog::info("head={}: problem resolved", config_.name);
  }
  findings_ = std::move(findings);
}

}  // namespace sonard::server
