// SPDX-License-Identifier: Apache-2.0
// A run of the benchmark on a small fan over the plane, whose echo is known.
#include "tests/bench/campaign.hpp"

#include <memory>

#include <gtest/gtest.h>

namespace sonard::bench {
namespace {

constexpr Repetition once{1, 1, 0};

test::Scene small_plane() {
  test::Scene scene = test::make_scene("plane");
  scene.name = "small_plane";
  scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(8, 0.3);
  scene.settings.range = {100, 0.2, 0, false};
  return scene;
}

Subject on_cpu(const std::string& preset) {
  return {"small_plane", "cpu", preset};
}

class SmallCampaign : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    campaign_ = std::make_unique<Campaign>(std::vector{render::EngineKind::cpu}, "/nowhere");
    Plan plan;
    plan.points = {{grid_point(4, 256), once},
                   {point_binning(4, 256), once},
                   {paper_point(), once},
                   {grid_point(1, 64), once, render::EngineKind::gpu}};
    plan.receivers = {{50, "receiver_ms", once}};
    campaign_->run(small_plane(), plan);
  }
  static void TearDownTestSuite() { campaign_.reset(); }

  static std::optional<double> find(const std::string& preset, const std::string& metric) {
    return campaign_->results().find(on_cpu(preset), metric);
  }

  static inline std::unique_ptr<Campaign> campaign_;
};

TEST_F(SmallCampaign, MeasuresTimesSamplesAndMemory) {
  for (const char* metric : {"ping_ms", "ping_ms_p95", "ping_ms_min", "visibility_ms", "binning_ms",
                             "unchanged_ms", "peak_memory"}) {
    ASSERT_TRUE(find("grid_4x256", metric)) << metric;
    EXPECT_GT(*find("grid_4x256", metric), 0) << metric;
  }
  EXPECT_GT(*find("grid_4x256", "samples"), 8 * 4 * 200);
  EXPECT_LT(*find("grid_4x256", "samples"), 8 * 5 * 300);
  EXPECT_EQ(find("grid_4x256", "repeatable"), 1);
  EXPECT_FALSE(find("grid_4x256", "msis_ping_ms"));
  EXPECT_TRUE(find("default", "receiver_ms"));
}

TEST_F(SmallCampaign, ComparesWithTheClosedForm) {
  EXPECT_LT(*find("grid_4x256", "bin_rms"), 0.02);
  EXPECT_LT(*find("grid_4x256", "beam_total_worst"), 0.01);
  EXPECT_EQ(find("grid_4x256", "hole_fraction"), 0);
  EXPECT_GT(*find("point_4x256", "bin_rms"), 5 * *find("grid_4x256", "bin_rms"));
  EXPECT_EQ(find("point_4x256", "samples"), find("grid_4x256", "samples"));
}

TEST_F(SmallCampaign, ThePaperIsMeasuredByItsHolesOnly) {
  EXPECT_TRUE(find("paper", "hole_fraction"));
  EXPECT_FALSE(find("paper", "bin_rms"));
}

TEST_F(SmallCampaign, PointsOfOtherEnginesAreLeftOut) {
  EXPECT_FALSE(find("grid_1x64", "ping_ms"));
  ASSERT_EQ(campaign_->descriptions().size(), 1U);
  EXPECT_NE(campaign_->descriptions().at("cpu").find("Embree"), std::string::npos);
}

TEST(Campaign, WithoutReferenceThereIsNoError) {
  test::Scene scene = small_plane();
  scene.plane.reset();
  Campaign campaign({render::EngineKind::cpu}, "/nowhere");
  campaign.run(scene, {{{grid_point(1, 64), once}}, {}, {}, 1});
  EXPECT_TRUE(campaign.results().find(on_cpu("grid_1x64"), "ping_ms"));
  EXPECT_FALSE(campaign.results().find(on_cpu("grid_1x64"), "bin_rms"));
  EXPECT_FALSE(campaign.results().find(on_cpu("grid_1x64"), "hole_fraction"));
}

TEST(Campaign, APointThatCannotBeGriddedIsLeftOut) {
  Campaign campaign({render::EngineKind::cpu}, "/nowhere");
  campaign.run(small_plane(), {{{grid_point(4, 20'000), once}, {grid_point(1, 64), once}}, {}, {}, 1});
  EXPECT_FALSE(campaign.results().find(on_cpu("grid_4x20000"), "ping_ms"));
  EXPECT_TRUE(campaign.results().find(on_cpu("grid_1x64"), "ping_ms"));
}

TEST(Campaign, AScanningSonarHasAMetricOfItsOwn) {
  test::Scene scene = small_plane();
  scene.settings.aperture.beam_edges_rad = {0.026, -0.026};
  Campaign campaign({render::EngineKind::cpu}, "/nowhere");
  campaign.run(scene, {{{grid_point(4, 64), once}}, {}, {}, 1});
  EXPECT_EQ(campaign.results().find(on_cpu("grid_4x64"), "msis_ping_ms"),
            campaign.results().find(on_cpu("grid_4x64"), "ping_ms"));
}

}  // namespace
}  // namespace sonard::bench
