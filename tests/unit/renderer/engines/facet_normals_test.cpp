// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/gpu/facet_normals.hpp"

#include <array>
#include <cstddef>
#include <cstdint>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using Corners = std::array<glm::vec3, 3>;

Corners corners_of(const TriangleMesh& mesh, std::size_t triangle) {
  const std::uint32_t* const index = &mesh.indices[3 * triangle];
  return {mesh.positions[index[0]], mesh.positions[index[1]], mesh.positions[index[2]]};
}

/// The same corners in the same winding, whichever is first.
bool same_triangle(const Corners& a, const Corners& b) {
  const auto turned = [&](std::size_t by) { return a == Corners{b[by], b[(by + 1) % 3], b[(by + 2) % 3]}; };
  return turned(0) || turned(1) || turned(2);
}

void expect_normals_of_facets(const TriangleMesh& mesh) {
  const TriangleMesh facets = with_facet_normals(mesh);
  ASSERT_EQ(facets.triangle_count(), mesh.triangle_count());
  ASSERT_EQ(facets.normals.size(), facets.positions.size());
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const Corners corners = corners_of(mesh, t);
    EXPECT_TRUE(same_triangle(corners_of(facets, t), corners)) << t;
    const glm::vec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
    EXPECT_LT(glm::distance(facets.normals[facets.indices[3 * t + 2]], normal), 1e-5F) << t;
  }
}

TEST(FacetNormals, AreThoseOfEachTrianglesLastCorner) {
  expect_normals_of_facets(test::make_quad({1, 2, 3}, {0, 2, 0}, {0, 0, 5}));
  expect_normals_of_facets(test::make_sphere(0.5F, 24));
}

TEST(FacetNormals, TakeHardlyMoreCornersThanTriangles) {
  const TriangleMesh sphere = test::make_sphere(0.5F, 64);
  EXPECT_LT(static_cast<double>(with_facet_normals(sphere).positions.size()),
            1.1 * static_cast<double>(sphere.triangle_count()));
}

TEST(FacetNormals, OfNothingAreNone) {
  EXPECT_TRUE(with_facet_normals({}).indices.empty());
}

}  // namespace
}  // namespace sonard::render
