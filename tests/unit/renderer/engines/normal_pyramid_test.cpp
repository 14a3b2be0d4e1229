// SPDX-License-Identifier: Apache-2.0
#include "renderer/surface/normal_pyramid.hpp"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <glm/geometric.hpp>

namespace sonard::render {
namespace {

NormalMap make_map(int width, int height, const std::vector<glm::dvec3>& normals) {
  NormalMap map;
  map.width_px = width;
  map.height_px = height;
  for (const glm::dvec3& n : normals) {
    for (const double component : {n.x, n.y, n.z}) {
      map.rgb.push_back(static_cast<std::uint8_t>(std::lround((component + 1) * 127.5)));
    }
  }
  return map;
}

constexpr float tolerance = 0.006F;  // of an 8-bit map

void expect_near(const glm::vec3& a, const glm::dvec3& b) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// Two slopes of +-60 degrees: seen from above, each echoes cos 60, and so do both together. Their unit mean
// would echo 1.
TEST(NormalPyramid, KeepsTheMeanEchoOfWhatItAverages) {
  const double s = std::sin(M_PI / 3);
  const NormalPyramid pyramid(make_map(2, 1, {{s, 0, 0.5}, {-s, 0, 0.5}}));
  ASSERT_EQ(pyramid.levels.size(), 2U);
  expect_near(pyramid.mean_normal({0.25F, 0.5F}, 0), {s, 0, 0.5});
  expect_near(pyramid.mean_normal({0.75F, 0.5F}, 0), {-s, 0, 0.5});
  expect_near(pyramid.mean_normal({0.3F, 0.7F}, 1), {0, 0, 0.5});
  expect_near(pyramid.mean_normal({0.25F, 0.5F}, 0.5F), {s / 2, 0, 0.5});
}

TEST(NormalPyramid, MakesTexelsUnitBeforeItAverages) {
  NormalMap map = make_map(1, 1, {{0, 0, 1}});
  map.rgb = {127, 127, 200};  // not of unit length, as some tools write it
  EXPECT_NEAR(glm::length(NormalPyramid(map).mean_normal({0.5F, 0.5F}, 0)), 1, 1e-4);
}

// Odd sizes: every texel counts with the area it covers, so the last level is the mean of all.
TEST(NormalPyramid, EndsInTheMeanOfAllTexelsWhateverTheSize) {
  for (const auto& [width, height] :
       std::vector<std::pair<int, int>>{{7, 5}, {1, 9}, {13, 1}, {6, 10}, {8, 8}}) {
    std::vector<glm::dvec3> normals;
    glm::dvec3 sum(0.0);
    for (int i = 0; i < width * height; ++i) {
      normals.push_back(
          glm::normalize(glm::dvec3(std::sin(1.3 * i * i), std::cos(2.1 * i), 1.1 + std::sin(i))));
      sum += normals.back();
    }
    const NormalPyramid pyramid(make_map(width, height, normals));
    EXPECT_EQ(pyramid.levels.back().width_px * pyramid.levels.back().height_px, 1);
    expect_near(pyramid.mean_normal({0.4F, 0.6F}, 99), sum / double(width * height));
  }
}

TEST(NormalPyramid, IsLinearBetweenTexelCentresAndRepeats) {
  const glm::dvec3 a = glm::normalize(glm::dvec3(0.5, 0, 1));
  const glm::dvec3 b = glm::normalize(glm::dvec3(0, -0.5, 1));
  const NormalPyramid pyramid(make_map(4, 1, {a, a, b, b}));
  expect_near(pyramid.mean_normal({0.5F, 0.5F}, 0), (a + b) / 2.0);
  expect_near(pyramid.mean_normal({0.4375F, 0.5F}, 0), 0.75 * a + 0.25 * b);
  expect_near(pyramid.mean_normal({0.0F, 0.5F}, 0),
              (a + b) / 2.0);  // the last texel is the first one's neighbour
  for (const float u : {0.0F, 0.1F, 0.5F, 0.97F}) {
    const glm::vec3 here = pyramid.mean_normal({u, 0.5F}, 0);
    for (const float turns : {-3.0F, 1.0F, 8.0F}) {
      EXPECT_LT(glm::length(pyramid.mean_normal({u + turns, 0.5F}, 0) - here), 1e-5F) << u << " " << turns;
    }
  }
}

TEST(NormalPyramid, HoldsLevelsThatAreNone) {
  const glm::dvec3 a = glm::normalize(glm::dvec3(0.5, 0, 1));
  const NormalPyramid pyramid(make_map(2, 1, {a, {0, 0, 1}}));
  for (const float level :
       {-std::numeric_limits<float>::infinity(), -3.0F, std::numeric_limits<float>::quiet_NaN()}) {
    expect_near(pyramid.mean_normal({0.25F, 0.5F}, level), a);
  }
  expect_near(pyramid.mean_normal({0.25F, 0.5F}, std::numeric_limits<float>::infinity()),
              (a + glm::dvec3(0, 0, 1)) / 2.0);
}

}  // namespace
}  // namespace sonard::render
