// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/tessellation.hpp"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <utility>

#include <glm/geometric.hpp>

namespace sonard::render {

namespace {

/// Halves all edges that are too long, once.
class EdgeHalver {
 public:
  EdgeHalver(TriangleMesh& mesh, float longest_edge_m)
      : mesh_(mesh), longest_squared_(longest_edge_m * longest_edge_m) {}

  /// @return false if no edge was too long.
  bool run() {
    const std::vector<std::uint32_t> before = std::exchange(mesh_.indices, {});
    for (std::size_t i = 0; i + 2 < before.size(); i += 3) {
      divide({before[i], before[i + 1], before[i + 2]});
    }
    return !middles_.empty();
  }

 private:
  using Triangle = std::array<std::uint32_t, 3>;

  void divide(Triangle t) {
    std::array<bool, 3> split{};  // edge k leads from corner k to the next
    for (std::size_t k = 0; k < 3; ++k) {
      split[k] = too_long(t[k], t[(k + 1) % 3]);
    }
    const auto count = std::count(split.begin(), split.end(), true);
    if (count == 0) {
      add(t[0], t[1], t[2]);
      return;
    }
    // If one edge or all are split, begin with a split edge. If two are split, begin after the whole edge.
    while (count == 2 ? split[2] : !split[0]) {
      std::rotate(t.begin(), t.begin() + 1, t.end());
      std::rotate(split.begin(), split.begin() + 1, split.end());
    }
    const std::uint32_t ab = middle(t[0], t[1]);
    if (count == 1) {
      add(t[0], ab, t[2]);
      add(ab, t[1], t[2]);
      return;
    }
    const std::uint32_t bc = middle(t[1], t[2]);
    add(ab, t[1], bc);
    if (count == 2) {
      add(t[0], ab, bc);
      add(t[0], bc, t[2]);
      return;
    }
    const std::uint32_t ca = middle(t[2], t[0]);
    add(t[0], ab, ca);
    add(ca, bc, t[2]);
    add(ab, bc, ca);
  }

  bool too_long(std::uint32_t a, std::uint32_t b) const {
    const glm::vec3 edge = mesh_.positions[b] - mesh_.positions[a];
    return glm::dot(edge, edge) > longest_squared_;
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh_.indices.insert(mesh_.indices.end(), {a, b, c});
  }

  /// The vertex halfway between two vertices.
  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const auto [low, high] = std::minmax(a, b);
    const auto [entry, is_new] = middles_.try_emplace(std::uint64_t{low} << 32 | high,
                                                      static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) {
      mesh_.positions.push_back((mesh_.positions[a] + mesh_.positions[b]) * 0.5F);
      if (!mesh_.normals.empty()) {
        mesh_.normals.push_back(direction(mesh_.normals[a] + mesh_.normals[b], mesh_.normals[a]));
      }
      if (!mesh_.texcoords.empty()) {
        mesh_.texcoords.push_back((mesh_.texcoords[a] + mesh_.texcoords[b]) * 0.5F);
      }
      if (!mesh_.tangents.empty()) {
        const glm::vec3 ta(mesh_.tangents[a]);
        mesh_.tangents.push_back(
            glm::vec4(direction(ta + glm::vec3(mesh_.tangents[b]), ta), mesh_.tangents[a].w));
      }
    }
    return entry->second;
  }

  static glm::vec3 direction(const glm::vec3& sum, const glm::vec3& if_opposite) {
    const float length = glm::length(sum);
    return length > 1e-6F ? sum / length : if_opposite;
  }

  TriangleMesh& mesh_;
  float longest_squared_;
  std::unordered_map<std::uint64_t, std::uint32_t> middles_;  // by the edge's two vertices
};

}  // namespace

TriangleMesh tessellated(const TriangleMesh& mesh, float longest_edge_m) {
  TriangleMesh divided = mesh;
  while (EdgeHalver(divided, longest_edge_m).run()) {
  }
  return divided;
}

}  // namespace sonard::render
