// SPDX-License-Identifier: Apache-2.0
// Temporary files for one test, and measures of meshes.
#pragma once

#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "renderer/scene/world.hpp"
#include "tests/support/temporary_folder.hpp"

namespace sonard::render::test {

class TempFolder : public sonard::test::TemporaryFolder {
 public:
  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = path() / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }
};

inline glm::dvec3 corner(const TriangleMesh& mesh, std::size_t index) {
  return glm::dvec3(mesh.positions[mesh.indices[index]]);
}

/// Normal of a triangle by the right-hand rule, twice its area long.
inline glm::dvec3 area_normal(const TriangleMesh& mesh, std::size_t triangle) {
  const glm::dvec3 a = corner(mesh, 3 * triangle);
  return glm::cross(corner(mesh, 3 * triangle + 1) - a, corner(mesh, 3 * triangle + 2) - a);
}

inline double area_m2(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    sum += 0.5 * glm::length(area_normal(mesh, t));
  }
  return sum;
}

/// Volume by the divergence theorem; positive if a closed surface is wound outward.
inline double volume_m3(const TriangleMesh& mesh) {
  double sum = 0.0;
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    sum += glm::dot(corner(mesh, 3 * t), area_normal(mesh, t)) / 6.0;
  }
  return sum;
}

struct Bounds {
  glm::dvec3 low{std::numeric_limits<double>::infinity()};
  glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

inline Bounds bounds(const TriangleMesh& mesh) {
  Bounds box;
  for (const glm::vec3& p : mesh.positions) {
    box.low = glm::min(box.low, glm::dvec3(p));
    box.high = glm::max(box.high, glm::dvec3(p));
  }
  return box;
}

}  // namespace sonard::render::test
