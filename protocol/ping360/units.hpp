// SPDX-License-Identifier: Apache-2.0
// Conversion of the Ping360's wire units to SI units (protocol/ping360/README.md 2.3). Angles are whole
// gradians, 400 per turn, clockwise seen from above.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace sonard::ping360 {

inline constexpr int gradians_per_turn = 400;
inline constexpr std::chrono::nanoseconds sample_tick{25};  ///< unit of the sample period

/// Wraps any number of gradians to 0..399.
constexpr int wrapped(int angle) {
  return (angle % gradians_per_turn + gradians_per_turn) % gradians_per_turn;
}
/// Shortest turn from one angle to another, -199..200; positive clockwise.
constexpr int shortest_turn(int from, int to) {
  const int turn = wrapped(to - from);
  return turn > gradians_per_turn / 2 ? turn - gradians_per_turn : turn;
}
/// Bearing in radians relative to `ahead`, positive to starboard, in (-pi, pi].
constexpr double bearing_rad(int angle, int ahead) {
  return shortest_turn(ahead, angle) * (2.0 * std::numbers::pi / gradians_per_turn);
}

inline constexpr double gradian_deg = 360.0 / gradians_per_turn;
/// The angle of the head for a bearing in degrees, positive to starboard.
inline int angle_of(double bearing_deg, int ahead) {
  return wrapped(ahead + static_cast<int>(std::lround(bearing_deg / gradian_deg)));
}

/// Two-way time from one sample to the next, seconds.
constexpr double sample_time_s(int sample_period) {
  return sample_period * 25e-9;
}
/// Time from transmission to the end of the last sample.
constexpr std::chrono::nanoseconds listening_time(int number_of_samples, int sample_period) {
  return number_of_samples * sample_period * sample_tick;
}

inline constexpr int least_sample_period = 80, most_sample_period = 40'000;

}  // namespace sonard::ping360
