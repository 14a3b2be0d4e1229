// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/world.hpp"

#include <algorithm>

#include "renderer/scene/terrain.hpp"

namespace sonard::render {

MeshDiagnostics& MeshDiagnostics::operator+=(const MeshDiagnostics& other) {
  degenerate_triangles += other.degenerate_triangles;
  non_finite_triangles += other.non_finite_triangles;
  bad_normals += other.bad_normals;
  bad_texcoords += other.bad_texcoords;
  return *this;
}

std::size_t World::triangle_count() const {
  std::size_t count = 0;
  for (const Body& body : bodies) {
    for (const BodyPart& part : body.parts) {
      count += part.mesh->triangle_count();
    }
  }
  return count;
}

bool World::is_terrain(std::size_t body, std::size_t part_of_body) const {
  return std::any_of(terrains.begin(), terrains.end(), [&](const TerrainParts& parts) {
    return body == parts.body && part_of_body >= parts.first_part &&
           part_of_body < parts.first_part + parts.terrain->tiles().size();
  });
}

std::size_t World::part_count() const {
  std::size_t count = 0;
  for (const Body& body : bodies) {
    count += body.parts.size();
  }
  return count;
}

const Body* World::find_body(const std::string& body_name) const {
  for (const Body& body : bodies) {
    if (body.name == body_name) {
      return &body;
    }
  }
  return nullptr;
}

void replace_meshes(World& world, std::span<const PartMesh> changes) {
  for (const PartMesh& change : changes) {
    std::size_t in_body = change.part;
    std::size_t body = 0;
    while (in_body >= world.bodies[body].parts.size()) {
      in_body -= world.bodies[body++].parts.size();
    }
    world.bodies[body].parts[in_body].mesh = change.mesh;
  }
}

}  // namespace sonard::render
