// SPDX-License-Identifier: Apache-2.0
// Matchers that compare poses in tests.
#pragma once

#include <gmock/gmock.h>

#include <cmath>

#include "protocol/pose/transform.hpp"

namespace sonard::pose {

/// Every coordinate is within `tolerance` of the expected one.
MATCHER_P2(IsVec3, expected, tolerance, "") {
  *result_listener << arg.x << ", " << arg.y << ", " << arg.z;
  return std::abs(arg.x - expected.x) <= tolerance && std::abs(arg.y - expected.y) <= tolerance &&
         std::abs(arg.z - expected.z) <= tolerance;
}

/// The same rotation, q or -q, and norm 1.
MATCHER_P2(IsRotation, expected, tolerance, "") {
  *result_listener << "w " << arg.w << " x " << arg.x << " y " << arg.y << " z " << arg.z;
  const double sign =
      arg.w * expected.w + arg.x * expected.x + arg.y * expected.y + arg.z * expected.z < 0 ? -1 : 1;
  return std::abs(arg.w - sign * expected.w) <= tolerance &&
         std::abs(arg.x - sign * expected.x) <= tolerance &&
         std::abs(arg.y - sign * expected.y) <= tolerance && std::abs(arg.z - sign * expected.z) <= tolerance;
}

/// Rotation about the z axis.
inline Quat yaw(double angle_rad) {
  return {std::cos(angle_rad / 2), 0.0, 0.0, std::sin(angle_rad / 2)};
}

}  // namespace sonard::pose
