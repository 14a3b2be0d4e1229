// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/dead_reckoning.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "protocol/dvl_a50/beams.hpp"

namespace sonard::dvl_a50 {

void DeadReckoning::reset() {
  moved_at_.reset();
  position_ = {};
  variance_ = 0.0;
  drift_rad_ = 0.0;
}

void DeadReckoning::move(std::chrono::nanoseconds now, const Motion& vehicle, bool bottom_lock) {
  if (!moved_at_) {
    start_ = vehicle.axes;
  }
  const double passed_s =
      moved_at_ ? std::max(0.0, 1e-9 * static_cast<double>((now - *moved_at_).count())) : 0.0;
  drift_rad_ += config_.heading_drift_radps * passed_s;
  // Row i of the axes in the start frame: component i of each axis. The drift turns it about z.
  Matrix axes{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const Vector here =
        from_world(start_, {vehicle.axes[0][axis], vehicle.axes[1][axis], vehicle.axes[2][axis]});
    const Vector drifted = to_vehicle(here, drift_rad_);
    for (std::size_t i = 0; i < 3; ++i) {
      axes[i][axis] = drifted[i];
    }
  }
  const Vector velocity{dot(axes[0], vehicle.velocity_mps), dot(axes[1], vehicle.velocity_mps),
                        dot(axes[2], vehicle.velocity_mps)};
  const bool moves = dot(velocity, velocity) > 0.0;
  const double growth_m = moves ? config_.noise_m * (bottom_lock ? 1.0 : 10.0) * std::sqrt(passed_s) : 0.0;
  for (std::size_t i = 0; i < 3 && moved_at_; ++i) {
    position_[i] += passed_s * (velocity_[i] + velocity[i]) / 2.0 + growth_m * noise_.next();
  }
  variance_ += growth_m * growth_m;
  axes_ = axes;
  velocity_ = velocity;
  moved_at_ = now;
}

Position DeadReckoning::position() const {
  if (!moved_at_) {
    return {};
  }
  constexpr double degrees = 180.0 / std::numbers::pi;
  return {.position_m = position_,
          .std_m = std::sqrt(variance_),
          .roll_deg = degrees * std::atan2(axes_[2][1], axes_[2][2]),
          .pitch_deg = degrees * std::asin(std::clamp(-axes_[2][0], -1.0, 1.0)),
          .yaw_deg = degrees * std::atan2(axes_[1][0], axes_[0][0])};
}

}  // namespace sonard::dvl_a50
