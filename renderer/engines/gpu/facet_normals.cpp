// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/facet_normals.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/geometric.hpp>

namespace sonard::render {

TriangleMesh with_facet_normals(const TriangleMesh& mesh) {
  TriangleMesh facets;
  facets.positions = mesh.positions;
  facets.normals.resize(mesh.positions.size());
  facets.indices = mesh.indices;
  std::vector<bool> taken(mesh.positions.size());
  for (std::size_t i = 0; i < facets.indices.size(); i += 3) {
    const auto first = facets.indices.begin() + static_cast<std::ptrdiff_t>(i);
    auto own = std::find_if(first, first + 3, [&](std::uint32_t corner) { return !taken[corner]; });
    if (own == first + 3) {
      own = first;
      facets.positions.push_back(facets.positions[*own]);
      facets.normals.emplace_back();
      taken.push_back(false);
      *own = static_cast<std::uint32_t>(facets.positions.size() - 1);
    }
    taken[*own] = true;
    std::rotate(first, own + 1, first + 3);  // keeps the winding
    const glm::dvec3 a(facets.positions[first[0]]), b(facets.positions[first[1]]),
        c(facets.positions[first[2]]);
    facets.normals[first[2]] = glm::vec3(glm::normalize(glm::cross(b - a, c - a)));
  }
  return facets;
}

}  // namespace sonard::render
