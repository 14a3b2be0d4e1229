// SPDX-License-Identifier: Apache-2.0
// Facets of all segments of a slice at once, as arrays, because loops over them are vectorised.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "renderer/engines/cpu/normal_arrays.hpp"
#include "renderer/engines/cpu/part_surface.hpp"
#include "renderer/engines/cpu/visible_arrays.hpp"

namespace sonard::render {

/// What FacetSight says of one segment, from three samples along it and three across the wedge. That is
/// enough where facets turn little across; is_wide() says where it is not. Arrays never shrink.
class FacetArrays {
 public:
  /// @param everywhere facets are added whatever the incidence
  void lay_out(const std::vector<VisibleSegment>& visible, const std::vector<PartSurface>& parts,
               bool everywhere);

  /// How the direction of the echo turns, and where facets may respond.
  void find_turns(const VisibleArrays& visible, const NormalArrays& normals, float width_rad);
  /// Finds mean(), moment() and gradient().
  void respond(const VisibleArrays& visible, const NormalArrays& normals, float width_rad);

  /// False only where all facets between both ends and both sides echo less than SkipRule::facet_kernel
  /// allows.
  bool may_respond(std::size_t i) const { return responds_[i] > 0; }
  /// Of each segment, by how many rms slopes m the direction of the echo, against that of a mirror, changes
  /// over a height of 1 in t.
  const float* slopes_per_t() const { return slopes_per_t_.data(); }
  /// By how much that direction changes across the wedge, radians.
  float turn_across_rad(std::size_t i) const { return slopes_across_[i] * std::sqrt(variance_[i]); }
  /// Whether the echo changes more across the wedge than three samples can tell.
  bool is_wide(std::size_t i) const { return slopes_across_[i] > most_across; }

  /// See SegmentFacets.
  float mean(std::size_t i) const { return mean_[i]; }
  float moment(std::size_t i) const { return moment_[i]; }
  float gradient(std::size_t i) const { return gradient_[i]; }

 private:
  static constexpr float most_across = 2.5F;

  std::vector<float> strength_, variance_, least_cosine_;  ///< Backscatter
  std::vector<float> responds_, slopes_per_t_, slopes_across_;
  std::vector<float> mean_, moment_, gradient_;
};

}  // namespace sonard::render
