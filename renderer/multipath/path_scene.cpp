// SPDX-License-Identifier: Apache-2.0
#include "renderer/multipath/path_scene.hpp"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

namespace sonard::render {

namespace {

/// A leg begins this share of the distance to the sonar off its surface, ten times the rounding error, so
/// that it does not hit that surface again. Legs that begin nearer than that to an edge are lost.
constexpr double lift = 1e-6;

/// A mesh less than this share of the distance behind the water surface counts as before it.
constexpr double same_surface = 1e-5;

constexpr float flat_cosine = 0.99999F;  // 0.26 degrees

glm::vec3 lifted(const glm::dvec3& origin_m, const glm::dvec3& normal) {
  return glm::vec3(origin_m + normal * (lift * (1.0 + glm::length(origin_m))));
}

}  // namespace

PathScene::PathScene(SpatialIndex& meshes) : meshes_(meshes) {
  for (const Body& body : meshes.world().bodies) {
    for (const BodyPart& part : body.parts) {
      const AcousticMaterial& material = part.material;
      surfaces_.push_back({Mirror(material), material.lambert_mu, material.rms_slope, part.mesh});
    }
  }
}

bool PathScene::is_flat(const PathHit& hit) const {
  if (hit.surface == no_part || surfaces_[hit.surface].mesh->normals.empty()) {
    return true;
  }
  const TriangleMesh& mesh = *surfaces_[hit.surface].mesh;
  const std::uint32_t* corner = &mesh.indices[3 * std::size_t{hit.triangle}];
  const glm::vec3 n = glm::normalize(glm::cross(mesh.positions[corner[1]] - mesh.positions[corner[0]],
                                                mesh.positions[corner[2]] - mesh.positions[corner[0]]));
  const auto along = [&](std::size_t i) { return glm::dot(n, mesh.normals[corner[i]]) > flat_cosine; };
  return along(0) && along(1) && along(2);
}

void PathScene::place(const glm::dvec3& sonar_position_m, const Mirror& water_surface) {
  meshes_.place(sonar_position_m);
  const World& world = meshes_.world();
  std::size_t i = 0;
  for (const Body& body : world.bodies) {
    for (const BodyPart& part : body.parts) {
      surfaces_[i++].mesh = part.mesh;
    }
  }
  water_surface_ = water_surface;
  water_above_m_.reset();
  if (world.water_surface_z_m && *world.water_surface_z_m > sonar_position_m.z) {
    water_above_m_ = *world.water_surface_z_m - sonar_position_m.z;
  }
}

bool PathScene::trace(const glm::dvec3& origin_m, const glm::dvec3& normal, const glm::dvec3& direction,
                      double farthest_m, PathHit& hit) const {
  const glm::vec3 start_m = lifted(origin_m, normal);
  SurfaceHit met;
  meshes_.trace_one(start_m, glm::vec3(direction), static_cast<float>(farthest_m), met);
  return complete(start_m, direction, farthest_m, met, hit);
}

void PathScene::trace_from_sonar(const Directions& directions, double farthest_m,
                                 std::array<PathHit, packet_size>& hits) const {
  RayPacket rays;
  for (std::size_t i = 0; i < packet_size; ++i) {
    rays.x[i] = static_cast<float>(directions[i].x);
    rays.y[i] = static_cast<float>(directions[i].y);
    rays.z[i] = static_cast<float>(directions[i].z);
  }
  std::array<SurfaceHit, packet_size> met;
  meshes_.trace(rays, static_cast<float>(farthest_m), met);
  for (std::size_t i = 0; i < packet_size; ++i) {
    if (!complete({}, directions[i], farthest_m, met[i], hits[i])) {
      hits[i].distance_m = 0.0;
    }
  }
}

/// Compares the first hit of a mesh with the water surface. @param met part no_part: no mesh was hit
bool PathScene::complete(const glm::vec3& start_m, const glm::dvec3& direction, double farthest_m,
                         const SurfaceHit& met, PathHit& hit) const {
  hit.distance_m = farthest_m;
  if (met.part != no_part) {
    hit.distance_m = static_cast<double>(met.distance_m);
    hit.surface = met.part;
    hit.triangle = met.triangle;
    hit.normal = glm::dvec3(met.normal);
  }
  if (water_above_m_ && direction.z > 0) {
    const double to_water_m = (*water_above_m_ - static_cast<double>(start_m.z)) / direction.z;
    // A mesh of the water surface comes first, despite rounding.
    if (to_water_m > 0 && to_water_m * (1 + same_surface) < hit.distance_m) {
      hit.distance_m = to_water_m;
      hit.surface = no_part;
      hit.normal = glm::dvec3(0, 0, -1);
    }
  }
  if (hit.distance_m >= farthest_m) {
    return false;
  }
  hit.position_m = glm::dvec3(start_m) + hit.distance_m * direction;
  hit.normal = glm::normalize(hit.normal);
  hit.cosine = -glm::dot(hit.normal, direction);
  if (hit.cosine < 0) {
    hit.cosine = -hit.cosine;
    hit.normal = -hit.normal;
  }
  hit.cosine = std::min(1.0, hit.cosine);
  return std::isfinite(hit.cosine);
}

bool PathScene::is_free(const glm::dvec3& origin_m, const glm::dvec3& normal, const glm::dvec3& direction,
                        double distance_m) const {
  return meshes_.is_free(lifted(origin_m, normal), glm::vec3(direction), static_cast<float>(distance_m));
}

bool PathScene::sees_sonar(const PathHit& hit) const {
  constexpr double nearest_m = 0.02;
  const double range_m = glm::length(hit.position_m);
  if (!(range_m > nearest_m)) {
    return false;
  }
  const glm::dvec3 back = hit.position_m / -range_m;
  return glm::dot(hit.normal, back) > 0 && is_free(hit.position_m, hit.normal, back, range_m - nearest_m);
}

}  // namespace sonard::render
