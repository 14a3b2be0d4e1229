// SPDX-License-Identifier: Apache-2.0
// Finds what of a trajectory no vehicle can have travelled: teleports, and poses that are independent of each
// other.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "protocol/pose/trajectory.hpp"

namespace sonard::server {

/// Limits of a vehicle. A step from one point of a trajectory to the next that exceeds them is a jump.
inline constexpr double fastest_vehicle_mps = 20.0;
inline constexpr double fastest_turn_radps = 3.14159265358979324;  // 180 degrees per second
/// Limits of what may change between two steps, each of which is as long as this or longer. Where points are
/// closer in time, which shows more of the noise of a measured pose than of the motion, a step goes over
/// several.
inline constexpr double shortest_compared_step_s = 0.2;
inline constexpr double most_acceleration_mps2 = 3.0;
inline constexpr double most_turn_acceleration_radps2 = 1.04719755119659775;  // 60 degrees per second squared

struct Jumps {
  std::vector<bool> steps;  ///< step k, from point k to point k + 1: whether it is a jump
  std::size_t count = 0;    ///< of jumps
  /// A quarter of the steps or more are jumps, or do not continue the step before them: the poses are
  /// independent of each other. Steps of shortest_compared_step_s or more are looked at.
  bool independent = false;
  /// The first jump, "from t=0 to t=1: 34 m/s, 120 deg/s", or the first step that does not continue the one
  /// before, "from t=1 to t=2: velocity changes by 9 m/s and turn rate by 80 deg/s within 1 s". Empty:
  /// neither.
  std::string first;
};

/// @param points one or more, in strictly rising time
Jumps find_jumps(const std::vector<pose::TrajectoryPoint>& points);

}  // namespace sonard::server
