// SPDX-License-Identifier: Apache-2.0
// The response of a surface's facets over one visible segment of a slice, and across the wedge of the slice.
#pragma once

#include <span>

#include "renderer/engines/cpu/slice_sweep.hpp"
#include "renderer/engines/cpu/vertex_normals.hpp"
#include "renderer/engines/slices/part_surface.hpp"

namespace sonard::render {

/// The response of facets over a segment, or its part in a part of the wedge (SurfaceSample::response).
struct SegmentFacets {
  float mean = 0.0F;
  float moment = 0.0F;    ///< mean of response * (place across the wedge, from the middle of the part)
  float gradient = 0.0F;  ///< response at the high end minus response at the low end
};

/// Normals and directions over one segment. The surface continues beside the segment like its triangle.
class FacetSight {
 public:
  static constexpr auto most_parts = static_cast<std::size_t>(slices::most_side_by_side);

  /// @param slopes_across turn of the echo's direction across the wedge, in rms slopes m
  FacetSight(const Backscatter& backscatter, const NormalRun& normals, float width_rad, float slopes_across)
      : backscatter_(backscatter), normals_(normals), width_rad_(width_rad), slopes_across_(slopes_across) {}

  /// Relative change r' / r, per radian of azimuth, of the range of a surface with these normals, at one
  /// elevation and place in the wedge: -1/2 is its starboard side, 1/2 its port side.
  float range_slope(float t, float place) const;

  /// The responses of a segment in equal parts of the wedge, from starboard to port.
  /// @param facets as many as there are parts, 1 to most_parts
  void respond(const VisibleSegment& segment, std::span<SegmentFacets> facets) const;

 private:
  const Backscatter& backscatter_;
  const NormalRun& normals_;
  float width_rad_;
  float slopes_across_;
};

}  // namespace sonard::render
