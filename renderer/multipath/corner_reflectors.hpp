// SPDX-License-Identifier: Apache-2.0
// Echoes of corner reflectors: two or three mirrors that meet at right angles (docs/physics.md 2.11).
#pragma once

#include <complex>
#include <vector>

#include <glm/vec3.hpp>

#include "renderer/multipath/ghost_paths.hpp"
#include "renderer/multipath/path_scene.hpp"

namespace sonard::render {

/// The echo of a corner.
struct CornerReflector {
  glm::dvec3 position_m{0.0};  ///< relative to the sonar, in world axes
  double intensity = 0.0;      ///< at the sonar, re the source at 1 m; no absorption, no patterns
};

/// Computes the corner whose echo seems to come from `candidate.image_m`. Its aperture is the set of all rays
/// that the mirrors send to that image; the aperture diffracts. With rho the distance from the line to the
/// image, in the plane through the corner at range r, and a path that is longer than this line by rho^2 / r,
/// Kirchhoff's integral (Fresnel's approximation) is
///
///     pressure = 1 / (lambda r^2) | sum over the aperture of R1 R2 (R3) exp(i k rho^2 / r) dA |
///
/// A corner that is small against sqrt(lambda r / 2) has the target strength A^2 / lambda^2. A trihedral of
/// three triangles with edges L has A = L^2 / sqrt(3), so L^4 / (3 lambda^2). A large corner returns the
/// image of the source in a mirror, 1 / (2 r) in pressure.
CornerReflector corner_reflector(const PathScene& scene, const CornerCandidate& candidate,
                                 const PathLimits& limits);

/// The candidates without duplicates, in order of first occurrence. Two images nearer to one another than
/// their inaccuracy are duplicates.
std::vector<CornerCandidate> distinct_corners(const std::vector<GhostPaths::Result>& results,
                                              const GhostPaths::Result& more, const PathLimits& limits);

}  // namespace sonard::render
