// SPDX-License-Identifier: Apache-2.0
// Refraction in water whose speed of sound changes evenly with height.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace sonard::render {

/// A level ray sinks by per_m * x^2 over the horizontal distance x, per_m = g / 2c (docs/physics.md 2.12).
/// Instead of the rays the world is bent, the other way: a point is lifted by as much, and keeps its distance
/// from the sonar. Rays stay straight then, so whatever finds surfaces does so unchanged, and the elevation
/// at which it finds one is that at which the sound left. Coordinates have the sonar at their origin.
struct Refraction {
  glm::vec3 up{0.0F, 0.0F, 1.0F};  ///< the world's vertical, unit, in the axes of the caller
  float per_m = 0.0F;              ///< 0: rays are straight

  bool straight() const { return per_m == 0.0F; }

  /// Where a point is seen.
  glm::vec3 point(const glm::vec3& p) const {
    const float height = glm::dot(p, up);
    const float squared = glm::dot(p, p);
    const glm::vec3 lifted = p + up * (per_m * (squared - height * height));
    return lifted * std::sqrt(squared / std::fmax(glm::dot(lifted, lifted), 1e-30F));
  }

  /// The normal of a surface through `p`, not of unit length: what is horizontal at the sonar meets a surface
  /// steeper by as much as the ray has turned on the way. First order in that angle.
  glm::vec3 normal(const glm::vec3& n, const glm::vec3& p) const {
    return n - (p - up * glm::dot(p, up)) * (2 * per_m * glm::dot(n, up));
  }

  /// By how much more or less than its centre any point of a sphere may be moved, at most.
  float spread_m(const glm::vec3& centre, float radius_m) const {
    return 4 * std::abs(per_m) * radius_m * (glm::length(centre) + radius_m);
  }
};

/// Whether refraction matters: over the whole range a ray turns aside by more than a quarter of the vertical
/// beam, g R^2 / 2c >= 0.25 R theta3.
inline bool refraction_matters(double bend_per_m, double max_range_m, double vertical_beamwidth_rad) {
  return std::abs(bend_per_m) * max_range_m >= 0.25 * vertical_beamwidth_rad;
}

}  // namespace sonard::render
