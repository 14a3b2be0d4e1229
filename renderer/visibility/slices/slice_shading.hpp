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

/// In the middle of a piece.
/// @param geometric cos phi of the triangle itself; the answer where the shading normal is no direction.
ShadedIncidence shaded_incidence(const PartSurface& part, const FanTriangle& triangle,
                                 const PiecePlace& place, float geometric);

/// The normal that the corners of the triangle give to the point of its plane along the ray q of the sonar
/// frame, unit, in the part's axes. Beside the triangle it goes on as within, for some of its widths.
glm::vec3 interpolated_normal(const PartSurface& part, const FanTriangle& triangle, const glm::vec3& q);

/// How far any vertex normal is away from that of its facet, radians.
float most_bend_rad(const TriangleMesh& mesh);

/// Whether all vertex normals are those of their facets, to 1e-4 rad, as where there are none: then there is
/// nothing to interpolate.
bool has_plain_facets(const TriangleMesh& mesh);

/// SurfaceSample::response of a surface seen under `cosine` at a range, without its facets.
float surface_response(const PartSurface& part, const SurfaceModel& model, float cosine, float range_m);

}  // namespace sonard::render
