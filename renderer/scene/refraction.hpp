// SPDX-License-Identifier: Apache-2.0
// Refraction in water with a sound speed that changes linearly with height.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sonard::render {

/// A level ray sinks by per_m * x^2 over the horizontal distance x, per_m = g / 2c (docs/physics.md 2.12).
/// The world is bent instead, in the opposite direction: each point is lifted by this amount and keeps its
/// distance from the sonar. Rays stay straight, so the search for surfaces needs no change, and the elevation
/// of a surface is the elevation at which the sound left the sonar. Coordinates have the sonar at their
/// origin.
struct Refraction {
  glm::vec3 up{0.0F, 0.0F, 1.0F};  ///< the world's vertical, unit, in the axes of the caller
  float per_m = 0.0F;              ///< 0: rays are straight

  bool straight() const { return per_m == 0.0F; }

  /// The apparent position of a point.
  glm::vec3 point(const glm::vec3& p) const {
    const float height = glm::dot(p, up);
    const float squared = glm::dot(p, p);
    const glm::vec3 lifted = p + up * (per_m * (squared - height * height));
    return lifted * std::sqrt(squared / std::fmax(glm::dot(lifted, lifted), 1e-30F));
  }

  /// The normal of a surface at `p`, not of unit length. A ray that is horizontal at the sonar meets the
  /// surface at an angle that is steeper by the ray's turn on the way. First order in that angle.
  glm::vec3 normal(const glm::vec3& n, const glm::vec3& p) const {
    return n - (p - up * glm::dot(p, up)) * (2 * per_m * glm::dot(n, up));
  }

  /// Upper limit of the difference between the movements of any point in a sphere and of its centre.
  float spread_m(const glm::vec3& centre, float radius_m) const {
    return 4 * std::abs(per_m) * radius_m * (glm::length(centre) + radius_m);
  }
};

/// Whether refraction matters: over the whole range, a ray turns by more than a quarter of the vertical beam,
/// g R^2 / 2c >= 0.25 R theta3.
inline bool refraction_matters(double bend_per_m, double max_range_m, double vertical_beamwidth_rad) {
  return std::abs(bend_per_m) * max_range_m >= 0.25 * vertical_beamwidth_rad;
}

}  // namespace sonard::render
