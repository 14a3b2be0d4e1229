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

/// Response of facets (SurfaceSample::response) over part of a wedge.
struct FacetResponse {
  float mean = 0.0F;
  float moment = 0.0F;  ///< mean of response * (place across the wedge, from the middle of the part)
};

/// Normals and directions over one segment. The surface continues beside the segment like its triangle.
class FacetSight {
 public:
  /// @param middle_t of the segment
  FacetSight(const Backscatter& backscatter, const NormalRun& normals, float width_rad, float middle_t);

  /// Relative change r' / r, per radian of azimuth, of the range of a surface with these normals, at one
  /// elevation and place in the wedge.
  float range_slope(float t, float place) const;

  /// Response at one elevation.
  FacetResponse response(float t, const WedgePart& wedge) const;

 private:
  float cosine(float x, float t) const;

  const Backscatter& backscatter_;
  NormalRun normals_;
  float width_rad_;
  float slopes_across_;  ///< turn of the echo's direction across the wedge, in rms slopes m
};

/// Response of a segment, and its change along the segment.
struct SegmentFacets {
  float mean = 0.0F, moment = 0.0F;  ///< FacetResponse
  float gradient = 0.0F;             ///< response at the high end minus response at the low end
};
SegmentFacets facets_of_segment(const FacetSight& sight, const VisibleSegment& segment,
                                const WedgePart& wedge = {});

}  // namespace sonard::render
