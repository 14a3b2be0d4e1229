// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/mesh.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// A right triangle of area 1/2 in the plane z = 0.
TriangleMesh one_triangle() {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.indices = {0, 1, 2};
  return mesh;
}

TEST(ValidatedMesh, KeepsGoodTrianglesAsTheyAre) {
  MeshDiagnostics diagnostics;
  const TriangleMesh mesh = validated_mesh(one_triangle(), diagnostics);
  EXPECT_EQ(mesh.positions, one_triangle().positions);
  EXPECT_EQ(mesh.indices, one_triangle().indices);
  EXPECT_EQ(diagnostics.degenerate_triangles + diagnostics.non_finite_triangles + diagnostics.bad_normals,
            0U);
}

TEST(ValidatedMesh, DropsAndCountsDegenerateTriangles) {
  TriangleMesh mesh = one_triangle();
  mesh.positions.insert(mesh.positions.end(), {{2, 0, 0}, {1, 0, 0}, {1e-30F, 1e-30F, 0}});
  mesh.indices.insert(mesh.indices.end(), {0, 1, 1,    // repeated corner
                                           0, 1, 3,    // collinear
                                           1, 4, 2,    // two vertices in one place
                                           0, 5, 2});  // nearly so
  MeshDiagnostics diagnostics;
  mesh = validated_mesh(mesh, diagnostics);
  EXPECT_EQ(mesh.triangle_count(), 1U);
  EXPECT_EQ(mesh.positions.size(), 3U);
  EXPECT_EQ(diagnostics.degenerate_triangles, 4U);
  EXPECT_EQ(diagnostics.non_finite_triangles, 0U);
}

TEST(ValidatedMesh, KeepsALongThinTriangle) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {100, 0, 0}, {50, 0.001F, 0}};
  mesh.indices = {0, 1, 2};
  MeshDiagnostics diagnostics;
  EXPECT_EQ(validated_mesh(mesh, diagnostics).triangle_count(), 1U);
}

TEST(ValidatedMesh, DropsAndCountsNonFiniteTrianglesAndLeavesTheirNeighbours) {
  TriangleMesh mesh = one_triangle();
  mesh.positions.insert(mesh.positions.end(), {{nan, 0, 0},
                                               {0, std::numeric_limits<float>::infinity(), 0},
                                               {0, 0, 1e38F},
                                               {0, 0, 1e-42F}});  // a denormal is a number
  mesh.indices.insert(mesh.indices.end(), {0, 1, 3, 0, 1, 4, 0, 1, 5, 1, 2, 6});
  MeshDiagnostics diagnostics;
  mesh = validated_mesh(mesh, diagnostics);
  EXPECT_EQ(diagnostics.non_finite_triangles, 3U);
  EXPECT_EQ(mesh.triangle_count(), 2U);
  for (const glm::vec3& p : mesh.positions) {
    EXPECT_TRUE(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z));
  }
}

TEST(ValidatedMesh, RepairsNormals) {
  TriangleMesh mesh = one_triangle();
  mesh.normals = {{0, 0, 0}, {nan, 0, 1}, {3, 0, 4}};
  MeshDiagnostics diagnostics;
  mesh = validated_mesh(mesh, diagnostics);
  EXPECT_EQ(diagnostics.bad_normals, 2U);
  EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(mesh.normals[1], glm::vec3(0, 0, 1));
  EXPECT_NEAR(mesh.normals[2].x, 0.6, 1e-6);
  EXPECT_NEAR(mesh.normals[2].z, 0.8, 1e-6);
}

TEST(ValidatedMesh, ASharedBadNormalIsWeightedByArea) {
  // Areas 1/2 (facing z) and 2 (facing x) meet at vertex 0: (2, 0, 0.5) normalised.
  TriangleMesh mesh = one_triangle();
  mesh.positions.insert(mesh.positions.end(), {{0, 2, 0}, {0, 0, 2}});
  mesh.indices.insert(mesh.indices.end(), {0, 3, 4});
  mesh.normals.assign(5, {0, 0, 0});
  MeshDiagnostics diagnostics;
  mesh = validated_mesh(mesh, diagnostics);
  EXPECT_NEAR(mesh.normals[0].x, 2.0 / std::sqrt(4.25), 1e-6);
  EXPECT_NEAR(mesh.normals[0].z, 0.5 / std::sqrt(4.25), 1e-6);
}

TEST(ValidatedMesh, RepairsTextureCoordinates) {
  TriangleMesh mesh = one_triangle();
  mesh.texcoords = {{nan, 1}, {1, 0}, {0, 1}};
  MeshDiagnostics diagnostics;
  mesh = validated_mesh(mesh, diagnostics);
  EXPECT_EQ(diagnostics.bad_texcoords, 1U);
  EXPECT_EQ(mesh.texcoords[0], glm::vec2(0, 0));
  EXPECT_EQ(mesh.texcoords[1], glm::vec2(1, 0));
}

