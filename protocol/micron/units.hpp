// SPDX-License-Identifier: Apache-2.0
// Conversion of the Micron's wire units to SI units (protocol/micron/README.md 4). Angles are in 1/16
// gradian, 6400 per turn, clockwise seen from above: 0 astern, 1600 port, 3200 ahead, 4800 starboard.
#pragma once

#include <chrono>
#include <cstdint>
#include <numbers>

namespace sonard::micron {

inline constexpr int units_per_turn = 6400;
inline constexpr int bearing_ahead = 3200;
inline constexpr std::chrono::nanoseconds ad_interval_unit{640};    ///< unit of the time between two bins
inline constexpr std::chrono::nanoseconds motor_time_unit{10'000};  ///< unit of the time to turn by one unit
inline constexpr double full_scale_db = 80.0;
inline constexpr int gain_full_scale = 210;  ///< full scale of the gain byte; levels have 255

/// Wraps any number of units to 0..6399.
constexpr int wrapped(int bearing) {
  return (bearing % units_per_turn + units_per_turn) % units_per_turn;
}
/// Shortest turn from one bearing to another, -3199..3200; positive clockwise.
constexpr int shortest_turn(int from, int to) {
  const int turn = wrapped(to - from);
  return turn > units_per_turn / 2 ? turn - units_per_turn : turn;
}
/// Bearing in radians relative to ahead, positive to starboard, in [-pi, pi).
constexpr double bearing_rad(int bearing) {
  return (wrapped(bearing) - bearing_ahead) * (2.0 * std::numbers::pi / units_per_turn);
}

/// Two-way time from one bin to the next, seconds.
constexpr double bin_time_s(int ad_interval) {
  return ad_interval * 640e-9;
}
/// Receiver level, 0..80 dB, of a byte of a line, of AD span or of AD low.
constexpr double level_db(int level) {
  return level * full_scale_db / 255.0;
}
/// Initial gain of a gain byte in dB; 210 and above are 80 dB.
constexpr double gain_db(int gain) {
  return (gain < gain_full_scale ? gain : gain_full_scale) * full_scale_db / gain_full_scale;
}

}  // namespace sonard::micron
