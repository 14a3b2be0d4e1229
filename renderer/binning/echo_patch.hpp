// SPDX-License-Identifier: Apache-2.0
// Output of the visibility stage and input of binning: visible segments of a surface, each within one beam.
#pragma once

namespace sonard::render {

/// A segment of a surface between two elevations, over a span of azimuths. At each azimuth its echo is spread
/// between the ranges of its two ends, evenly or linearly rising. From one side of the azimuths to the other,
/// the range of each end changes linearly by its smear. A pixel of a grid has equal smears (docs/physics.md
/// 2.3); the ends of a facet follow its edges.
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
