// How the facets of a surface are heard over one piece of a slice, and across the wedge of the slice.
#pragma once

#include <glm/vec3.hpp>

#include "renderer/visibility/slices/slice_patches.hpp"

namespace sonard::render {

/// By how much the direction of the echo, against that of a mirror, changes over a piece: radians. Facets
/// with slope m change little where this is less than m.
struct FacetTurn {
  float along = 0.0F;   ///< from its low to its high end
  float across = 0.0F;  ///< from one side of the wedge to the other
};

/// What facets answer, SurfaceSample::response, over the wedge.
struct FacetResponse {
  float mean = 0.0F;
  float moment = 0.0F;  ///< mean of response * (place across the wedge, -1/2 to 1/2 at its port side)
};

/// One piece and the surface that it is part of. Beside the piece the surface goes on as its triangle does.
class FacetSight {
 public:
  FacetSight(const PartSurface& part, const VisiblePiece& piece, const Slice& slice);

  /// Whether facets are heard anywhere between both ends and both sides: of what answers no, all facets echo
  /// less than SkipRule::facet_kernel allows. May answer yes where there are none.
  bool may_hear() const { return may_hear_; }
  const FacetTurn& turn() const { return turn_; }
  /// How far the middle of the echo lies from the middle of the wedge, in range: metres.
  float displacement_m() const;

  /// At one elevation.
  FacetResponse response(float t) const;

 private:
  struct Sight {
    glm::vec3 direction;  ///< of sound, unit
    glm::vec3 normal;     ///< unit, in the same axes
  };
  Sight at(float t, float offset_rad) const;
  glm::vec3 off_mirror(float t, float offset_rad) const;
  float response_at(float t, float offset_rad) const;
  void find_turn();

  const PartSurface& part_;
  const VisiblePiece& piece_;
  const Slice& slice_;
  FacetTurn turn_;
  bool may_hear_ = false;
};

}  // namespace sonard::render
