// SPDX-License-Identifier: Apache-2.0
#include "renderer/scene/terrain.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include <gtest/gtest.h>

#include "renderer/scene/heightfield.hpp"
#include "tests/unit/renderer/scene/scene_files.hpp"

namespace sonard::render {
namespace {

constexpr glm::dvec3 size_m(60.0, 58.0, 8.0);

/// 3 x 3 tiles; the last row and column are smaller and have odd sides. Nowhere smooth.
GreyImage rough_picture() {
  GreyImage picture{300, 290, {}};
  std::uint32_t random = 1;
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      random = random * 1664525U + 1013904223U;
      picture.value.push_back(static_cast<std::uint16_t>(
          20000 + 15000 * std::sin(0.05 * x) * std::cos(0.03 * y) + (random >> 20)));
    }
  }
  return picture;
}

/// Tiles at various levels; each side has the coarser level of its two tiles.
std::vector<TriangleMesh> meshes_of(const Terrain& terrain, int seed) {
  const auto columns = terrain.columns(), rows = terrain.rows();
  const auto level = [&](int column, int row) {
    return (seed + 5 * column + 7 * row * row + column * row) % (Terrain::coarsest_level + 1);
  };
  std::vector<TriangleMesh> meshes;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const int own = level(column, row);
      const auto with = [&](int c, int r) {
        return c < 0 || r < 0 || c == columns || r == rows ? own : std::max(own, level(c, r));
      };
      meshes.push_back(terrain.mesh(meshes.size(), {own,
                                                    {with(column - 1, row), with(column + 1, row),
                                                     with(column, row - 1), with(column, row + 1)}}));
    }
  }
  return meshes;
}

using Point = std::tuple<float, float, float>;

Point point(const glm::vec3& p) {
  return {p.x, p.y, p.z};
}

bool on_rim(const glm::vec3& a, const glm::vec3& b) {
  const auto both = [](float p, float q, double at) {
    return std::abs(std::abs(static_cast<double>(p)) - at) < 1e-4 && p == q;
  };
  return both(a.x, b.x, size_m.x / 2) || both(a.y, b.y, size_m.y / 2);
}

// A surface has no gap if two triangles share each edge, to the bit, and run along it in opposite directions.
// Edges on the rim have one triangle.
TEST(Terrain, HasNoGapsBetweenTilesOfAnyLevels) {
  const Terrain terrain(rough_picture(), size_m, false);
  ASSERT_EQ(terrain.tiles().size(), 9U);
  for (int seed = 0; seed < 12; ++seed) {
    std::map<std::pair<Point, Point>, int> edges;
    double area_m2 = 0.0;
    const std::vector<TriangleMesh> meshes = meshes_of(terrain, seed);
    for (const TriangleMesh& mesh : meshes) {
      for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
        const double seen_from_above = test::area_normal(mesh, t).z / 2;
        ASSERT_GT(seen_from_above, 0.0) << "seed " << seed;
        area_m2 += seen_from_above;
        for (std::size_t k = 0; k < 3; ++k) {
          ++edges[{point(mesh.positions[mesh.indices[3 * t + k]]),
                   point(mesh.positions[mesh.indices[3 * t + (k + 1) % 3]])}];
        }
      }
    }
    EXPECT_NEAR(area_m2, size_m.x * size_m.y, 0.01);
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(count, 1);
      const auto& [a, b] = edge;
      const glm::vec3 from(std::get<0>(a), std::get<1>(a), std::get<2>(a));
      const glm::vec3 to(std::get<0>(b), std::get<1>(b), std::get<2>(b));
      ASSERT_TRUE(edges.count({b, a}) == 1 || on_rim(from, to))
          << "seed " << seed << " at " << from.x << " " << from.y;
    }
  }
}

TEST(Terrain, AtItsFinestIsTheHeightfield) {
  const Terrain terrain(rough_picture(), size_m, false);
  const TriangleMesh whole = make_heightfield(rough_picture(), size_m, {});
  std::map<Point, glm::vec3> normals;
  for (std::size_t i = 0; i < whole.positions.size(); ++i) {
    normals[point(whole.positions[i])] = whole.normals[i];
  }
  std::size_t triangles = 0;
  for (std::size_t tile = 0; tile < terrain.tiles().size(); ++tile) {
    const TriangleMesh mesh = terrain.mesh(tile, {});
    EXPECT_EQ(mesh.triangle_count(), terrain.tiles()[tile].triangles[0]);
    EXPECT_EQ(terrain.tiles()[tile].error_m[0], 0.0F);
    triangles += mesh.triangle_count();
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const auto known = normals.find(point(mesh.positions[i]));
      ASSERT_NE(known, normals.end());
      EXPECT_LT(glm::distance(mesh.normals[i], known->second), 1e-5F);
    }
  }
  EXPECT_EQ(triangles, whole.triangle_count());
}

