// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/tracking.hpp"

#include <cmath>
#include <numeric>

namespace sonard::ping1d {
namespace {

constexpr double distance_gain = 0.6;
constexpr double speed_gain = 0.2;
constexpr double least_gate_mm = 200.0;  // an echo further away is another one
constexpr double gate_share = 0.05;      // of the distance

}  // namespace

void Tracking::add(const Echo& echo, std::chrono::nanoseconds since_last) {
  confidences_.push_back(echo.distance_mm ? echo.confidence_percent : 0.0);
  if (confidences_.size() > window_) {
    confidences_.pop_front();
  }
  const bool had_echo = has_echo_;
  has_echo_ = echo.distance_mm.has_value();
  if (!has_echo_) {
    return;
  }
  const double passed_s = std::chrono::duration<double>(since_last).count();
  const double expected_mm = distance_mm_ + speed_mmps_ * passed_s;
  const double error_mm = *echo.distance_mm - expected_mm;
  if (!had_echo || passed_s <= 0.0 ||
      std::abs(error_mm) > std::max(least_gate_mm, gate_share * expected_mm)) {
    distance_mm_ = *echo.distance_mm;
    speed_mmps_ = 0.0;
    return;
  }
  distance_mm_ = expected_mm + distance_gain * error_mm;
  speed_mmps_ += speed_gain * error_mm / passed_s;
}

std::uint32_t Tracking::distance_mm() const {
  return static_cast<std::uint32_t>(std::max(0.0, std::round(distance_mm_)));
}

std::uint8_t Tracking::confidence_percent() const {
  if (!has_echo_) {
    return 0;
  }
  const double sum = std::accumulate(confidences_.begin(), confidences_.end(), 0.0);
  return static_cast<std::uint8_t>(std::lround(sum / static_cast<double>(confidences_.size())));
}

}  // namespace sonard::ping1d
