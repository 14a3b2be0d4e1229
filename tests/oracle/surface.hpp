// SPDX-License-Identifier: Apache-2.0
// What a ray of the oracle can hit.
#pragma once

#include <limits>

#include <glm/vec3.hpp>

#include "tests/oracle/echo_law.hpp"

namespace sonard::oracle {

/// The first surface along a ray from the origin of the sonar frame.
struct SurfaceHit {
  double range_m = std::numeric_limits<double>::infinity();  ///< infinite: nothing is hit
  glm::dvec3 normal{0.0};                                    ///< unit, of the surface itself; either side
  glm::dvec3 shading_normal{0.0};                            ///< unit, what the echo law sees
  Material material;

  bool is_hit() const { return range_m < std::numeric_limits<double>::infinity(); }
};

/// Immutable; any number of threads may ask.
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
