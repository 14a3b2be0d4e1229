// SPDX-License-Identifier: Apache-2.0
// Facets of all pieces of a slice at once, as arrays, because loops over them are vectorised.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "renderer/engines/cpu/normal_arrays.hpp"
#include "renderer/engines/cpu/part_surface.hpp"
#include "renderer/engines/cpu/piece_arrays.hpp"

namespace sonard::render {

/// What FacetSight says of one piece, with three looks along it and three across the wedge. That is enough
/// where facets turn little across; is_wide() says where it is not. Arrays never shrink.
class FacetArrays {
 public:
  /// @param everywhere facets are looked at whatever the incidence
  void lay_out(const std::vector<VisiblePiece>& pieces, const std::vector<PartSurface>& parts,
               bool everywhere);

  /// How the direction of the echo turns, and where facets may be heard.
  void find_turns(const PieceArrays& pieces, const NormalArrays& normals, float width_rad);
  /// What they answer.
  void hear(const PieceArrays& pieces, const NormalArrays& normals, float width_rad);

  /// Whether facets are heard anywhere between both ends and both sides: of what answers no, all facets echo
  /// less than SkipRule::facet_kernel allows. May answer yes where there are none.
  bool may_hear(std::size_t i) const { return heard_[i] > 0; }
  /// By how many rms slopes m the direction of the echo, against that of a mirror, changes over a height of 1
  /// in t.
  float slopes_per_t(std::size_t i) const { return slopes_per_t_[i]; }
  /// Of that direction across the wedge, radians.
  float turn_across_rad(std::size_t i) const { return slopes_across_[i] * std::sqrt(variance_[i]); }
  /// Whether the echo changes more across the wedge than three looks can tell.
  bool is_wide(std::size_t i) const { return slopes_across_[i] > most_across; }

  /// As PieceFacets.
  float mean(std::size_t i) const { return mean_[i]; }
  float moment(std::size_t i) const { return moment_[i]; }
  float rise(std::size_t i) const { return rise_[i]; }

 private:
  static constexpr float most_across = 2.5F;

  std::vector<float> strength_, variance_, least_cosine_;  ///< Backscatter
  std::vector<float> heard_, slopes_per_t_, slopes_across_;
  std::vector<float> mean_, moment_, rise_;
};

}  // namespace sonard::render
