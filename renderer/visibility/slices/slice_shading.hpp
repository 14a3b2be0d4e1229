// What a surface answers at a piece of a slice: interpolated normals, normal maps, and the response laws.
#pragma once

#include "renderer/visibility/slices/slice_patches.hpp"

namespace sonard::render {

/// The middle of a piece in its slice, and its size.
struct PiecePlace {
  float h_m, z_m;
  const Slice& slice;
  float range_extent_m;
};

/// cos phi with the normal that shades there.
/// @param geometric cos phi of the triangle itself; the answer where the shading normal is no direction.
float shaded_cosine(const PartSurface& part, const FanTriangle& triangle, const PiecePlace& place,
                    float geometric);

/// Whether all vertex normals are those of their facets, to 1e-4 rad, as where there are none: then there is
/// nothing to interpolate.
bool has_plain_facets(const TriangleMesh& mesh);

/// SurfaceSample::response of a surface seen under `cosine` at a range.
float surface_response(const PartSurface& part, const SurfaceModel& model, float cosine, float range_m);

}  // namespace sonard::render
