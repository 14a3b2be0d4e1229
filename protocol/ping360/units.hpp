// SPDX-License-Identifier: Apache-2.0
// Numbers of the Ping360's wire in SI units (docs/protocols/ping360.md 2.3). Angles are whole gradians, 400
// to the turn, clockwise seen from above.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace sonard::ping360 {

inline constexpr int gradians_per_turn = 400;
inline constexpr std::chrono::nanoseconds sample_tick{25};  ///< unit of the sample period

/// Any whole number of gradians as 0..399.
constexpr int wrapped(int angle) {
  return (angle % gradians_per_turn + gradians_per_turn) % gradians_per_turn;
}
/// The short way from one angle to another, -199..200; positive clockwise.
constexpr int shortest_turn(int from, int to) {
  const int turn = wrapped(to - from);
  return turn > gradians_per_turn / 2 ? turn - gradians_per_turn : turn;
}
/// Relative to `ahead`, positive to starboard, in (-pi, pi].
constexpr double bearing_rad(int angle, int ahead) {
  return shortest_turn(ahead, angle) * (2.0 * std::numbers::pi / gradians_per_turn);
}

inline constexpr double gradian_deg = 360.0 / gradians_per_turn;
/// The angle at which the head looks to a bearing, which is positive to starboard.
inline int angle_of(double bearing_deg, int ahead) {
  return wrapped(ahead + static_cast<int>(std::lround(bearing_deg / gradian_deg)));
}

/// Two-way time from one sample to the next.
constexpr double sample_time_s(int sample_period) {
  return sample_period * 25e-9;
}
/// Time until the echo of the last sample is back.
constexpr std::chrono::nanoseconds listening_time(int number_of_samples, int sample_period) {
  return number_of_samples * sample_period * sample_tick;
}

// ---- What known clients choose for a range; they count it at a speed of sound of their own (2.3)

inline constexpr int least_sample_period = 80, most_sample_period = 40'000;

/// As many as there may be, but no finer than a head samples.
inline int usual_samples(double range_m, double sound_speed_mps) {
  const double finest = 2.0 * range_m / (sample_time_s(least_sample_period) * sound_speed_mps);
  return static_cast<int>(std::min(1200.0, finest));
}
/// May be out of these limits.
inline int sample_period_for(double range_m, int samples, double sound_speed_mps) {
  return static_cast<int>(2.0 * range_m / (samples * sample_time_s(1) * sound_speed_mps));
}
/// Longer for a longer range, and of two and a half samples at least.
inline std::uint16_t transmit_duration_us(double range_m, int sample_period, double sound_speed_mps) {
  const double sample_us = 1e6 * sample_time_s(sample_period);
  const double wanted_us = std::max(std::round(8000.0 * range_m / sound_speed_mps), 2.5 * sample_us);
  return static_cast<std::uint16_t>(std::clamp(wanted_us, 5.0, std::min(500.0, 64.0 * sample_us)));
}

}  // namespace sonard::ping360
