// SPDX-License-Identifier: Apache-2.0
// The triangles of a body, one by one.
#pragma once

#include <array>
#include <cstddef>

#include <glm/vec3.hpp>

#include "renderer/scene/world.hpp"

namespace sonard::server {

/// Calls `take` with the corners of each triangle of a body, in the body's frame.
template <class Take>
void each_triangle(const render::Body& body, Take take) {
  for (const render::BodyPart& part : body.parts) {
    const render::TriangleMesh& mesh = *part.mesh;
    for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
      take(std::array<glm::dvec3, 3>{part.T_body_part * glm::dvec3(mesh.positions[mesh.indices[i]]),
                                     part.T_body_part * glm::dvec3(mesh.positions[mesh.indices[i + 1]]),
                                     part.T_body_part * glm::dvec3(mesh.positions[mesh.indices[i + 2]])});
    }
  }
}

}  // namespace sonard::server
