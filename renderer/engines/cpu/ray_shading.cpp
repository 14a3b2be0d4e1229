// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/ray_shading.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

/// Interpolates values of a triangle's corners. @param u, v weights of b and c
template <class T>
T interpolate(const T& a, const T& b, const T& c, float u, float v) {
  return a * (1.0F - u - v) + b * u + c * v;
}

}  // namespace

/// Per lane, in the part's frame: the normal that shades, and the square of its divisor.
struct alignas(64) SurfaceShader::ShadingNormals {
  Lanes<float> x, y, z;
  Lanes<float> squared_length;
};

SurfaceShader::SurfaceShader(const BodyPart& part, std::shared_ptr<const NormalPyramid> map)
    : mesh_(part.mesh),
      map_(std::move(map)),
      reflectance_(static_cast<float>(part.material.reflectance)),
      backscatter_(part.material) {
  const bool mapped = map_ && mesh_->can_be_mapped();
  normals_ = mapped ? Normals::of_map : mesh_->normals.empty() ? Normals::of_triangles : Normals::of_vertices;
}

glm::vec3 SurfaceShader::to_part(const glm::vec3& v_world) const {
  return {glm::dot(axes_[0], v_world), glm::dot(axes_[1], v_world), glm::dot(axes_[2], v_world)};
}

glm::vec3 SurfaceShader::vertex_normal(std::uint32_t triangle, float u, float v) const {
  const std::uint32_t* corner = &mesh_->indices[std::size_t{triangle} * 3];
  return interpolate(mesh_->normals[corner[0]], mesh_->normals[corner[1]], mesh_->normals[corner[2]], u, v);
}

/// Level of the pyramid whose texels are as large as the span of a sample.
float SurfaceShader::map_level(const RayPacket& rays, const RayHits& hits, std::size_t lane) const {
  const std::uint32_t* corner = &mesh_->indices[std::size_t{hits.triangle[lane]} * 3];
  const glm::vec3 a = mesh_->positions[corner[0]];
  const glm::vec3 edge_b = mesh_->positions[corner[1]] - a;
  const glm::vec3 edge_c = mesh_->positions[corner[2]] - a;
  const glm::vec3 n = glm::cross(edge_b, edge_c);
  const glm::vec3 q = to_part({rays.x[lane], rays.y[lane], rays.z[lane]});
  const glm::vec2 uv = mesh_->texcoords[corner[0]];
  const glm::vec2 map_b = mesh_->texcoords[corner[1]] - uv;
  const glm::vec2 map_c = mesh_->texcoords[corner[2]] - uv;
  const glm::vec2 size(map_->levels[0].width_px, map_->levels[0].height_px);
  const auto texels = [&](const glm::vec3& step_world) {
    // Distance to the hit of the neighbour's ray in the plane of the triangle, and the change of the corners'
    // weights over it.
    const glm::vec3 step = to_part(step_world);
    const glm::vec3 move = hits.depth[lane] * (step - q * (glm::dot(n, step) / glm::dot(n, q)));
    const float nn = glm::dot(n, n);
    const glm::vec2 moved = map_b * (glm::dot(glm::cross(move, edge_c), n) / nn) +
                            map_c * (glm::dot(glm::cross(edge_b, move), n) / nn);
    const glm::vec2 in_texels = moved * size;
    return glm::dot(in_texels, in_texels);
  };
  return 0.5F * std::log2(std::max(texels(rays.step_x), texels(rays.step_y)));
}

/// Mean mapped normal, not of unit length (NormalPyramid).
glm::vec3 SurfaceShader::mapped_normal(const RayPacket& rays, const RayHits& hits, std::size_t lane) const {
  const std::uint32_t* corner = &mesh_->indices[std::size_t{hits.triangle[lane]} * 3];
  const float u = hits.u[lane];
  const float v = hits.v[lane];
  const glm::vec4 tangent =
      interpolate(mesh_->tangents[corner[0]], mesh_->tangents[corner[1]], mesh_->tangents[corner[2]], u, v);
  const glm::vec2 uv = interpolate(mesh_->texcoords[corner[0]], mesh_->texcoords[corner[1]],
                                   mesh_->texcoords[corner[2]], u, v);
  return from_tangent_frame(map_->mean_normal(uv, map_level(rays, hits, lane)),
                            vertex_normal(hits.triangle[lane], u, v), tangent);
}