TEST(ValidatedMesh, RefusesWhatHasNoMeaning) {
  MeshDiagnostics diagnostics;
  TriangleMesh mesh = one_triangle();
  mesh.indices[2] = 3;
  EXPECT_THROW(validated_mesh(mesh, diagnostics), WorldError);
  mesh = one_triangle();
  mesh.indices.push_back(0);
  EXPECT_THROW(validated_mesh(mesh, diagnostics), WorldError);
  mesh = one_triangle();
  mesh.normals = {{0, 0, 1}};
  EXPECT_THROW(validated_mesh(mesh, diagnostics), WorldError);
}

/// The unit square in z = 0, facing +z, with the given texture coordinates of (0,0), (1,0), (1,1), (0,1).
TriangleMesh square(const std::vector<glm::vec2>& texcoords) {
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.texcoords = texcoords;
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

TEST(Tangents, PointWhereUGrows) {
  TriangleMesh mesh = square({{0, 0}, {0, -1}, {1, -1}, {1, 0}});  // u = y, v = -x
  add_tangents(mesh);
  ASSERT_EQ(mesh.tangents.size(), mesh.positions.size());
  for (const glm::vec4& tangent : mesh.tangents) {
    EXPECT_NEAR(glm::distance(glm::vec3(tangent), glm::vec3(0, 1, 0)), 0.0, 1e-6);
    // Bitangent = w (n x t) = w (z x y) = -w x, and v grows towards -x.
    EXPECT_EQ(tangent.w, 1.0F);
  }
}

TEST(Tangents, KnowAMirroredTexture) {
  TriangleMesh mesh = square({{0, 0}, {-1, 0}, {-1, 1}, {0, 1}});  // u = -x, v = y
  add_tangents(mesh);
  for (const glm::vec4& tangent : mesh.tangents) {
    EXPECT_NEAR(glm::distance(glm::vec3(tangent), glm::vec3(-1, 0, 0)), 0.0, 1e-6);
    EXPECT_EQ(tangent.w, -1.0F);
  }
}

TEST(Tangents, SplitTheSeamOfAMirroredTexture) {
  // u = |x - 1|: the texture is mirrored along x = 1, where two vertices are shared.
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {1, 1, 0}, {2, 1, 0}};
  mesh.normals.assign(6, {0, 0, 1});
  mesh.texcoords = {{1, 0}, {0, 0}, {1, 0}, {1, 1}, {0, 1}, {1, 1}};
  mesh.indices = {0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4};
  add_tangents(mesh);
  EXPECT_EQ(mesh.positions.size(), 8U);
  ASSERT_EQ(mesh.tangents.size(), 8U);
  for (std::size_t t = 0; t < 4; ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const glm::vec4& tangent = mesh.tangents[mesh.indices[3 * t + k]];
      const float expected = t < 2 ? -1.0F : 1.0F;
      EXPECT_NEAR(tangent.x, expected, 1e-6) << "triangle " << t;
      EXPECT_EQ(tangent.w, expected) << "triangle " << t;
    }
  }
}

TEST(Tangents, ArePerpendicularToTheNormal) {
  TriangleMesh mesh = square({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  mesh.normals.assign(4, glm::normalize(glm::vec3(1, 0, 1)));
  add_tangents(mesh);
  for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
    EXPECT_NEAR(glm::dot(glm::vec3(mesh.tangents[i]), mesh.normals[i]), 0.0, 1e-6);
    EXPECT_NEAR(glm::distance(glm::vec3(mesh.tangents[i]), glm::normalize(glm::vec3(1, 0, -1))), 0.0, 1e-6);
  }
}

TEST(Tangents, AreUnitEvenWhereTheTextureStandsStill) {
  TriangleMesh mesh = square({{0.5F, 0.5F}, {0.5F, 0.5F}, {0.5F, 0.5F}, {0.5F, 0.5F}});
  add_tangents(mesh);
  for (const glm::vec4& tangent : mesh.tangents) {
    EXPECT_NEAR(glm::length(glm::vec3(tangent)), 1.0, 1e-6);
    EXPECT_NEAR(tangent.z, 0.0, 1e-6);
  }
}

TEST(Tangents, MakeFlatNormalsWhereThereAreNone) {
  TriangleMesh mesh = square({{0, 0}, {1, 0}, {1, 1}, {0, 1}});
  mesh.normals.clear();
  add_tangents(mesh);
  EXPECT_EQ(mesh.triangle_count(), 2U);
  ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
  for (const glm::vec3& normal : mesh.normals) {
    EXPECT_EQ(normal, glm::vec3(0, 0, 1));
  }
  EXPECT_NEAR(test::area_m2(mesh), 1.0, 1e-6);
}

}  // namespace
}  // namespace sonard::render
