// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/slice_shading.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace sonard::render {

namespace {

/// A triangle in the sonar frame and a point on it.
struct SurfacePoint {
  glm::vec3 corner, edge_b, edge_c, normal;
  glm::vec3 p;

  SurfacePoint(const FanTriangle& t, const glm::vec3& point)
      : corner(t.corner(0)),
        edge_b(t.corner(1) - corner),
        edge_c(t.corner(2) - corner),
        normal(t.across()),
        p(point) {}

  /// Weights of the second and third corner at a point, or their change along a step in the plane.
  glm::vec2 weights(const glm::vec3& from_corner) const {
    const float nn = glm::dot(normal, normal);
    return {glm::dot(glm::cross(from_corner, edge_c), normal) / nn,
            glm::dot(glm::cross(edge_b, from_corner), normal) / nn};
  }
};

template <class T>
T interpolate(const std::vector<T>& values, const std::uint32_t* corner, const glm::vec2& weights) {
  return values[corner[0]] * (1.0F - weights.x - weights.y) + values[corner[1]] * weights.x +
         values[corner[2]] * weights.y;
}

/// Level of the pyramid whose texels are as large as the smaller side of the segment's footprint, and the
/// number of texels along the larger side.
struct MapFootprint {
  float level;
  int taps;
  glm::vec2 uv_step;  ///< of the whole larger side
};

MapFootprint footprint_on_map(const PartSurface& part, const SurfacePoint& surface,
                              const std::uint32_t* corner, const SegmentPlace& place) {
  constexpr int most_taps = 8;
  const float range = glm::length(surface.p);
  const glm::vec3 d = surface.p / range;
  // Along the range in the plane, and across it: the sides of the footprint on the surface.
  const glm::vec3 n = glm::normalize(surface.normal);
  glm::vec3 along = d - n * glm::dot(n, d);
  const float steepness = glm::length(along);
  along = steepness > 1e-3F ? along / steepness : glm::normalize(surface.edge_b);
  const glm::vec3 across = glm::cross(n, along);
  const glm::vec2 b = part.mesh->texcoords[corner[1]] - part.mesh->texcoords[corner[0]];
  const glm::vec2 c = part.mesh->texcoords[corner[2]] - part.mesh->texcoords[corner[0]];
  const auto on_map = [&](const glm::vec3& step) {
    const glm::vec2 w = surface.weights(step);
    return b * w.x + c * w.y;
  };
  const glm::vec2 size(part.normal_map->levels[0].width_px, part.normal_map->levels[0].height_px);
  const glm::vec2 u = on_map(along * (place.range_extent_m / std::max(steepness, 1e-2F)));
  const glm::vec2 v = on_map(across * (range * place.slice.width_rad));
  const float u_texels = glm::length(u * size);
  const float v_texels = glm::length(v * size);
  const float shorter = std::max(1.0F, std::min(u_texels, v_texels));
  const float longer = std::max(u_texels, v_texels);
  const int taps = std::clamp(static_cast<int>(std::ceil(longer / shorter)), 1, most_taps);
  return {std::log2(std::max(shorter, longer / most_taps)), taps, u_texels > v_texels ? u : v};
}

/// Mean of the mapped normals over the footprint, not of unit length (NormalPyramid).
glm::vec3 mapped_normal(const PartSurface& part, const SurfacePoint& surface, const std::uint32_t* corner,
                        const glm::vec2& weights, const glm::vec3& vertex_normal, const SegmentPlace& place) {
  const glm::vec2 uv = interpolate(part.mesh->texcoords, corner, weights);
  const MapFootprint footprint = footprint_on_map(part, surface, corner, place);
  glm::vec3 m(0.0F);
  for (int k = 0; k < footprint.taps; ++k) {
    const float share = (static_cast<float>(k) + 0.5F) / static_cast<float>(footprint.taps) - 0.5F;
    m += part.normal_map->mean_normal(uv + footprint.uv_step * share, footprint.level);
  }
  return from_tangent_frame(m / static_cast<float>(footprint.taps), vertex_normal,
                            interpolate(part.mesh->tangents, corner, weights));
}

}  // namespace

MappedIncidence mapped_incidence(const PartSurface& part, const FanTriangle& triangle,
                                 const SegmentPlace& place, float geometric) {
  const SurfacePoint surface(triangle,
                             {place.h_m * place.slice.cosine, place.h_m * place.slice.sine, place.z_m});
  const glm::vec2 weights = surface.weights(surface.p - surface.corner);
  const std::uint32_t* corner = &part.mesh->indices[std::size_t{triangle.mesh_triangle} * 3];
  const glm::vec3 vertex_normal =
      part.mesh->normals.empty()
          ? part.R_part_sonar * glm::normalize(surface.normal)
          : part.refraction_in_part.normal(interpolate(part.mesh->normals, corner, weights),
                                           part.R_part_sonar * surface.p);
  const glm::vec3 d = part.R_part_sonar * glm::normalize(surface.p);
  const glm::vec3 n = mapped_normal(part, surface, corner, weights, vertex_normal, place);
  const float product = glm::dot(n, d);
  if (!std::isfinite(product)) {
    return {geometric, 1.0F};
  }
  return {std::min(1.0F, std::abs(product)), glm::length(n)};
}

float surface_response(const PartSurface& part, const SurfaceModel& model, float cosine, float range_m) {
  return model.model == Model::physical ? part.backscatter.lambert(cosine)
                                        : paper_response(model, part.reflectance, cosine, range_m);
}

}  // namespace sonard::render
