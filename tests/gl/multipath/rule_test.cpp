// SPDX-License-Identifier: Apache-2.0
// SkipRule::multipath: without mirrors nothing is traced, and the omitted echo is below the rule's bound.
#include <algorithm>
#include <cmath>

#include "tests/gl/multipath/multipath_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

class MultipathRule : public EngineTest {
 protected:
  static RendererOptions without_the_rule() {
    RendererOptions off = options();
    off.skip.turn_off(SkipRule::multipath);
    return off;
  }
  static std::uint64_t skipped(const SonarRenderer& renderer) {
    return renderer.last_statistics().skipped.of(SkipRule::multipath);
  }
};
INSTANTIATE_TEST_SUITE_P(Skipping, MultipathRule, all_engines(), engine_name);

/// A bed 5 m below the sonar and a post on it.
World bed_and_post(double reflection, double rms_height_m) {
  return make_world({smooth_body("bed", make_quad({-60, -60, -5}, {120, 0, 0}, {0, 120, 0}), reflection,
                                 rms_height_m, 0.01),
                     rough_body("post", make_quad({12, -0.5F, -5}, {0, 1, 0}, {0, 0, 3}))});
}

std::vector<float> without_multipath(SonarRenderer& renderer, PingRequest request) {
  request.settings.physical.multipath.level = MultipathSettings::Level::off;
  return renderer.render_echo(request).intensity;
}

// At 5 m over the bed and 20 m of range the least grazing angle is asin(1/4): P = 2 k sigma / 4.
TEST_P(MultipathRule, RoughMaterialIsSkippedAndCounted) {
  const PingRequest request = fan_request(128, 60, 20, 0.05);
  const double k = 2 * std::numbers::pi / request.settings.physical.multipath.wavelength_m;
  const double reflection = 0.38;
  // R^2 exp(-P^2) = 10^-1.5
  const double edge_sigma_m =
      std::sqrt(std::log(reflection * reflection / std::pow(10, -1.5))) / (2 * k * 0.25);
  SonarRenderer rough(bed_and_post(reflection, 1.02 * edge_sigma_m), options());
  const std::vector<float> image = rough.render_echo(request).intensity;
  EXPECT_EQ(skipped(rough), 1u);
  EXPECT_EQ(image, without_multipath(rough, request));
  EXPECT_EQ(skipped(rough), 0u);  // with the effect off there is nothing to skip

  SonarRenderer smooth(bed_and_post(reflection, 0.98 * edge_sigma_m), options());
  smooth.render_echo(request);
  EXPECT_EQ(skipped(smooth), 0u);

  // The same surface from a fifth of the height, or at twice the range, is a mirror again.
  PingRequest low = request;
  low.T_world_sonar.position_m.z = -4;
  rough.render_echo(low);
  EXPECT_EQ(skipped(rough), 0u);
  PingRequest far = request;
  far.settings.range.count *= 2;
  rough.render_echo(far);
  EXPECT_EQ(skipped(rough), 0u);
}

TEST_P(MultipathRule, MirrorOutOfRangeIsSkipped) {
  World world = make_world({smooth_body("mirror", make_quad({30, -5, -5}, {0, 10, 0}, {0, 0, 10})),
                            rough_body("post", make_quad({12, -0.5F, -5}, {0, 1, 0}, {0, 0, 9}))});
  const PingRequest request = fan_request(128, 20, 20, 0.05);
  SonarRenderer renderer(world, options());
  renderer.render_echo(request);
  EXPECT_EQ(skipped(renderer), 1u);
  ASSERT_TRUE(renderer.set_body_pose("mirror", {{-15, 0, 0}, {1, 0, 0, 0}}));
  renderer.render_echo(request);
  EXPECT_EQ(skipped(renderer), 0u);
}

TEST_P(MultipathRule, DefaultMaterialHasNoImage) {
  World world = make_world({make_body("bed", make_quad({-60, -60, -5}, {120, 0, 0}, {0, 120, 0}))});
  SonarRenderer renderer(world, options());
  renderer.render_echo(fan_request(64, 60, 20, 0.05));
  EXPECT_EQ(skipped(renderer), 1u);
}

// On a rough bed the rule omits no more than its bound, relative to the strongest echo.
TEST_P(MultipathRule, WhatIsLeftOutIsBelowTheBound) {
  const PingRequest request = fan_request(128, 60, 20, 0.05);
  const World world = bed_and_post(0.38, 0.001);
  SonarRenderer renderer(world, options());
  SonarRenderer off(world, without_the_rule());
  const std::vector<float> with = renderer.render_echo(request).intensity;
  ASSERT_EQ(skipped(renderer), 1u);
  const std::vector<float> without = off.render_echo(request).intensity;
  EXPECT_EQ(skipped(off), 0u);
  const float most = *std::max_element(with.begin(), with.end());
  double difference = 0.0;
  for (std::size_t i = 0; i < with.size(); ++i) {
    difference = std::max(difference, static_cast<double>(std::abs(with[i] - without[i])));
  }
  EXPECT_GT(difference, 0.0);
  EXPECT_LT(difference, entry_of(SkipRule::multipath).bound * static_cast<double>(most));
}

TEST_P(MultipathRule, PaperNeverHasMultipath) {
  World world = make_world({smooth_body("floor", make_quad({-20, -20, -1}, {40, 0, 0}, {0, 40, 0})),
                            smooth_body("wall", make_quad({8, -20, -1}, {0, 40, 0}, {0, 0, 10}))});
  PingRequest request = fan_request(128, 20, 12, 0.05);
  request.settings.model = Model::paper;
  SonarRenderer renderer(world, options());
  const std::vector<float> image = renderer.render_echo(request).intensity;
  EXPECT_EQ(skipped(renderer), 0u);
  EXPECT_EQ(image, without_multipath(renderer, request));
}

// With level `surface` the water surface is the only mirror.
TEST_P(MultipathRule, LevelSurfaceLeavesMeshesOut) {
  World world = bed_and_post(1.0, 0.0);
  world.water_surface_z_m = 2;
  PingRequest request = fan_request(64, 60, 20, 0.05);
  SonarRenderer renderer(world, options());
  World dull = bed_and_post(0.0, 0.0);
  dull.water_surface_z_m = 2;
  SonarRenderer dull_renderer(dull, options());
  const std::vector<float> full = renderer.render_echo(request).intensity;
  const std::vector<float> water_alone = dull_renderer.render_echo(request).intensity;
  EXPECT_NE(full, water_alone);
  request.settings.physical.multipath.level = MultipathSettings::Level::surface;
  EXPECT_EQ(renderer.render_echo(request).intensity, water_alone);
  // Above the water there is no mirror.
  request.T_world_sonar.position_m.z = 3;
  renderer.render_echo(request);
  EXPECT_EQ(skipped(renderer), 1u);
}

}  // namespace
}  // namespace sonard::render
