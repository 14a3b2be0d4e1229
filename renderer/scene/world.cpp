#include "renderer/scene/world.hpp"

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

const Body* World::find_body(const std::string& body_name) const {
  for (const Body& body : bodies) {
    if (body.name == body_name) {
      return &body;
    }
  }
  return nullptr;
}

}  // namespace sonard::render
