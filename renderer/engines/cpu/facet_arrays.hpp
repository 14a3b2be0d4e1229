// SPDX-License-Identifier: Apache-2.0
// Facets of all segments of a slice, as arrays for vectorised loops.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "renderer/engines/cpu/normal_arrays.hpp"
#include "renderer/engines/cpu/visible_arrays.hpp"
#include "renderer/engines/slices/part_surface.hpp"
#include "renderer/engines/slices/slice_math.hpp"

namespace sonard::render {

/// The results of FacetSight for all segments, from three samples along a segment and three across the wedge.
/// That is accurate unless is_wide(). Arrays never shrink.
class FacetArrays {
 public:
  /// @param everywhere facets are added at any incidence
  void lay_out(const std::vector<VisibleSegment>& visible, const std::vector<PartSurface>& parts,
               bool everywhere);

  /// Finds turns of the echo's direction, and segments whose facets may respond.
  void find_turns(const VisibleArrays& visible, const NormalArrays& normals, float width_rad);
  /// Finds mean(), moment() and gradient().
  void respond(const VisibleArrays& visible, const NormalArrays& normals, float width_rad);

  /// False only if all facets of the segment, between both sides of the wedge, echo less than
  /// SkipRule::facet_kernel allows.
  bool may_respond(std::size_t i) const { return responds_[i] > 0; }
  /// Per segment: turn of the echo's direction, re the direction of a mirror, in rms slopes m per unit of t.
  const float* slopes_per_t() const { return slopes_per_t_.data(); }
  /// Turn of that direction across the wedge, radians.
  float turn_across_rad(std::size_t i) const { return slopes_across_[i] * std::sqrt(variance_[i]); }
  /// The same turn in rms slopes m.
  float slopes_across(std::size_t i) const { return slopes_across_[i]; }
  /// True if the echo changes too much across the wedge for three samples.
  bool is_wide(std::size_t i) const { return slopes_across_[i] > slices::widest_facets; }

  /// See SegmentFacets.
  float mean(std::size_t i) const { return mean_[i]; }
  float moment(std::size_t i) const { return moment_[i]; }
  float gradient(std::size_t i) const { return gradient_[i]; }

 private:
  std::vector<float> strength_, variance_, least_cosine_;  ///< Backscatter
  std::vector<float> responds_, slopes_per_t_, slopes_across_;
  std::vector<float> mean_, moment_, gradient_;
};

}  // namespace sonard::render
