// SPDX-License-Identifier: Apache-2.0
// SkipRule::unchanged_scene: an echo is reused exactly as long as a new one would equal it.
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/gl/skipping/skipping_worlds.hpp"

namespace sonard::render {
namespace {

using namespace test;

class UnchangedScene : public EngineTest {
 protected:
  static RendererOptions without_the_rule() {
    RendererOptions off = options();
    off.skip.turn_off(SkipRule::unchanged_scene);
    return off;
  }
  static std::uint64_t skipped(const SonarRenderer& renderer) {
    return renderer.last_statistics().skipped.of(SkipRule::unchanged_scene);
  }
};
INSTANTIATE_TEST_SUITE_P(Skipping, UnchangedScene, all_engines(), engine_name);

TEST_P(UnchangedScene, EchoIsMadeOnceAndNotCopied) {
  SonarRenderer renderer(bed_and_ball(), options());
  const EchoImage& first = renderer.render_echo(small_request());
  EXPECT_EQ(skipped(renderer), 0u);
  EXPECT_GT(renderer.last_statistics().samples, 0u);
  const std::vector<float> before = first.intensity;
  const EchoImage& second = renderer.render_echo(small_request());
  EXPECT_EQ(skipped(renderer), 1u);
  EXPECT_EQ(renderer.last_statistics().samples, 0u);
  EXPECT_EQ(renderer.last_statistics().seconds.visibility, 0.0);
  EXPECT_EQ(&first, &second);
  EXPECT_EQ(second.intensity, before);
}

TEST_P(UnchangedScene, SwitchedOffItIsMadeAnewAndTheSame) {
  SonarRenderer renderer(bed_and_ball(), options());
  SonarRenderer off(bed_and_ball(), without_the_rule());
  for (int ping = 0; ping < 3; ++ping) {
    EXPECT_EQ(renderer.render_echo(small_request()).intensity, off.render_echo(small_request()).intensity);
    EXPECT_EQ(skipped(off), 0u);
    EXPECT_GT(off.last_statistics().samples, 0u);
  }
  EXPECT_EQ(skipped(renderer), 1u);
}

// Speckle fades as the sonar moves, and noise is new in every ping. The rule does not change the samples.
TEST_P(UnchangedScene, SamplesAreTheSameWithTheRuleOff) {
  SonarRenderer renderer(bed_and_ball(), options());
  SonarRenderer off(bed_and_ball(), without_the_rule());
  PingRequest request = small_request();
  std::vector<std::uint8_t> last;
  for (request.ping_number = 1; request.ping_number <= 6; ++request.ping_number) {
    if (request.ping_number == 4) {
      request.T_world_sonar.position_m.x += 0.02;
    }
    const std::vector<std::uint8_t> samples = renderer.render_ping(request).u8;
    EXPECT_EQ(skipped(renderer), request.ping_number == 1 || request.ping_number == 4 ? 0u : 1u);
    EXPECT_EQ(samples, off.render_ping(request).u8) << "ping " << request.ping_number;
    EXPECT_NE(samples, last) << "noise must differ from ping to ping";
    last = samples;
  }
}

using Change = std::pair<std::string, std::function<void(PingRequest&)>>;

// After a change of anything that the echo depends on, the echo equals one made without the rule.
TEST_P(UnchangedScene, AnythingTheEchoDependsOnMakesItAnew) {
  const std::vector<Change> changes{
      {"position", [](PingRequest& r) { r.T_world_sonar.position_m.z += 1e-9; }},
      {"orientation",
       [](PingRequest& r) {
         r.T_world_sonar.orientation =
             glm::angleAxis(1e-6, glm::dvec3(0, 0, 1)) * r.T_world_sonar.orientation;
       }},
      {"lines", [](PingRequest& r) { r.settings.range.count += 1; }},
      {"step", [](PingRequest& r) { r.settings.range.step_m *= 1.01; }},
      {"beams", [](PingRequest& r) { r.settings.aperture.beam_edges_rad[5] += 1e-4; }},
      {"beamwidth", [](PingRequest& r) { r.settings.aperture.vertical_beamwidth_rad *= 1.1; }},
      {"elevation", [](PingRequest& r) { r.settings.aperture.elevation = Aperture::Elevation::sinc; }},
      {"absorption", [](PingRequest& r) { r.settings.physical.absorption_db_per_m += 0.1; }},
      {"multipath",
       [](PingRequest& r) { r.settings.physical.multipath.level = MultipathSettings::Level::surface; }},
      {"wavelength", [](PingRequest& r) { r.settings.physical.multipath.wavelength_m *= 1.1; }},
      {"waves", [](PingRequest& r) { r.settings.physical.multipath.water_surface_rms_height_m = 0; }},
      {"sampling", [](PingRequest& r) { r.settings.sampling.preset = Sampling::Preset::fast; }},
      {"grid", [](PingRequest& r) { r.settings.sampling = Sampling::of_grid(2, 128, 128); }},
      {"grid rows", [](PingRequest& r) { r.settings.sampling = Sampling::of_grid(2, 128, 256); }},
      {"transmit", [](PingRequest& r) { r.settings.transmit = false; }},
      {"transmit again", [](PingRequest& r) { r.settings.transmit = true; }},
      {"model", [](PingRequest& r) { r.settings.model = Model::paper; }},
      {"sigmoid slope", [](PingRequest& r) { r.settings.paper.sigmoid_slope = 17; }},
      {"sigmoid centre", [](PingRequest& r) { r.settings.paper.sigmoid_centre = 0.6; }},
      {"two-sided", [](PingRequest& r) { r.settings.paper.two_sided = false; }},
      {"attenuation", [](PingRequest& r) { r.settings.paper.attenuation_per_m = 0.02; }},
      {"footprint", [](PingRequest& r) { r.settings.paper.footprint = false; }},
      {"bin index", [](PingRequest& r) { r.settings.paper.legacy_bin_index = true; }},
      {"columns", [](PingRequest& r) { r.settings.paper.legacy_columns = true; }},
      {"mask", [](PingRequest& r) { r.settings.paper.elevation_mask = false; }},
  };
  SonarRenderer renderer(bed_and_ball(), options());
  SonarRenderer off(bed_and_ball(), without_the_rule());
  PingRequest request = small_request();
  renderer.render_echo(request);
  for (const auto& [what, change] : changes) {
    change(request);
    const std::vector<float> image = renderer.render_echo(request).intensity;
    EXPECT_EQ(skipped(renderer), 0u) << what;
    EXPECT_EQ(image, off.render_echo(request).intensity) << what;
    renderer.render_echo(request);
    EXPECT_EQ(skipped(renderer), 1u) << what;
  }
}

TEST_P(UnchangedScene, WhatOnlyTheReceiverLooksAtDoesNot) {
  const std::vector<Change> changes{
      {"ping", [](PingRequest& r) { ++r.ping_number; }},
      {"seed", [](PingRequest& r) { ++r.seed; }},
      {"gain", [](PingRequest& r) { r.settings.physical.gain_db += 3; }},
      {"noise", [](PingRequest& r) { r.settings.physical.noise.on = false; }},
      {"speckle", [](PingRequest& r) { r.settings.physical.speckle.kind = SpeckleSettings::Kind::off; }},
      {"gain law", [](PingRequest& r) { r.settings.physical.tvg.log_coefficient = 40; }},
      {"compression", [](PingRequest& r) { r.settings.range.compression_log2 = 2; }},
      {"bits", [](PingRequest& r) { r.settings.sixteen_bit = true; }},
  };
  SonarRenderer renderer(bed_and_ball(), options());
  PingRequest request = small_request();
  renderer.render_echo(request);
  for (const auto& [what, change] : changes) {
    change(request);
    renderer.render_ping(request);
    EXPECT_EQ(skipped(renderer), 1u) << what;
  }
}

TEST_P(UnchangedScene, BodiesThatMoveMakeItAnewAndBodiesThatRestDoNot) {
  SonarRenderer renderer(bed_and_ball(), options());
  SonarRenderer off(bed_and_ball(), without_the_rule());
  const PingRequest request = small_request();
  renderer.render_echo(request);
  const Pose there{{7, -1, 0.5}, {1, 0, 0, 0}};
  for (SonarRenderer* each : {&renderer, &off}) {
    ASSERT_TRUE(each->set_body_pose("ball", there));
  }
  const std::vector<float> moved = renderer.render_echo(request).intensity;
  EXPECT_EQ(skipped(renderer), 0u);
  EXPECT_EQ(moved, off.render_echo(request).intensity);
  // A publisher may repeat a pose.
  ASSERT_TRUE(renderer.set_body_pose("ball", there));
  EXPECT_FALSE(renderer.set_body_pose("no such body", there));
  renderer.render_echo(request);
  EXPECT_EQ(skipped(renderer), 1u);
}

TEST_P(UnchangedScene, EveryStreamHasItsOwn) {
  SonarRenderer renderer(bed_and_ball(), options());
  PingRequest left = small_request();
  PingRequest right = small_request();
  right.T_world_sonar.position_m.y -= 1;
  const std::vector<float> of_left = renderer.render_echo(left, 0).intensity;
  const std::vector<float> of_right = renderer.render_echo(right, 1).intensity;
  EXPECT_NE(of_left, of_right);
  EXPECT_EQ(renderer.render_echo(left, 0).intensity, of_left);
  EXPECT_EQ(skipped(renderer), 1u);
  EXPECT_EQ(renderer.render_echo(right, 1).intensity, of_right);
  EXPECT_EQ(skipped(renderer), 1u);
}

TEST_P(UnchangedScene, RefusedRequestLeavesTheLastEchoAsItWas) {
  SonarRenderer renderer(bed_and_ball(), options());
  const std::vector<float> image = renderer.render_echo(small_request()).intensity;
  PingRequest bad = small_request();
  bad.settings.range.count = 0;
  EXPECT_THROW(renderer.render_echo(bad), RequestError);
  EXPECT_EQ(renderer.render_echo(small_request()).intensity, image);
}

// The loss table, with slices and with grids; with a grid also the grid.
TEST_P(UnchangedScene, TablesAreKeptWhereTheSceneIsNot) {
  for (const bool grid : {false, true}) {
    RendererOptions off_options = options();
    off_options.skip.turn_off(SkipRule::unchanged_settings);
    SonarRenderer renderer(bed_and_ball(), options());
    SonarRenderer off(bed_and_ball(), off_options);
    PingRequest request = small_request();
    if (grid) {
      request.settings.sampling = Sampling::of_grid(3, 64, 128);
    }
    for (int ping = 0; ping < 3; ++ping) {
      request.T_world_sonar.position_m.x += 0.1;
      EXPECT_EQ(renderer.render_echo(request).intensity, off.render_echo(request).intensity);
      EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::unchanged_settings),
                ping == 0 ? 0u : (grid ? 2u : 1u));
      EXPECT_EQ(off.last_statistics().skipped.of(SkipRule::unchanged_settings), 0u);
    }
  }
}

}  // namespace
}  // namespace sonard::render
