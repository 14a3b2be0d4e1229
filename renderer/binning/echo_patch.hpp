// SPDX-License-Identifier: Apache-2.0
// What visibility hands to binning: bits of visible surface, each within one beam.
#pragma once

namespace sonard::render {

/// A bit of surface that is seen between two elevations over some azimuth. At each azimuth its echo is spread
/// between the ranges of its two ends, evenly or rising in a straight line, and the range of each end runs
/// evenly over its smear as the azimuth goes from one side to the other. A pixel of a grid is one with equal
/// smears (docs/physics.md 2.3); facets have ends that run as their edges do.
struct EchoPatch {
  float range_a_m = 0.0F, range_b_m = 0.0F;  ///< of the ends, in the middle of the azimuth; in any order
  float smear_a_m = 0.0F, smear_b_m = 0.0F;  ///< >= 0
  float echo = 0.0F;                         ///< response * solid angle * elevation pattern, steradians
  float weight = 0.0F;                       ///< solid angle * elevation pattern, steradians
  /// Echo and weight per metre at end a and b are the mean times (1 - gradient) and (1 + gradient).
  float echo_gradient = 0.0F, weight_gradient = 0.0F;
  float tangent_a = 0.0F, tangent_b = 0.0F;  ///< of the elevations of the ends
};

}  // namespace sonard::render
