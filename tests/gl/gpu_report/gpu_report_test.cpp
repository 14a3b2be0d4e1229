// SPDX-License-Identifier: Apache-2.0
// The report on both engines, for a small fan over the scene `plane`.
#include "tests/bench/gpu_report.hpp"

#include <gtest/gtest.h>

#include "tests/bench/gpu_cost.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::bench {
namespace {

test::Scene small_plane() {
  test::Scene scene = test::make_scene("plane");
  scene.name = "small_plane";
  scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(8, 0.3);
  scene.settings.range = {100, 0.2, 0, false};
  return scene;
}

TEST(GpuReport, HasARowForEveryPreset) {
  test::require_gl();
  if (::testing::Test::IsSkipped() || ::testing::Test::HasFatalFailure()) {
    return;
  }
  GpuReport report;
  const std::vector<Point> points = {preset_points().front(), default_point()};
  measure_in_turns(small_plane(), points, nullptr, {1, 1, 0}, report);
  const std::string page = format_gpu_report(report);
  for (const char* preset : {"fast", "default"}) {
    EXPECT_NE(page.find(std::string("| `small_plane` | ") + preset), std::string::npos) << page;
    for (const char* engine : {"cpu", "gpu"}) {
      EXPECT_TRUE(report.results.find({"small_plane", engine, preset}, "ping_ms_p90"));
    }
    const auto work = find_work(report.results, {"small_plane", "gpu", preset});
    ASSERT_TRUE(work);
    EXPECT_GT(work->samples, 0);
    EXPECT_GE(work->cpu_part_ms, 0);
  }
}

}  // namespace
}  // namespace sonard::bench
