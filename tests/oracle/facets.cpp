// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/facets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

namespace sonard::oracle {

namespace {

double nearest_possible_m(const std::array<glm::dvec3, 3>& corners) {
  const glm::dvec3 low = glm::min(corners[0], glm::min(corners[1], corners[2]));
  const glm::dvec3 high = glm::max(corners[0], glm::max(corners[1], corners[2]));
  return glm::length(glm::max(glm::max(low, -high), glm::dvec3(0)));
}

/// The regions above and below the fan are convex cones, so a triangle is inside if its corners are.
bool outside_elevation(const std::array<glm::dvec3, 3>& corners, double tan_limit) {
  const auto all = [&](double side) {
    return std::all_of(corners.begin(), corners.end(), [&](const glm::dvec3& p) {
      return side * p.z > tan_limit * std::hypot(p.x, p.y) * (1 + 1e-12);
    });
  };
  return all(1.0) || all(-1.0);
}

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
  const double length = glm::length(v);
  return length > 0 ? v / length : glm::dvec3(0);
}

/// Barycentric weights of the corners at a point of the triangle.
glm::dvec3 barycentric(const Facet& facet, const glm::dvec3& point) {
  const glm::dvec3 a = facet.corners[0] - point;
  const glm::dvec3 b = facet.corners[1] - point;
  const glm::dvec3 c = facet.corners[2] - point;
  const glm::dvec3 areas(glm::dot(glm::cross(b, c), facet.normal), glm::dot(glm::cross(c, a), facet.normal),
                         glm::dot(glm::cross(a, b), facet.normal));
  const glm::dvec3 inside = glm::max(areas, glm::dvec3(0));  // rounding at the edges
  const double sum = inside.x + inside.y + inside.z;
  return sum > 0 ? inside / sum : glm::dvec3(1.0 / 3);
}

template <class Attribute>
auto interpolate(const std::vector<Attribute>& values, const std::array<std::uint32_t, 3>& vertices,
                 const glm::dvec3& weights) {
  using Wide = decltype(glm::vec<Attribute::length(), double>(values[0]));
  return weights.x * Wide(values[vertices[0]]) + weights.y * Wide(values[vertices[1]]) +
         weights.z * Wide(values[vertices[2]]);
}

std::array<std::uint32_t, 3> vertices_of(const render::TriangleMesh& mesh, const Facet& facet) {
  const std::size_t first = std::size_t{facet.mesh_triangle} * 3;
  return {mesh.indices[first], mesh.indices[first + 1], mesh.indices[first + 2]};
}

}  // namespace

glm::dvec3 bilinear(const render::NormalMap& map, const glm::dvec2& uv) {
  const double x = uv.x * map.width_px - 0.5;
  const double y = uv.y * map.height_px - 0.5;
  const double column = std::floor(x);
  const double row = std::floor(y);
  const auto wrap = [](double i, int size) {
    const double inside = i - std::floor(i / size) * size;
    return std::min(static_cast<std::size_t>(inside), static_cast<std::size_t>(size) - 1);
  };
  const auto texel = [&](double dx, double dy) {
    const std::size_t i = 3 * (wrap(row + dy, map.height_px) * static_cast<std::size_t>(map.width_px) +
                               wrap(column + dx, map.width_px));
    return glm::dvec3(map.rgb[i], map.rgb[i + 1], map.rgb[i + 2]) / 255.0;
  };
  const double fx = x - column;
  const double fy = y - row;
  return (1 - fy) * ((1 - fx) * texel(0, 0) + fx * texel(1, 0)) +
         fy * ((1 - fx) * texel(0, 1) + fx * texel(1, 1));
}

Facets::Facets(const render::World& world, const render::Pose& T_world_sonar, const EchoLaw& law) {
  const render::Pose T_sonar_world = render::inverse(T_world_sonar);
  for (const render::Body& body : world.bodies) {
    for (const render::BodyPart& part : body.parts) {
      add_part(part, T_sonar_world * (body.T_world_body * part.T_body_part), law);
    }
  }
}

