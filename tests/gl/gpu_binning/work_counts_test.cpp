// SPDX-License-Identifier: Apache-2.0
// Work counts of engine `gpu` in front of a wall that fills the fan.
#include <vector>

#include <gtest/gtest.h>

#include "renderer/pipeline/sonar_renderer.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

constexpr int beams = 8, lines = 100;
constexpr unsigned views = 2, columns = 32, rows = 64;
constexpr unsigned image_header_bytes = 5 * 4;  // five counts

class WorkCounts : public ::testing::Test {
 protected:
  void SetUp() override {
    test::require_gl();
    request_.settings.aperture.beam_edges_rad = equal_angle_edges(beams, 0.3);
    request_.settings.range = {lines, 0.2, 0, false};
    request_.settings.sampling = Sampling::of_grid(views, columns, rows);
  }

  /// Counts of the second of two pings, which finds the data of the first on the GPU.
  PingStatistics of_a_ping() const {
    const World world = test::make_world(
        {test::make_body("wall", test::make_quad({10, -80, -80}, {0, 160, 0}, {0, 0, 160})),
         test::make_body("too far away", test::make_quad({30, -80, -80}, {0, 160, 0}, {0, 0, 160})),
         test::make_body("behind", test::make_quad({-10, -0.1F, -0.1F}, {0, 0.2F, 0}, {0, 0, 0.2F}))});
    SonarRenderer renderer(world, {EngineKind::gpu});
    PingRequest request = request_;
    renderer.render_echo(request);
    request.T_world_sonar.position_m.x += 0.001;
    renderer.render_echo(request);
    return renderer.last_statistics();
  }

  PingRequest request_;
};

TEST_F(WorkCounts, OfAFixedGridAreExact) {
  const PingStatistics work = of_a_ping();
  EXPECT_EQ(work.passes, 1U);
  EXPECT_EQ(work.views, views);
  EXPECT_EQ(work.pixels, views * columns * rows);
  EXPECT_EQ(work.draw_calls, views);  // one wall
  EXPECT_EQ(work.triangles, 2 * views);
  EXPECT_EQ(work.bytes_uploaded, image_header_bytes);
  EXPECT_EQ(work.bytes_read_back, image_header_bytes + sizeof(float) * beams * lines);
  EXPECT_EQ(work.synchronisations, 1U);
  EXPECT_GT(work.preparing_s, 0.0);
  EXPECT_LT(work.preparing_s, work.visibility_s + work.binning_s);
}

TEST_F(WorkCounts, APointIsAddedToTwoSumsOfTwoWords) {
  request_.settings.sampling.footprint = false;
  const PingStatistics work = of_a_ping();
  EXPECT_GT(work.samples, 0U);
  EXPECT_GE(work.atomic_additions, 2 * work.samples);
  EXPECT_LE(work.atomic_additions, 4 * work.samples);
}

TEST_F(WorkCounts, OfAPresetGrowWithItsPasses) {
  request_.settings.sampling = {};
  const PingStatistics work = of_a_ping();
  EXPECT_GE(work.views, work.passes);
  EXPECT_GT(work.pixels, 0U);
  EXPECT_GT(work.atomic_additions, work.samples);
}

TEST_F(WorkCounts, AreThoseOfOnePing) {
  const PingStatistics once = of_a_ping(), again = of_a_ping();
  EXPECT_EQ(once.views, again.views);
  EXPECT_EQ(once.triangles, again.triangles);
  // A carry may cancel an addition to a high word; whether it does depends on the order of threads.
  EXPECT_NEAR(static_cast<double>(again.atomic_additions), static_cast<double>(once.atomic_additions),
              0.01 * static_cast<double>(once.atomic_additions));
}

}  // namespace
}  // namespace sonard::render
