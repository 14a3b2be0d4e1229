// SPDX-License-Identifier: Apache-2.0
// Response of a surface at a segment of a slice: normal maps and response laws.
#pragma once

#include "renderer/engines/cpu/fan_triangles.hpp"
#include "renderer/engines/cpu/slice_cutter.hpp"
#include "renderer/engines/slices/part_surface.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// Incidence of sound on the normals of a map.
struct MappedIncidence {
  float cosine;       ///< |n . d|, with n the mean of the map's normals, not of unit length
  float mean_length;  ///< length of n
};

/// The middle of a segment in its slice, and its size.
struct SegmentPlace {
  float h_m, z_m;
  const Slice& slice;
  float range_extent_m;
};

/// Incidence in the middle of a segment of a part with a normal map.
/// @param geometric cos phi of the triangle itself; returned if the shading normal is not finite
MappedIncidence mapped_incidence(const PartSurface& part, const FanTriangle& triangle,
                                 const SegmentPlace& place, float geometric);

/// SurfaceSample::response of a surface at an incidence and a range, without its facets.
float surface_response(const PartSurface& part, const SurfaceModel& model, float cosine, float range_m);

}  // namespace sonard::render
