// SPDX-License-Identifier: Apache-2.0
// Which surfaces of a mesh hide their inner side, by surfaces whose answer is evident.
#include "renderer/engines/slices/shells.hpp"

#include <cmath>
#include <cstdint>
#include <utility>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

/// Adds four corners in a plane, of which the front turns counter-clockwise, with corners of their own.
void add_quad(TriangleMesh& mesh, const glm::vec3& corner, const glm::vec3& a, const glm::vec3& b) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(), {corner, corner + a, corner + a + b, corner + b});
  for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) {
    mesh.indices.push_back(first + i);
  }
}

/// A cube whose front sides are outside.
void add_cube(TriangleMesh& mesh, const glm::vec3& low, float size, int faces = 6) {
  const glm::vec3 x(size, 0, 0), y(0, size, 0), z(0, 0, size), high = low + x + y + z;
  const std::pair<glm::vec3, std::pair<glm::vec3, glm::vec3>> sides[] = {
      {low, {y, x}}, {low, {x, z}}, {low, {z, y}}, {high, {-x, -y}}, {high, {-z, -x}}, {high, {-y, -z}}};
  for (int i = 0; i < faces; ++i) {
    add_quad(mesh, sides[i].first, sides[i].second.first, sides[i].second.second);
  }
}

TriangleMesh cube(int faces = 6) {
  TriangleMesh mesh;
  add_cube(mesh, {1, 1, 1}, 2, faces);
  return mesh;
}

TriangleMesh turned_inside_out(TriangleMesh mesh) {
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    std::swap(mesh.indices[t + 1], mesh.indices[t + 2]);
  }
  return mesh;
}

/// Heights over a grid of cells x cells metres; `keep(i, j)` leaves cells out.
template <class Height, class Keep>
TriangleMesh bed(int cells, const Height& height, const Keep& keep) {
  TriangleMesh mesh;
  const auto at = [&](int i, int j) { return glm::vec3(i, j, height(i, j)); };
  for (int i = 0; i < cells; ++i) {
    for (int j = 0; j < cells; ++j) {
      if (keep(i, j)) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        mesh.positions.insert(mesh.positions.end(), {at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) {
          mesh.indices.push_back(first + k);
        }
      }
    }
  }
  return mesh;
}
float hills(int i, int j) {
  return 0.5F * std::sin(static_cast<float>(i)) * std::cos(static_cast<float>(j));
}
bool everywhere(int, int) {
  return true;
}

TEST(Shells, AClosedSurfaceHidesItsInnerSideFromOutside) {
  const Shells shells(cube());
  ASSERT_EQ(shells.all().size(), 1U);
  const Shell& shell = shells.all().front();
  EXPECT_EQ(shell.kind, Shell::Kind::closed);
  EXPECT_EQ(shell.outwards, 1.0F);
  EXPECT_EQ(shells.of_triangle(11), 0U);
  EXPECT_TRUE(shell.hides_inner_side({0, 2, 2}));
  EXPECT_TRUE(shell.hides_inner_side({2, 2, 3.5F}));
  EXPECT_FALSE(shell.hides_inner_side({2, 2, 2})) << "inside";
  EXPECT_FALSE(shell.hides_inner_side({2, 2, 3.0005F})) << "nearer than rounding";
}

TEST(Shells, TheWindingMayPointInwards) {
  const Shells shells(turned_inside_out(cube()));
  ASSERT_EQ(shells.all().size(), 1U);
  EXPECT_EQ(shells.all().front().outwards, -1.0F);
}

TEST(Shells, FarFromTheOriginTheSideIsTheSame) {
  TriangleMesh mesh = cube();
  for (glm::vec3& p : mesh.positions) {
    p = p * 0.25F + glm::vec3(-40000, 30000, 20000);
  }
  ASSERT_EQ(Shells(mesh).all().size(), 1U);
  EXPECT_EQ(Shells(mesh).all().front().outwards, 1.0F);
}

// As a seam of a generated mesh: sin(2 pi) is not sin(0) in floats.
TEST(Shells, CornersThatDifferByRoundingAreOne) {
  TriangleMesh mesh = cube();
  for (std::size_t i = 0; i < mesh.positions.size(); i += 5) {
    mesh.positions[i] += glm::vec3(3e-7F, -3e-7F, 3e-7F);
  }
  EXPECT_EQ(Shells(mesh).all().size(), 1U);
  mesh.positions[0].x += 1e-4F;
  EXPECT_TRUE(Shells(mesh).all().empty()) << "a gap";
}

