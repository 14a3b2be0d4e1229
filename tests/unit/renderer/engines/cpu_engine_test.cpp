// SPDX-License-Identifier: Apache-2.0
// Only a fixed grid, which traces rays, builds search trees.
#include "renderer/engines/cpu/cpu_engine.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

bool echoes(const MeanEcho& echo) {
  return std::any_of(echo.image.intensity.begin(), echo.image.intensity.end(),
                     [](float intensity) { return intensity > 0; });
}

/// An engine that looks at one body.
struct View {
  explicit View(TriangleMesh mesh)
      : index(test::make_world({test::make_body("body", std::move(mesh))}), workers) {
    settings.aperture.beam_edges_rad = equal_angle_edges(8, 1.0);
    settings.range = {1500, 0.02, 0, false};
  }

  const MeanEcho& image() {
    PingStatistics statistics;
    engine.image({{}, settings}, echo, statistics);
    return echo;
  }

  WorkerPool workers{1};
  SpatialIndex index;
  CpuEngine engine{index, workers, {}};
  SonarSettings settings;
  MeanEcho echo;
};

/// A corner at the sonar has no direction, and one above it no azimuth. Run with sanitizers, too.
TEST(CpuEngine, CornersAtAndAboveTheSonarCostNoEcho) {
  for (const glm::vec3& corner_m : {glm::vec3(0, 0, 0), glm::vec3(0, 0, 2), glm::vec3(0, 0, -2)}) {
    TriangleMesh hull;
    hull.positions = {corner_m, {25, 0, -3}, {25, 6, 3}, {25, -6, 3}};
    hull.indices = {0, 1, 2, 0, 1, 3, 0, 2, 3, 1, 2, 3};
    View view(std::move(hull));
    const MeanEcho& echo = view.image();
    EXPECT_TRUE(echoes(echo)) << corner_m.z;
    EXPECT_TRUE(std::ranges::all_of(echo.image.intensity, [](float x) { return std::isfinite(x); }));
  }
}

TEST(CpuEngine, OnlyAFixedGridBuildsSearchTrees) {
  View view(test::make_quad({5, -9, -9}, {0, 18, 0}, {0, 0, 18}));
  EXPECT_TRUE(echoes(view.image()));
  EXPECT_FALSE(view.index.is_built());

  view.settings.sampling = Sampling::of_grid(3, 64, 64);
  EXPECT_TRUE(echoes(view.image()));
  EXPECT_TRUE(view.index.is_built());
}

}  // namespace
}  // namespace sonard::render
