// SPDX-License-Identifier: Apache-2.0
#include "server/pose/stamp_watch.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::server {
namespace {

// Fewer poses, or a shorter time, may be jitter. A simulator whose physics is slower than its messages
// repeats stamp and pose.
constexpr std::size_t least_poses = 5;
constexpr std::chrono::milliseconds least_length{50};
constexpr std::chrono::milliseconds soon{500};  // for stamps that have always been 0
constexpr std::chrono::milliseconds longest_step{
    1500};  // stamps in whole seconds stay for one second at a time
constexpr std::chrono::milliseconds at_rest{2000};
// Above the noise of an estimator for a vehicle at rest.
constexpr double moved_m = 0.01;
constexpr double moved_rad = 0.01;

bool has_moved(const pose::Transform& from, const pose::Transform& to) {
  const pose::Quat& a = from.orientation;
  const pose::Quat& b = to.orientation;
  const double cosine_of_half = std::abs(a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z);
  return pose::norm(to.position_m - from.position_m) > moved_m ||
         2.0 * std::acos(std::min(1.0, cosine_of_half)) > moved_rad;
}

}  // namespace

bool StampWatch::Run::of_a_moving_vehicle() const {
  return moved && poses >= least_poses && length() >= least_length;
}

void StampWatch::observe(const pose::PoseSample& sample, TimePoint arrival) {
  if (run_ && run_->time_ns == sample.time_ns) {
    ++run_->poses;
    run_->end = arrival;
    run_->moved = run_->moved || has_moved(run_->first, sample.T_world_vehicle);
    return;
  }
  if (run_) {
    ++runs_before_;
    steps_ = run_->of_a_moving_vehicle() ? steps_ + 1 : 0;
    last_step_ = run_->length();
  }
  run_ = Run{.first = sample.T_world_vehicle, .time_ns = sample.time_ns, .begin = arrival, .end = arrival};
}

StampWatch::Looks StampWatch::looks() const {
  if (!run_) {
    return Looks::good;
  }
  const bool left_out = runs_before_ == 0 && run_->time_ns == 0;
  const std::chrono::milliseconds patience = left_out ? soon : longest_step;
  if (run_->of_a_moving_vehicle() && run_->length() >= patience) {
    return Looks::stand_still;
  }
  if (steps_ >= 2) {
    return Looks::in_steps;
  }
  const bool rests = runs_before_ == 0 && !run_->moved && run_->poses >= least_poses;
  return rests && run_->length() >= at_rest ? Looks::never_moved : Looks::good;
}

}  // namespace sonard::server
