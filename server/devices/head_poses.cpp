// SPDX-License-Identifier: Apache-2.0
#include "server/devices/head_poses.hpp"

#include <utility>
#include <vector>

namespace sonard::server {

HeadPoses::HeadPoses(const HeadConfig& config, const PoseHistory& history, std::string vehicle_model)
    : config_(config), history_(history), vehicle_model_(std::move(vehicle_model)) {
  if (history.ping_clock() != PingClock::wall) {
    ping_times_.emplace(history);
  }
}

bool HeadPoses::begin_ping(TimePoint now, const std::optional<NextPing>& next, bool rendering) {
  if (!next) {
    rest_when_idle(now, rendering);
    return false;
  }
  if (next->from > now) {
    return false;
  }
  last_wanted_ = now;
  ping_time_ = ping_times_->begin(next->period, next->listening);
  return ping_time_.has_value();
}

void HeadPoses::rest() {
  if (ping_times_) {
    ping_times_->rest();
  }
}

void HeadPoses::rest_when_idle(TimePoint now, bool rendering) {
  if (rendering) {
    last_wanted_ = now;
  } else if (now - last_wanted_ > longest_pause) {
    rest();
  }
}

std::optional<std::chrono::nanoseconds> HeadPoses::lead() const {
  return ping_times_ ? ping_times_->lead() : std::nullopt;
}

std::shared_ptr<const PosesUsed> HeadPoses::of_ping(const PingJob& job) const {
  const TimePoint time = pose_time(job.transmit_time);
  std::optional<PosesUsed> poses = at(time);
  if (!poses) {
    return nullptr;
  }
  poses->time = job.transmit_time;
  poses->T_world_sonar_at_end = T_world_mount(time + job.listening_time);
  return std::make_shared<const PosesUsed>(*std::move(poses));
}

std::optional<PosesUsed> HeadPoses::at(TimePoint time) const {
  const std::optional<PoseEstimate> vehicle = history_.at(time);
  if (!vehicle) {
    return std::nullopt;
  }
  const render::Pose& T_world_vehicle = vehicle->T_world_vehicle;
  PosesUsed poses{time, T_world_vehicle, T_world_vehicle * config_.T_vehicle_sonar, history_.bodies_at(time)};
  poses.stamp_ns = history_.stamp_at(time);
  poses.sonar_velocity_mps = mount_velocity_mps(time);
  if (!vehicle_model_.empty()) {
    std::erase_if(poses.bodies, [&](const PosedBody& body) { return body.name == vehicle_model_; });
    if (!config_.hides_vehicle) {
      poses.bodies.push_back({vehicle_model_, T_world_vehicle});
    }
  }
  return poses;
}

std::optional<render::Pose> HeadPoses::T_world_mount(TimePoint time) const {
  const std::optional<PoseEstimate> vehicle = history_.at(time);
  return vehicle ? std::optional(vehicle->T_world_vehicle * config_.T_vehicle_sonar) : std::nullopt;
}

glm::dvec3 HeadPoses::mount_velocity_mps(TimePoint time) const {
  const pose::Velocity twist = history_.twist_at(time);
  const pose::Vec3 &linear = twist.linear_mps, &angular = twist.angular_radps;
  const render::Pose& mount = config_.T_vehicle_sonar;
  const glm::dvec3 of_arm = glm::cross(glm::dvec3(angular.x, angular.y, angular.z), mount.position_m);
  return glm::conjugate(mount.orientation) * (glm::dvec3(linear.x, linear.y, linear.z) + of_arm);
}

}  // namespace sonard::server
