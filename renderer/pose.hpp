// SPDX-License-Identifier: Apache-2.0
// Rigid transforms in double precision.
#pragma once

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

namespace sonard::render {

/// A rigid transform named T_a_b: it maps coordinates of frame b to frame a.
/// World frame: right-handed, z up. Sonar frame: x along the acoustic axis, y to port, z up.
/// `orientation` is a unit quaternion. Check this before you build a Pose from external data.
struct Pose {
  glm::dvec3 position_m{0.0};
  glm::dquat orientation{1.0, 0.0, 0.0, 0.0};  // w, x, y, z

  bool operator==(const Pose&) const = default;
};

/// T_a_c = T_a_b * T_b_c.
inline Pose operator*(const Pose& T_a_b, const Pose& T_b_c) {
  return {T_a_b.position_m + T_a_b.orientation * T_b_c.position_m,
          glm::normalize(T_a_b.orientation * T_b_c.orientation)};
}

/// Returns T_b_a.
inline Pose inverse(const Pose& T_a_b) {
  const glm::dquat back = glm::conjugate(T_a_b.orientation);
  return {back * -T_a_b.position_m, back};
}

/// T_a_b of two frames in the same world. Positions are subtracted first, so that distance from the world's
/// origin adds no rounding error of its own.
inline Pose relative(const Pose& T_world_a, const Pose& T_world_b) {
  const glm::dquat back = glm::conjugate(T_world_a.orientation);
  return {back * (T_world_b.position_m - T_world_a.position_m), glm::normalize(back * T_world_b.orientation)};
}

/// The point p_b in coordinates of frame a.
inline glm::dvec3 operator*(const Pose& T_a_b, const glm::dvec3& p_b) {
  return T_a_b.position_m + T_a_b.orientation * p_b;
}

}  // namespace sonard::render
