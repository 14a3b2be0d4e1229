// SPDX-License-Identifier: Apache-2.0
// What a surface answers at a segment of a slice: normal maps, and the response laws.
#pragma once

#include "renderer/engines/cpu/fan_triangles.hpp"
#include "renderer/engines/cpu/part_surface.hpp"
#include "renderer/engines/cpu/slice_cutter.hpp"
#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// How sound meets the normals of a map.
struct MappedIncidence {
  float cosine;       ///< |n . d|, with the mean of the map's normals as it is
  float mean_length;  ///< of that mean
};

/// The middle of a segment in its slice, and its size.
struct SegmentPlace {
  float h_m, z_m;
  const Slice& slice;
  float range_extent_m;
};

/// In the middle of a segment of a part with a normal map.
/// @param geometric cos phi of the triangle itself; the answer where the shading normal is no direction.
MappedIncidence mapped_incidence(const PartSurface& part, const FanTriangle& triangle,
                                 const SegmentPlace& place, float geometric);

/// Whether all vertex normals are those of their facets, to 1e-4 rad, as where there are none: then there is
/// nothing to interpolate.
bool has_plain_facets(const TriangleMesh& mesh);

/// SurfaceSample::response of a surface seen under `cosine` at a range, without its facets.
float surface_response(const PartSurface& part, const SurfaceModel& model, float cosine, float range_m);

}  // namespace sonard::render