/// Height of a mesh over a point that lies on it, seen from above.
double height_over(const TriangleMesh& mesh, const glm::dvec3& at) {
  for (std::size_t t = 0; t < mesh.triangle_count(); ++t) {
    const glm::dvec3 a = test::corner(mesh, 3 * t), b = test::corner(mesh, 3 * t + 1),
                     c = test::corner(mesh, 3 * t + 2);
    const auto twice_area = [](const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
      return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    };
    const double all = twice_area(a, b, c), u = twice_area(at, b, c) / all, v = twice_area(a, at, c) / all;
    if (u >= -1e-5 && v >= -1e-5 && u + v <= 1 + 1e-5) {
      return u * a.z + v * b.z + (1 - u - v) * c.z;
    }
  }
  ADD_FAILURE() << "nothing at " << at.x << " " << at.y;
  return 0.0;
}

TEST(Terrain, KnowsHowFarItsLevelsAreOff) {
  const Terrain terrain(rough_picture(), size_m, false);
  constexpr std::size_t smallest = 8;
  const TriangleMesh finest = terrain.mesh(smallest, {});
  double worst_m = 0.0;
  for (int level = 1; level <= Terrain::coarsest_level; ++level) {
    const TriangleMesh mesh = terrain.mesh(smallest, {level, {level, level, level, level}});
    for (const glm::vec3& p : finest.positions) {
      worst_m = std::max(worst_m, std::abs(height_over(mesh, glm::dvec3(p)) - static_cast<double>(p.z)));
    }
    EXPECT_NEAR(worst_m,
                static_cast<double>(terrain.tiles()[smallest].error_m[static_cast<std::size_t>(level)]),
                1e-5);
  }
  EXPECT_GT(worst_m, 0.1);
}

// z = x / 2 is the same at all levels.
TEST(Terrain, OfASlopeIsCoarseWithoutAnError) {
  GreyImage picture{401, 301, {}};
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      picture.value.push_back(static_cast<std::uint16_t>(100 * x));
    }
  }
  const Terrain terrain(std::move(picture), {40, 30, 20}, true);
  for (std::size_t tile = 0; tile < terrain.tiles().size(); ++tile) {
    EXPECT_LT(terrain.tiles()[tile].error_m.back(), 1e-5F);
    const TriangleMesh mesh = terrain.mesh(tile, {5, {5, 5, 5, 5}});
    ASSERT_TRUE(mesh.can_be_mapped());
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      EXPECT_NEAR(glm::distance(mesh.normals[i], glm::normalize(glm::vec3(-1, 0, 2))), 0.0, 1e-4);
      EXPECT_NEAR(glm::distance(glm::vec3(mesh.tangents[i]), glm::normalize(glm::vec3(2, 0, 1))), 0.0, 1e-4);
      EXPECT_EQ(mesh.tangents[i].w, 1.0F);
      EXPECT_NEAR(mesh.texcoords[i].x, mesh.positions[i].x / 40 + 0.5F, 1e-5);
      EXPECT_NEAR(mesh.texcoords[i].y, mesh.positions[i].y / 30 + 0.5F, 1e-5);
    }
  }
}

TEST(Terrain, SmallMapsAreOneMesh) {
  World world;
  std::vector<BodyPart> parts;
  add_heightmap({257, 2, std::vector<std::uint16_t>(514, 7)}, {1, 1, 1}, {}, world, 0, parts);
  EXPECT_EQ(parts.size(), 1U);
  EXPECT_TRUE(world.terrains.empty());
  add_heightmap({258, 2, std::vector<std::uint16_t>(516, 7)}, {1, 1, 1}, {}, world, 0, parts);
  EXPECT_EQ(parts.size(), 4U);
  ASSERT_EQ(world.terrains.size(), 1U);
  EXPECT_EQ(world.terrains[0].first_part, 1U);
  EXPECT_TRUE(world.is_terrain(0, 3));
  EXPECT_FALSE(world.is_terrain(0, 0));
}

TEST(Terrain, RefusesImpossibleSizes) {
  EXPECT_THROW(Terrain(rough_picture(), {0, 1, 1}, false), WorldError);
  EXPECT_THROW(Terrain({1, 400, std::vector<std::uint16_t>(400)}, size_m, false), WorldError);
}

}  // namespace
}  // namespace sonard::render
