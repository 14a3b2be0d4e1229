// SPDX-License-Identifier: Apache-2.0
// Beams by closed forms (docs/physics.md 3.2), for mu = 1 and no absorption.
#pragma once

#include "renderer/ping.hpp"
#include "tests/support/beam_images.hpp"
#include "tests/support/closed_forms.hpp"

namespace sonard::test {

/// T4, beam by beam: a sphere wholly inside the fan. The sum over beams is sphere_echo().
struct SphereTruth {
  double radius_m;
  double horizontal_m, azimuth_rad, height_m;  ///< of the centre, sonar frame

  double beam(double psi_from, double psi_to, double r1, double r2) const;

 private:
  double density(double psi, double r1, double r2) const;
  double limb_squared() const;
};

/// T5, cylinder_density() over the width of a beam; the axis stands at `azimuth_rad`.
struct CylinderTruth {
  double radius_m, axis_m, azimuth_rad, elevation_limit_rad;

  double beam(double psi_from, double psi_to, double r1, double r2) const;
};

/// T7, ShadowTruth over the width of a beam. The wall is only to port of `end_rad`; to starboard is the bed
/// alone. A wall higher than the sonar makes the corner of T8.
struct WallEndTruth {
  ShadowTruth wall;
  double end_rad;  ///< inside (-pi/2, pi/2); -pi/2: the wall has no end

  double beam(double psi_from, double psi_to, double r1, double r2) const;
};

}  // namespace sonard::test