/// Replaces the geometric normals of the lanes that hit this part.
void SurfaceShader::look_up_normals(const RayPacket& rays, const RayHits& hits, std::uint32_t part,
                                    ShadingNormals& normals) const {
  for (std::size_t i = 0; i < packet_size; ++i) {
    if (hits.part[i] != part) {
      continue;
    }
    const bool mapped = normals_ == Normals::of_map;
    const glm::vec3 n =
        mapped ? mapped_normal(rays, hits, i) : vertex_normal(hits.triangle[i], hits.u[i], hits.v[i]);
    const float nn = glm::dot(n, n);
    if (nn > 0.0F) {  // for 0 or NaN the triangle's normal stays
      normals.x[i] = n.x;
      normals.y[i] = n.y;
      normals.z[i] = n.z;
      normals.squared_length[i] = mapped ? 1.0F : nn;
    }
  }
}

SONARD_SIMD_CLONES void SurfaceShader::shade(const RayPacket& rays, const RayHits& hits, std::uint32_t part,
                                             const SurfaceModel& model, SurfacePacket& surfaces) const {
  ShadingNormals normals{hits.normal_x, hits.normal_y, hits.normal_z, {}};
  for (std::size_t i = 0; i < packet_size; ++i) {
    normals.squared_length[i] =
        normals.x[i] * normals.x[i] + normals.y[i] * normals.y[i] + normals.z[i] * normals.z[i];
  }
  if (normals_ != Normals::of_triangles) {
    look_up_normals(rays, hits, part, normals);
  }
  const auto [ax, ay, az] = axes_;
  Lanes<float> cosine;
  for (std::size_t i = 0; i < packet_size; ++i) {
    const float x = rays.x[i];
    const float y = rays.y[i];
    const float z = rays.z[i];
    const float product = normals.x[i] * (ax.x * x + ax.y * y + ax.z * z) +
                          normals.y[i] * (ay.x * x + ay.y * y + ay.z * z) +
                          normals.z[i] * (az.x * x + az.y * y + az.z * z);
    const float ratio = std::abs(product) / std::sqrt(normals.squared_length[i] * (x * x + y * y + z * z));
    cosine[i] = ratio > 1.0F ? 1.0F : ratio;  // NaN stays NaN
  }
  const bool physical = model.model == Model::physical;
  const float gain = physical ? backscatter_.lambert_mu : 1.0F;
  for (std::size_t i = 0; i < packet_size; ++i) {
    const bool mine = hits.part[i] == part;
    const float nx = hits.normal_x[i];
    const float ny = hits.normal_y[i];
    const float nz = hits.normal_z[i];
    surfaces.normal_x[i] = mine ? ax.x * nx + ay.x * ny + az.x * nz : surfaces.normal_x[i];
    surfaces.normal_y[i] = mine ? ax.y * nx + ay.y * ny + az.y * nz : surfaces.normal_y[i];
    surfaces.normal_z[i] = mine ? ax.z * nx + ay.z * ny + az.z * nz : surfaces.normal_z[i];
    surfaces.response[i] = mine ? gain * cosine[i] : surfaces.response[i];
  }
  if (!physical) {
    apply_paper(rays, hits, part, model, surfaces);
  } else if (model.facets == Facets::everywhere ||
             (model.facets == Facets::near_normal && backscatter_.facet_strength > 0)) {
    add_facets(hits, part, model.facets, normals, cosine, surfaces);
  }
}

/// Facets need a normal of unit length; the shorter a mean normal, the wider their slopes.
void SurfaceShader::add_facets(const RayHits& hits, std::uint32_t part, Facets which,
                               const ShadingNormals& normals, const Lanes<float>& cosine,
                               SurfacePacket& surfaces) const {
  const bool mapped = normals_ == Normals::of_map;
  for (std::size_t i = 0; i < packet_size; ++i) {
    if (hits.part[i] != part) {
      continue;
    }
    const glm::vec3 n(normals.x[i], normals.y[i], normals.z[i]);
    const float mean_length = mapped ? std::sqrt(glm::dot(n, n) / normals.squared_length[i]) : 1.0F;
    const float to_facets = std::min(cosine[i] / mean_length, 1.0F);
    if (mapped || backscatter_.has_facets(which, to_facets)) {
      surfaces.response[i] += backscatter_.facets(to_facets, variance_of_mean_normal(mean_length));
    }
  }
}

/// From cos phi to the paper's sigmoid.
void SurfaceShader::apply_paper(const RayPacket& rays, const RayHits& hits, std::uint32_t part,
                                const SurfaceModel& model, SurfacePacket& surfaces) const {
  for (std::size_t i = 0; i < packet_size; ++i) {
    if (hits.part[i] == part) {
      const float range_m = hits.depth[i] * glm::length(glm::vec3(rays.x[i], rays.y[i], rays.z[i]));
      surfaces.response[i] = paper_response(model, reflectance_, surfaces.response[i], range_m);
    }
  }
}

}  // namespace sonard::render