TEST(Shells, AnOpenSurfaceShowsBothSides) {
  const Shells shells(cube(5));
  EXPECT_TRUE(shells.all().empty());
  EXPECT_EQ(shells.of_triangle(0), Shells::none);
}

TEST(Shells, AFaceThatWindsAgainstTheOthersOpensIt) {
  TriangleMesh mesh = cube();
  std::swap(mesh.indices[0], mesh.indices[1]);
  EXPECT_TRUE(Shells(mesh).all().empty());
}

TEST(Shells, OneMeshMayHaveSeveral) {
  TriangleMesh mesh = cube();
  add_cube(mesh, {5, 5, 5}, 1);           // apart
  add_cube(mesh, {3, 3, 3}, 1);           // touches the first in a corner
  add_cube(mesh, {1.5F, 1.5F, 1.5F}, 1);  // inside the first
  add_cube(mesh, {9, 9, 9}, 1, 4);        // open
  const Shells shells(mesh);
  EXPECT_EQ(shells.all().size(), 4U);
  EXPECT_EQ(shells.of_triangle(0), 0U);
  EXPECT_EQ(shells.of_triangle(12), 1U);
  EXPECT_EQ(shells.of_triangle(48), Shells::none);
}

TEST(Shells, AnEdgeOfFourFacesLeavesItOpen) {
  TriangleMesh mesh = cube();
  add_cube(mesh, {3, 3, 1}, 2);  // shares the upright edge at (3, 3)
  EXPECT_TRUE(Shells(mesh).all().empty());
}

TEST(Shells, TrianglesWithoutAreaAreOfNone) {
  TriangleMesh mesh = cube();
  mesh.indices.insert(mesh.indices.end(), {0, 0, 1});
  const Shells shells(mesh);
  ASSERT_EQ(shells.all().size(), 1U);
  EXPECT_EQ(shells.of_triangle(12), Shells::none);
}

TEST(Shells, ABedHidesItsUndersideFromAboveItsFootprint) {
  for (const bool upside_down : {false, true}) {
    const TriangleMesh mesh = bed(6, hills, everywhere);
    const Shells shells(upside_down ? turned_inside_out(mesh) : mesh);
    ASSERT_EQ(shells.all().size(), 1U);
    const Shell& shell = shells.all().front();
    EXPECT_EQ(shell.kind, Shell::Kind::bed);
    EXPECT_EQ(shell.outwards, upside_down ? -1.0F : 1.0F);
    EXPECT_TRUE(shell.hides_inner_side({3, 3, 1}));
    EXPECT_FALSE(shell.hides_inner_side({3, 3, 0.2F})) << "below its highest point";
    EXPECT_FALSE(shell.hides_inner_side({7, 3, 1})) << "beside it: rays pass below its edge";
    EXPECT_FALSE(shell.hides_inner_side({3, 3, -5})) << "below";
  }
}

TEST(Shells, ABedWithAHoleOrABayShowsItsUnderside) {
  EXPECT_TRUE(Shells(bed(6, hills, [](int i, int j) { return i != 3 || j != 3; })).all().empty());
  EXPECT_TRUE(Shells(bed(6, hills, [](int i, int j) { return i != 5 || j != 3; })).all().empty());
  EXPECT_TRUE(Shells(bed(6, hills, [](int i, int j) { return i < 3 || j < 3; })).all().empty()) << "an L";
}

TEST(Shells, AnOverhangIsNoBed) {
  TriangleMesh mesh = bed(4, hills, everywhere);
  for (glm::vec3& p : mesh.positions) {
    p.x += p == glm::vec3(2, 2, p.z) ? 1.5F : 0.0F;  // one corner is pulled over its neighbours
  }
  EXPECT_TRUE(Shells(mesh).all().empty());
}

// A ramp that winds around an axis, one and a half turns: each place of its outline turns left.
TEST(Shells, ASpiralIsNoBed) {
  TriangleMesh mesh;
  constexpr int steps = 30;
  const auto at = [](int i, float radius) {
    const float angle = static_cast<float>(i) * 0.314F;
    return glm::vec3(radius * std::cos(angle), radius * std::sin(angle), 0.1F * static_cast<float>(i));
  };
  for (int i = 0; i < steps; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {at(i, 1), at(i, 2), at(i + 1, 2), at(i + 1, 1)});
    for (const std::uint32_t k : {0U, 1U, 2U, 0U, 2U, 3U}) {
      mesh.indices.push_back(first + k);
    }
  }
  EXPECT_TRUE(Shells(mesh).all().empty());
}

}  // namespace
}  // namespace sonard::render
