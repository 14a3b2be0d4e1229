// SPDX-License-Identifier: Apache-2.0
// Surfaces for the rays of the oracle.
#pragma once

#include <limits>

#include <glm/vec3.hpp>

#include "tests/oracle/echo_law.hpp"

namespace sonard::oracle {

/// The first surface along a ray from the origin of the sonar frame.
struct SurfaceHit {
  double range_m = std::numeric_limits<double>::infinity();  ///< infinite: no hit
  glm::dvec3 normal{0.0};                                    ///< unit, of the surface itself; either side
  glm::dvec3 shading_normal{0.0};                            ///< unit, for the echo law
  Material material;

  bool is_hit() const { return range_m < std::numeric_limits<double>::infinity(); }
};

/// Immutable; safe to use from any number of threads.
class Surface {
 public:
  Surface() = default;
  virtual ~Surface() = default;
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;

  /// @param direction unit, sonar frame
  virtual SurfaceHit nearest(const glm::dvec3& direction) const = 0;
};

}  // namespace sonard::oracle
