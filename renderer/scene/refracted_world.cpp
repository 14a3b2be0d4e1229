// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/refracted_world.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include <glm/geometric.hpp>

#include "renderer/scene/refraction.hpp"
#include "renderer/scene/tessellation.hpp"

namespace sonard::render {

namespace {

constexpr double most_sag_m = 2.5e-4;
// Facets halved until no edge exceeds L are right-angled and have an area of L^2 / 16 to L^2 / 4.
constexpr double facets_per_square = 16.0;
constexpr double most_facets = 2e6;

double area_m2(const TriangleMesh& mesh) {
  double twice = 0;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    const glm::vec3& a = mesh.positions[mesh.indices[i]];
    twice += static_cast<double>(glm::length(
        glm::cross(mesh.positions[mesh.indices[i + 1]] - a, mesh.positions[mesh.indices[i + 2]] - a)));
  }
  return twice / 2;
}

}  // namespace

float refractable_edge_m(const World& world, double ray_curvature_per_m) {
  double area = 0;
  for (const Body& body : world.bodies) {
    for (const BodyPart& part : body.parts) {
      area += area_m2(*part.mesh);
    }
  }
  const double for_sag = std::sqrt(8 * most_sag_m / std::abs(ray_curvature_per_m));
  return static_cast<float>(std::max(for_sag, std::sqrt(facets_per_square * area / most_facets)));
}

namespace {

/// @param T_sonar_part in a sonar frame with the axes of the world
TriangleMesh refracted_mesh(const TriangleMesh& mesh, const Pose& T_sonar_part, const Refraction& bend) {
  TriangleMesh bent = mesh;
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p(T_sonar_part * glm::dvec3(mesh.positions[i]));
    bent.positions[i] = bend.point(p);
    if (!mesh.normals.empty()) {
      const glm::vec3 n(T_sonar_part.orientation * glm::dvec3(mesh.normals[i]));
      bent.normals[i] = glm::normalize(bend.normal(n, p));
    }
    if (!mesh.tangents.empty()) {  // shading makes it perpendicular to the normal again
      const glm::vec3 t(T_sonar_part.orientation * glm::dvec3(glm::vec3(mesh.tangents[i])));
      bent.tangents[i] = glm::vec4(t, mesh.tangents[i].w);
    }
  }
  return bent;
}

}  // namespace

World refractable(const World& world, double ray_curvature_per_m) {
  const float edge_m = refractable_edge_m(world, ray_curvature_per_m);
  World divided = world;
  std::map<const TriangleMesh*, std::shared_ptr<const TriangleMesh>> meshes;
  for (Body& body : divided.bodies) {
    for (BodyPart& part : body.parts) {
      std::shared_ptr<const TriangleMesh>& mesh = meshes[part.mesh.get()];
      if (!mesh) {
        mesh = std::make_shared<const TriangleMesh>(tessellated(*part.mesh, edge_m));
      }
      part.mesh = mesh;
    }
  }
  return divided;
}

World refracted_world(const World& world, const glm::dvec3& sonar_position_m, double bend_per_m) {
  const Refraction bend{{0.0F, 0.0F, 1.0F}, static_cast<float>(bend_per_m)};
  World bent = world;
  for (Body& body : bent.bodies) {
    const Pose T_sonar_body{body.T_world_body.position_m - sonar_position_m, body.T_world_body.orientation};
    for (BodyPart& part : body.parts) {
      part.mesh = std::make_shared<const TriangleMesh>(
          refracted_mesh(*part.mesh, T_sonar_body * part.T_body_part, bend));
      part.T_body_part = {};
    }
    body.T_world_body = {};
  }
  return bent;
}

}  // namespace sonard::render