void Facets::add_part(const render::BodyPart& part, const render::Pose& T_sonar_part, const EchoLaw& law) {
  const render::TriangleMesh& mesh = *part.mesh;
  const bool mapped = part.normal_map && !mesh.normals.empty() && !mesh.tangents.empty();
  parts_.push_back({part.mesh, part.normal_map, glm::mat3_cast(T_sonar_part.orientation),
                    Material{part.material.lambert_mu, part.material.reflectance,
                             part.material.pressure_reflection, part.material.rms_slope},
                    mapped                 ? Shading::normal_map
                    : mesh.normals.empty() ? Shading::geometric
                                           : Shading::vertex_normals});
  const auto part_index = static_cast<std::uint32_t>(parts_.size() - 1);

  std::vector<glm::dvec3> positions;
  positions.reserve(mesh.positions.size());
  for (const glm::vec3& p : mesh.positions) {
    positions.push_back(T_sonar_part * glm::dvec3(p));
  }
  const double tan_limit = std::tan(law.elevation_limit_rad());
  for (std::size_t i = 0; i < mesh.triangle_count(); ++i) {
    Facet facet;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      facet.corners[corner] = positions[mesh.indices[3 * i + corner]];
    }
    facet.normal =
        unit_or_zero(glm::cross(facet.corners[1] - facet.corners[0], facet.corners[2] - facet.corners[0]));
    facet.part = part_index;
    facet.mesh_triangle = static_cast<std::uint32_t>(i);
    const bool faces_away = glm::dot(facet.normal, facet.corners[0]) > 0;
    if (nearest_possible_m(facet.corners) <= law.max_range_m() &&
        !outside_elevation(facet.corners, tan_limit) && (law.two_sided() || !faces_away)) {
      facets_.push_back(facet);
    }
  }
}

double Facets::detail_m(const Facet& facet) const {
  const Part& part = parts_[facet.part];
  if (part.shading != Shading::normal_map) {
    return std::numeric_limits<double>::infinity();
  }
  // The inverse of an upper bound of the gradient of the texel coordinates, in texels per metre.
  const auto v = vertices_of(*part.mesh, facet);
  const glm::dvec2 size(part.normal_map->width_px, part.normal_map->height_px);
  const glm::dvec2 e1 =
      (glm::dvec2(part.mesh->texcoords[v[1]]) - glm::dvec2(part.mesh->texcoords[v[0]])) * size;
  const glm::dvec2 e2 =
      (glm::dvec2(part.mesh->texcoords[v[2]]) - glm::dvec2(part.mesh->texcoords[v[0]])) * size;
  const glm::dvec3 s1 = facet.corners[1] - facet.corners[0];
  const glm::dvec3 s2 = facet.corners[2] - facet.corners[0];
  const double twice_area = glm::length(glm::cross(s1, s2));
  const double texels_per_m =
      (glm::length(e1) * glm::length(s2) + glm::length(e2) * glm::length(s1)) / twice_area;
  return texels_per_m > 0 ? 1 / texels_per_m : std::numeric_limits<double>::infinity();
}

glm::dvec3 Facets::shading_normal(const Facet& facet, const glm::dvec3& point) const {
  const Part& part = parts_[facet.part];
  if (part.shading == Shading::geometric) {
    return facet.normal;
  }
  const auto vertices = vertices_of(*part.mesh, facet);
  const glm::dvec3 weights = barycentric(facet, point);
  glm::dvec3 normal = unit_or_zero(interpolate(part.mesh->normals, vertices, weights));
  if (part.shading == Shading::normal_map) {
    normal = mapped_normal(part, vertices, weights, normal);
  }
  return normal == glm::dvec3(0) ? facet.normal : part.R_sonar_part * normal;
}

glm::dvec3 Facets::mapped_normal(const Part& part, const std::array<std::uint32_t, 3>& vertices,
                                 const glm::dvec3& weights, const glm::dvec3& normal) const {
  const glm::dvec4 tangent = interpolate(part.mesh->tangents, vertices, weights);
  const glm::dvec3 along(tangent);
  const glm::dvec3 t = unit_or_zero(along - normal * glm::dot(normal, along));
  const glm::dvec3 b = glm::cross(normal, t) * tangent.w;
  const glm::dvec3 m =
      bilinear(*part.normal_map, interpolate(part.mesh->texcoords, vertices, weights)) * 2.0 - 1.0;
  return unit_or_zero(t * m.x + b * m.y + normal * m.z);
}

}  // namespace sonard::oracle
