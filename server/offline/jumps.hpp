// SPDX-License-Identifier: Apache-2.0
// Finds parts of a trajectory that no vehicle can travel: teleports, and poses that are independent of each
// other.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "protocol/pose/trajectory.hpp"

namespace sonard::server {

/// Limits of a vehicle. A step between two points of a trajectory that exceeds them is a jump.
inline constexpr double fastest_vehicle_mps = 20.0;
inline constexpr double fastest_turn_radps = 3.14159265358979324;  // 180 degrees per second
/// Limits of the change between two steps, each of at least this length. If points are closer in time, a step
/// spans several: closer points show more of the noise of a measured pose than of the motion.
inline constexpr double shortest_compared_step_s = 0.2;
inline constexpr double most_acceleration_mps2 = 3.0;
inline constexpr double most_turn_acceleration_radps2 = 1.04719755119659775;  // 60 degrees per second squared

struct Jumps {
  std::vector<bool> steps;  ///< step k, from point k to point k + 1: true if it is a jump
  std::size_t count = 0;    ///< number of jumps
  /// A quarter or more of the steps are jumps, or do not continue the step before: the poses are independent.
  /// Uses steps of shortest_compared_step_s or more.
  bool independent = false;
  /// The first jump, "from t=0 to t=1: 34 m/s, 120 deg/s", or the first step that does not continue the step
  /// before, "from t=1 to t=2: velocity changes by 9 m/s and turn rate by 80 deg/s within 1 s". Empty if
  /// there is neither.
  std::string first;
};

/// @param points one or more, in strictly increasing time
Jumps find_jumps(const std::vector<pose::TrajectoryPoint>& points);

}  // namespace sonard::server
