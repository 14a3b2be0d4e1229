// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/tessellation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace sonard::render {
namespace {

/// A parallelogram of two triangles with a corner at the origin.
TriangleMesh quad(const glm::vec3& a, const glm::vec3& b) {
  TriangleMesh mesh;
  mesh.positions = {glm::vec3(0.0F), a, a + b, b};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

double summed_area_m2(const TriangleMesh& mesh) {
  double twice = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const glm::dvec3 a(mesh.positions[mesh.indices[i]]);
    twice += glm::length(glm::cross(glm::dvec3(mesh.positions[mesh.indices[i + 1]]) - a,
                                    glm::dvec3(mesh.positions[mesh.indices[i + 2]]) - a));
  }
  return twice / 2;
}

double longest_edge_m(const TriangleMesh& mesh) {
  double longest = 0;
  for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
    const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
    longest = std::max(longest, static_cast<double>(glm::distance(mesh.positions[mesh.indices[i]],
                                                                  mesh.positions[mesh.indices[next]])));
  }
  return longest;
}

TEST(Tessellation, FlatSurfaceKeepsItsAreaInShortEdges) {
  const TriangleMesh bed = quad({40, 0, 0}, {0, 7, 0});
  const TriangleMesh divided = tessellated(bed, 1.5F);
  EXPECT_LE(longest_edge_m(divided), 1.5);
  EXPECT_NEAR(summed_area_m2(divided), 280, 1e-6);
  EXPECT_LT(divided.triangle_count(), 280 / (1.5 * 1.5) * 16) << "not smaller than asked for";
}

TEST(Tessellation, ShortEnoughTrianglesStayAsTheyAre) {
  const TriangleMesh bed = quad({1, 0, 0}, {0, 1, 0});
  const TriangleMesh same = tessellated(bed, 2.0F);
  EXPECT_EQ(same.positions, bed.positions);
  EXPECT_EQ(same.indices, bed.indices);
}

// Each edge occurs once in each direction, before and after, so halved edges leave no gap.
TEST(Tessellation, ClosedSurfaceStaysClosedAndFacesOutwards) {
  TriangleMesh ball;  // an octahedron, stretched so that edges of one triangle differ
  ball.positions = {{9, 0, 0}, {-9, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 1}, {0, 0, -1}};
  ball.indices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const TriangleMesh divided = tessellated(ball, 1.1F);
  EXPECT_GT(divided.triangle_count(), 64u);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
  for (std::size_t i = 0; i < divided.indices.size(); ++i) {
    ++edges[{divided.indices[i], divided.indices[i % 3 == 2 ? i - 2 : i + 1]}];
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_NEAR(summed_area_m2(divided), summed_area_m2(ball), 1e-4);
}

TEST(Tessellation, NormalsAndTextureCoordinatesAreInterpolated) {
  TriangleMesh bed = quad({4, 0, 0}, {0, 4, 0});
  bed.normals = {{1, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}};
  bed.texcoords = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  bed.tangents.assign(4, {0, 1, 0, -1});
  const TriangleMesh divided = tessellated(bed, 0.7F);
  ASSERT_TRUE(divided.can_be_mapped());
  ASSERT_EQ(divided.tangents.size(), divided.positions.size());
  for (std::size_t i = 0; i < divided.positions.size(); ++i) {
    EXPECT_NEAR(glm::length(divided.normals[i]), 1, 1e-6);
    EXPECT_NEAR(divided.texcoords[i].x, divided.positions[i].x / 4, 1e-6);
    EXPECT_NEAR(divided.texcoords[i].y, divided.positions[i].y / 4, 1e-6);
    EXPECT_EQ(divided.tangents[i], glm::vec4(0, 1, 0, -1));
  }
}

}  // namespace
}  // namespace sonard::render
