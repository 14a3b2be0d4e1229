// How the facets of a surface are heard over one piece of a slice, and across the wedge of the slice.
#pragma once

#include <glm/vec3.hpp>

#include "renderer/visibility/slices/part_surface.hpp"
#include "renderer/visibility/slices/slice_shading.hpp"
#include "renderer/visibility/slices/slice_sweep.hpp"

namespace sonard::render {

/// Part of a wedge: -1/2 is its starboard side, 1/2 its port side.
struct WedgePart {
  float from = -0.5F, to = 0.5F;
};

/// What facets answer, SurfaceSample::response, over part of a wedge.
struct FacetResponse {
  float mean = 0.0F;
  float moment = 0.0F;  ///< mean of response * (place across the wedge, from the middle of the part)
};

/// Normals and directions over one piece. Beside the piece the surface goes on as its triangle does.
class FacetSight {
 public:
  FacetSight() = default;
  /// @param part with its surface; stays where it is while this is in use.
  FacetSight(const PartSurface& part, const NormalRun& normals, const VisiblePiece& piece,
             const Slice& slice);

  /// Whether facets are heard anywhere between both ends and both sides: of what answers no, all facets echo
  /// less than SkipRule::facet_kernel allows. May answer yes where there are none.
  bool may_hear() const { return may_hear_; }

  /// By how many rms slopes m the direction of the echo, against that of a mirror, changes over a height of 1
  /// in t, and across the wedge. The echo changes little where this is less than 1.
  float slopes_per_t() const { return slopes_per_t_; }
  float slopes_across() const { return slopes_across_; }

  /// How the range of a surface that has these normals changes across the wedge at one elevation: r' / r, per
  /// radian, at a place in it.
  float range_slope(float t, float place) const;

  /// At one elevation.
  FacetResponse response(float t, const WedgePart& wedge) const;

 private:
  float cosine(float x, float t) const;
  void find_turn(float middle_t, float width_rad);

  const Backscatter* backscatter_ = nullptr;
  NormalRun normals_;
  float width_rad_ = 0.0F;
  float slopes_per_t_ = 0.0F, slopes_across_ = 0.0F;
  bool may_hear_ = false;
};

/// Mean of a piece, and how it changes along it.
/// @param tilts whether the change matters, as it does where a piece spreads over lines
struct PieceFacets {
  float mean = 0.0F, moment = 0.0F;  ///< FacetResponse
  float rise = 0.0F;                 ///< from the low to the high end
};
PieceFacets facets_of_piece(const FacetSight& sight, const VisiblePiece& piece, bool tilts,
                            const WedgePart& wedge = {});

}  // namespace sonard::render
