// SPDX-License-Identifier: Apache-2.0
// What a surface answers at a segment of a slice: interpolated normals, normal maps, and the response laws.
#pragma once

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

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

/// The normal that shades the plane of a triangle, where the ray (1, x, t) of a slice meets it: at + per_x x
/// + per_t t, of any length and sign. Components are along the slice, across it to port, and up. Weights of
/// corners go as 1 / depth along a ray, so that this is exact; beside the triangle it goes on as within.
struct NormalRun {
  glm::vec3 at, per_x{0.0F}, per_t{0.0F};

  bool is_finite() const {
    return std::isfinite(glm::dot(at, at) + glm::dot(per_x, per_x) + glm::dot(per_t, per_t));
  }
};

/// From the normals of its corners.
/// @param middle_t where refraction turns it as it does here (Refraction)
NormalRun interpolated_normals(const PartSurface& part, const FanTriangle& triangle, const Slice& slice,
                               float middle_t);

/// Whether all vertex normals are those of their facets, to 1e-4 rad, as where there are none: then there is
/// nothing to interpolate.
bool has_plain_facets(const TriangleMesh& mesh);

/// SurfaceSample::response of a surface seen under `cosine` at a range, without its facets.
float surface_response(const PartSurface& part, const SurfaceModel& model, float cosine, float range_m);

}  // namespace sonard::render
