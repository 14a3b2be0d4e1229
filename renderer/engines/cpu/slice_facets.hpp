// SPDX-License-Identifier: Apache-2.0
// The response of a surface's facets over one visible segment of a slice, and across the wedge of the slice.
#pragma once

#include <glm/vec3.hpp>

#include "renderer/engines/cpu/part_surface.hpp"
#include "renderer/engines/cpu/slice_sweep.hpp"
#include "renderer/engines/cpu/vertex_normals.hpp"

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

/// Normals and directions over one segment. Beside the segment the surface goes on as its triangle does.
class FacetSight {
 public:
  /// @param middle_t of the segment
  FacetSight(const Backscatter& backscatter, const NormalRun& normals, float width_rad, float middle_t);

  /// How the range of a surface that has these normals changes across the wedge at one elevation: r' / r, per
  /// radian, at a place in it.
  float range_slope(float t, float place) const;

  /// At one elevation.
  FacetResponse response(float t, const WedgePart& wedge) const;

 private:
  float cosine(float x, float t) const;

  const Backscatter& backscatter_;
  NormalRun normals_;
  float width_rad_;
  float slopes_across_;  ///< by how many rms slopes m the direction of the echo turns across the wedge
};

/// Mean of a segment, and how it changes along it.
struct SegmentFacets {
  float mean = 0.0F, moment = 0.0F;  ///< FacetResponse
  float gradient = 0.0F;             ///< response at the high end less that at the low end
};
SegmentFacets facets_of_segment(const FacetSight& sight, const VisibleSegment& segment,
                                const WedgePart& wedge = {});

}  // namespace sonard::render
