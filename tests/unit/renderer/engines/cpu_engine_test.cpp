// SPDX-License-Identifier: Apache-2.0
// Only a fixed grid, which traces rays, builds search trees.
#include "renderer/engines/cpu/cpu_engine.hpp"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

bool echoes(const MeanEcho& echo) {
  return std::any_of(echo.image.intensity.begin(), echo.image.intensity.end(),
                     [](float intensity) { return intensity > 0; });
}

TEST(CpuEngine, OnlyAFixedGridBuildsSearchTrees) {
  WorkerPool workers(1);
  SpatialIndex index(
      test::make_world({test::make_body("wall", test::make_quad({5, -9, -9}, {0, 18, 0}, {0, 0, 18}))}),
      workers);
  CpuEngine engine(index, workers, {});
  SonarSettings settings;
  settings.aperture.beam_edges_rad = equal_angle_edges(8, 1.0);
  settings.range = {500, 0.02, 0, false};
  const std::vector<float> unweighted;
  MeanEcho echo;
  PingStatistics statistics;
  engine.image({{}, settings, unweighted}, echo, statistics);
  EXPECT_TRUE(echoes(echo));
  EXPECT_FALSE(index.is_built());

  settings.sampling = Sampling::of_grid(3, 64, 64);
  engine.image({{}, settings, unweighted}, echo, statistics);
  EXPECT_TRUE(echoes(echo));
  EXPECT_TRUE(index.is_built());
}

}  // namespace
}  // namespace sonard::render
