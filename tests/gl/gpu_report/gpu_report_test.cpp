// SPDX-License-Identifier: Apache-2.0
// The report on both engines, and counts that follow from the geometry of a scene.
#include "tests/bench/gpu_report.hpp"

#include <gtest/gtest.h>

#include "tests/support/engine_test.hpp"

namespace sonard::bench {
namespace {

class GpuReportTest : public ::testing::Test {
 protected:
  void SetUp() override { test::require_gl(); }
};

test::Scene small_plane() {
  test::Scene scene = test::make_scene("plane");
  scene.name = "small_plane";
  scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(8, 0.3);
  scene.settings.range = {100, 0.2, 0, false};
  return scene;
}

TEST_F(GpuReportTest, HasARowForEveryPreset) {
  GpuReport report;
  GpuReportOptions options;
  options.pings = 1;
  options.repeats = 2;
  measure_engines(small_plane(), {preset_points().front(), default_point()}, nullptr, options, report);
  const std::string page = format_gpu_report(report);
  ASSERT_EQ(report.rows.size(), 2U);
  for (const GpuReport::Row& row : report.rows) {
    EXPECT_NE(page.find("| `small_plane` | " + row.preset), std::string::npos) << page;
    for (const char* engine : {"cpu", "gpu"}) {
      EXPECT_TRUE(report.results.find({"small_plane", engine, row.preset}, "ping_ms_p90"));
    }
    EXPECT_EQ(report.results.find({"small_plane", "gpu", row.preset}, "different_repeats"), 0);
    // The stages are disjoint parts of the ping, whose time another clock has taken.
    EXPECT_EQ(row.times.size(), gpu_stages().size());
    for (const std::string& stage : gpu_stages()) {
      EXPECT_GT(row.times.at(stage), 0) << stage;
    }
    EXPECT_NEAR(total_ms(row.times), *report.results.find({"small_plane", "gpu", row.preset}, "ping_ms"),
                1e-6);
  }
}

// One triangle 8 m ahead, larger than the fan, so that each slice cuts one segment and sees all of it. The
// beams are so narrow that one slice each is enough.
TEST_F(GpuReportTest, CountsWhatTheGeometrySays) {
  constexpr int beams = 5, lines = 100;
  render::TriangleMesh triangle;
  triangle.positions = {{8, 50, -30}, {8, -50, -30}, {8, 0, 60}};
  triangle.indices = {0, 1, 2};
  render::SonarSettings settings;
  settings.sampling.preset = render::Sampling::Preset::fast;
  settings.aperture.beam_edges_rad = render::equal_angle_edges(beams, 0.05);
  settings.range = {lines, 0.1, 0, false};
  render::SonarRenderer renderer(test::make_world({test::make_body("wall", triangle)}),
                                 {render::EngineKind::gpu});
  renderer.render_echo({render::Pose{}, settings});
  const render::PingStatistics& ping = renderer.last_statistics();
  const render::GpuWork& work = ping.gpu.work;
  EXPECT_EQ(work.triangles, 1U);
  EXPECT_EQ(work.entries, beams * 1U);
  EXPECT_EQ(work.rounds, 1U);
  EXPECT_GE(work.slices, beams * 1U);
  EXPECT_EQ(work.segments, work.slices);
  EXPECT_EQ(work.visible, work.slices);
  EXPECT_GE(ping.samples, work.slices);
  EXPECT_GE(work.additions, 2 * work.slices);  // the echo of a slice begins and ends
  // Place; two for lists; things; 12 rounds that see and 11 between them that refine; pieces, patches, bin,
  // sums.
  EXPECT_EQ(work.dispatches, 31U);
  EXPECT_EQ(ping.gpu.synchronisations, 1U);
  constexpr std::uint64_t image_bytes = 4ULL * beams * lines;
  EXPECT_GE(ping.gpu.bytes_read_back, image_bytes);
  EXPECT_LE(ping.gpu.bytes_read_back, image_bytes + 100);
  EXPECT_TRUE(ping.gpu.stages_ms.empty());  // nobody has asked for them
}

}  // namespace
}  // namespace sonard::bench
