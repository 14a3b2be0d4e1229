// SPDX-License-Identifier: Apache-2.0
// Engine `gpu` chooses the grids of an error preset (docs/accuracy.md).
#include "renderer/engines/gpu/grid_choice.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "tests/bench/image_error.hpp"
#include "tests/bench/reference.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using Preset = Sampling::Preset;

// ---- the first pass

Aperture fan(int beams, double width_rad) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_angle_edges(beams, width_rad);
  return aperture;
}

TEST(FirstPass, NoViewExceedsWhatCanBeDrawnAndNoGridTheMemory) {
  for (const auto& [beams, width_rad] :
       {std::pair{1, 0.05}, {1, 2.5}, {256, 2.0943951}, {512, 6.28}, {4096, 2.4}}) {
    for (const Preset preset : {Preset::fast, Preset::normal, Preset::reference}) {
      const Aperture aperture = fan(beams, width_rad);
      const BeamDensity density = first_density(aperture, preset);
      const BeamRun run = whole_fan(aperture, density);
      EXPECT_GE(density.columns, 2);
      EXPECT_LE(run.rows, 8192);
      EXPECT_LE(run.samples(), 0x1p25);
      for (const ViewSpan& view : run.views) {
        EXPECT_LE(view.columns, 8192);
        EXPECT_LE(view.port_rad - view.starboard_rad, 1.0472);
      }
    }
  }
}

TEST(FirstPass, IsFinerForSmallerErrors) {
  const Aperture aperture = fan(256, 2.0943951);
  EXPECT_EQ(first_density(aperture, Preset::fast), (BeamDensity{2, 512, 0, 0, 0, 0}));
  EXPECT_EQ(first_density(aperture, Preset::normal), (BeamDensity{4, 512, 0, 0, 0, 0}));
  EXPECT_EQ(first_density(aperture, Preset::reference), (BeamDensity{32, 2048, 0, 0, 0, 0}));
}

TEST(FirstPass, RowsAreAsNarrowInATallFan) {
  Aperture tall = fan(64, 1);
  tall.vertical_beamwidth_rad *= 3;
  EXPECT_EQ(first_density(tall, Preset::fast).rows, 3 * first_density(fan(64, 1), Preset::fast).rows);
}

// ---- runs

TEST(BeamRuns, NeighboursThatAreSampledAlikeShareViewsOfFewSizes) {
  const Aperture aperture = fan(256, 2.0943951);
  const BeamDensity coarse{8, 512, 0, 0, 0, 0}, fine{512, 512, 0, 0, 0, 0};
  std::vector<BeamChoice> choices;
  for (int beam = 10; beam < 17; ++beam) {
    choices.push_back({beam, coarse});
  }
  for (int beam = 17; beam < 50; ++beam) {
    choices.push_back({beam, fine});
  }
  choices.push_back({60, fine});
  std::vector<std::pair<int, int>> found;
  for (const BeamRun& run : beam_runs(aperture, choices)) {
    found.emplace_back(run.begin, run.end);
    ASSERT_EQ(run.views.size(), 1u);
    EXPECT_EQ(run.views[0].columns, (run.end - run.begin) * (run.begin < 17 ? 8 : 512));
    EXPECT_EQ(run.views[0].port_rad, aperture.beam_edges_rad[static_cast<std::size_t>(run.begin)]);
    EXPECT_EQ(run.views[0].starboard_rad, aperture.beam_edges_rad[static_cast<std::size_t>(run.end)]);
  }
  EXPECT_EQ(found, (std::vector<std::pair<int, int>>{
                       {10, 14}, {14, 16}, {16, 17}, {17, 33}, {33, 49}, {49, 50}, {60, 61}}));
}

TEST(BeamRuns, ABeamWithAZoneHasAViewOfItAndOneOnEitherSide) {
  const Aperture aperture = fan(4, 0.04);
  const auto& edges = aperture.beam_edges_rad;
  const BeamDensity zone{64, 512, edges[1] - 0.004, edges[1] - 0.005, 2, 4};
  const BeamRun run = beam_runs(aperture, {{1, zone}}).at(0);
  ASSERT_EQ(run.views.size(), 3u);
  EXPECT_EQ(run.views[0].port_rad, edges[1]);
  EXPECT_EQ(run.views[2].starboard_rad, edges[2]);
  // The views cover all of the beam's solid angle once.
  const SampleGrid grid = make_sample_grid(aperture, {run});
  double solid_angle = 0;
  for (const ColumnPart& part : grid.parts) {
    for (int row = part.row_begin; row < part.row_end; ++row) {
      solid_angle += static_cast<double>(grid.weight(part, row));
    }
  }
  const double expected = 0.01 * 2 * std::sin(aperture.elevation_limit_rad());
  EXPECT_NEAR(solid_angle / expected, 1, 1e-5);
}

// ---- beams to refine

constexpr GridTargets one_per_cent{0.01, {0.001, 0.05}};

/// A beam of equal columns without estimated errors, with echoes in a hundred bins.
BeamState sure(const Aperture& aperture, int beam, const BeamDensity& density) {
  BeamState state{density, {}, error_of_distance(Sampling::Preset::normal, 1), density.columns};
  const auto b = static_cast<std::size_t>(beam);
  state.zone_port_rad = aperture.beam_edges_rad[b];
  state.zone_starboard_rad = aperture.beam_edges_rad[b + 1];
  state.estimate.bins = 100;
  state.estimate.zone_end = density.columns;
  return state;
}

/// Sets the estimated RMS error of the bins: 0.3 of their difference to the bins of thinned samples.
void let_bins_be_off(BeamState& beam, double rms) {
  beam.estimate.bin_squares = static_cast<float>(100 * std::pow(rms / 0.3, 2));
}

class BeamsToRefine : public ::testing::Test {
 protected:
  const Aperture aperture_ = fan(8, 0.08);
  const BeamDensity first_ = first_density(aperture_, Preset::normal);
  std::vector<BeamState> beams_ = all_sure();

  std::vector<BeamState> all_sure() const {
    std::vector<BeamState> beams;
    for (int beam = 0; beam < 8; ++beam) {
      beams.push_back(sure(aperture_, beam, first_));
    }
    return beams;
  }
  std::vector<BeamChoice> to_refine(bool is_last = false) const {
    return beams_to_refine(aperture_, beams_, one_per_cent, is_last);
  }
};

TEST_F(BeamsToRefine, NoneWhereAllAgree) {
  for (BeamState& beam : beams_) {
    let_bins_be_off(beam, 0.0099);
    beam.estimate.rows_total = beam.estimate.columns_total = 0.0005F;
    beam.estimate.rows_centroid_lines = beam.estimate.columns_centroid_lines = 0.02F;
  }
  EXPECT_TRUE(to_refine().empty());
}

TEST_F(BeamsToRefine, MoreRowsWhereEdgesLieBetweenRows) {
  beams_[3].estimate.rows_total = 0.002F;
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 1u);
  EXPECT_EQ(choices[0].beam, 3);
  EXPECT_EQ(choices[0].density.columns, first_.columns);
  EXPECT_EQ(choices[0].density.rows, first_.rows * 3);
}

TEST_F(BeamsToRefine, MoreWhereWhatIsTooCoarseStays) {
  beams_[3].estimate.rows_total = 0.0022F;
  EXPECT_EQ(to_refine(false).at(0).density.rows, first_.rows * 3);
  EXPECT_EQ(to_refine(true).at(0).density.rows, first_.rows * 4);
}

TEST_F(BeamsToRefine, MoreOfBothWhereBinsAreOff) {
  let_bins_be_off(beams_[5], 0.02);
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 1u);
  EXPECT_EQ(choices[0].density, (BeamDensity{2 * first_.columns, 2 * first_.rows, 0, 0, 0, 0}));
}

/// The target applies to all bins of the image together.
TEST_F(BeamsToRefine, ABeamMayBeALittleWorseWhereOthersAreBetter) {
  for (BeamState& beam : beams_) {
    let_bins_be_off(beam, 0.002);
  }
  let_bins_be_off(beams_[5], 0.0109);
  EXPECT_TRUE(to_refine().empty());
  for (BeamState& beam : beams_) {
    let_bins_be_off(beam, 0.0109);
  }
  EXPECT_EQ(to_refine().size(), 8u);
}

TEST_F(BeamsToRefine, ALoneEdgeIsLookedAtInAZone) {
  BeamState& beam = beams_[2];
  beam.estimate.columns_total = 0.14F;
  beam.estimate.zone_begin = 1;
  beam.estimate.zone_end = 3;
  beam.estimate.zone_miss = 210.0F;
  beam.zone_port_rad -= 0.0025;
  beam.zone_starboard_rad += 0.0025;
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 1u);
  const BeamDensity& density = choices[0].density;
  EXPECT_EQ(density.zone_port_rad, beam.zone_port_rad);
  EXPECT_EQ(density.zone_starboard_rad, beam.zone_starboard_rad);
  EXPECT_GE(density.columns, 32 * 2);
  EXPECT_EQ(density.rows, first_.rows);
  EXPECT_EQ(density.port_columns, 2);
  EXPECT_EQ(density.starboard_columns, 2);
  EXPECT_LT(density.samples(), 20 * first_.samples());
}

TEST_F(BeamsToRefine, ManyEdgesTakeColumnsInAllOfTheBeam) {
  beams_[2].estimate.columns_total = 0.002F;
  beams_[2].estimate.zone_miss = 3.0F;
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 1u);
  EXPECT_FALSE(choices[0].density.has_zone());
  EXPECT_EQ(choices[0].density.columns, first_.columns * 3);
}

/// One more view takes as long as some thousand samples.
TEST_F(BeamsToRefine, NeighboursShareViewsWhereThatTakesFewMoreSamples) {
  beams_[2].estimate.rows_total = 0.0006F;
  beams_[3].estimate.rows_total = 0.0008F;
  beams_[4].estimate.rows_total = beams_[4].estimate.columns_total = 0.05F;
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 3u);
  EXPECT_EQ(choices[0].density, choices[1].density);
  EXPECT_GT(choices[2].density.rows, choices[1].density.rows);
}

TEST_F(BeamsToRefine, OneThinThingHasAllBeamsLookedAtWithMoreColumns) {
  beams_[7].estimate.thin = 1;
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 8u);
  for (const BeamChoice& choice : choices) {
    EXPECT_EQ(choice.density, (BeamDensity{4 * first_.columns, first_.rows, 0, 0, 0, 0}));
  }
}

TEST_F(BeamsToRefine, AllTogetherTakeNoMoreThanTheMemoryAndEachIsFinerOrLeftOut) {
  const Aperture wide = fan(2048, 2);
  const BeamDensity first = first_density(wide, Preset::normal);
  std::vector<BeamState> beams;
  for (int beam = 0; beam < 2048; ++beam) {
    beams.push_back(sure(wide, beam, first));
    let_bins_be_off(beams.back(), 1);
  }
  double samples = 0;
  for (const BeamChoice& choice : beams_to_refine(wide, beams, one_per_cent, false)) {
    EXPECT_GT(choice.density.samples(), first.samples());
    samples += choice.density.samples();
  }
  EXPECT_GT(samples, 0);
  EXPECT_LE(samples, 0x1p25);
}

TEST_F(BeamsToRefine, WhatIsAsFineAsItGetsIsLeftAsItIs) {
  const BeamDensity finest{512, 2048, 0, 0, 0, 0};
  beams_[0] = sure(aperture_, 0, finest);
  let_bins_be_off(beams_[0], 1);
  beams_[0].estimate.rows_total = 1;
  EXPECT_TRUE(to_refine().empty());
}

// ---- the presets

class RasterPreset : public ::testing::Test {
 protected:
  void SetUp() override { test::require_gl(); }

  static RendererOptions options() {
    RendererOptions options;
    options.engine = EngineKind::gpu;
    options.skip.turn_off(SkipRule::unchanged_scene);  // or a repeated ping would not be rendered
    return options;
  }

  static PingRequest request(const test::Scene& scene, Preset preset) {
    PingRequest request = scene.request();
    request.settings.sampling.preset = preset;
    return request;
  }

  /// @return the numbers of samples of `fast` and of `default`
  static std::pair<std::uint64_t, std::uint64_t> expect_targets(const std::string& name) {
    const test::Scene scene = test::make_scene(name);
    const auto truth = bench::find_reference(scene, SONARD_SOURCE_DIR "/tests/data/oracle");
    EXPECT_TRUE(truth.has_value());
    SonarRenderer renderer(scene.world, options());
    std::vector<std::uint64_t> samples;
    for (const Preset preset : {Preset::fast, Preset::normal}) {
      const EchoImage& image = renderer.render_echo(request(scene, preset));
      const auto error = bench::compare_images(image, truth->image);
      const PingStatistics statistics = renderer.last_statistics();
      samples.push_back(statistics.samples);
      EXPECT_LE(statistics.passes, static_cast<std::uint64_t>(most_passes(preset))) << name;
      EXPECT_LE(statistics.synchronisations, statistics.passes + 1) << name;
      EXPECT_LE(statistics.bytes_read_back, image.intensity.size() * sizeof(float) + (64U << 10U)) << name;
      std::printf("%s: RMS %.4f, %llu samples\n", name.c_str(), error->bin_rms,
                  static_cast<unsigned long long>(samples.back()));
      EXPECT_LT(error->bin_rms, grid_targets(preset).bins) << name;
      EXPECT_LE(error->first_echo_bins, preset == Preset::fast ? 1.0 : 0.5) << name;
      EXPECT_LE(error->hole_fraction, preset == Preset::fast ? 1e-3 : 0.0) << name;
    }
    return {samples[0], samples[1]};
  }
};

TEST_F(RasterPreset, MeetsItsTargetOnAPlane) {
  const auto [fast, normal] = expect_targets("plane");
  EXPECT_LT(fast, normal);
}

TEST_F(RasterPreset, MeetsItsTargetOnAFlatBedWithObjects) {
  const auto [fast, normal] = expect_targets("flat100k");
  EXPECT_LT(5 * fast, 2 * normal);  // thin things take the same samples with both
}

TEST_F(RasterPreset, MeetsItsTargetOnASwellOfFacets) {
  const auto [fast, normal] = expect_targets("swell100k");
  EXPECT_LT(4 * fast, normal);
}

TEST_F(RasterPreset, MeetsItsTargetOnABedThatShadowsItselfEverywhere) {
  expect_targets("ripple100k");
}

TEST_F(RasterPreset, MeetsItsTargetInOneBeamOfAScanningSonar) {
  const auto [fast, normal] = expect_targets("msis_ripple");
  EXPECT_LT(fast, normal);
}

// A renderer serves the heads of a vehicle in turn, each with its own fan.
TEST_F(RasterPreset, TheFirstGridsOfAllHeadsAreKept) {
  const test::Scene scene = test::make_scene("plane");
  SonarRenderer renderer(scene.world, options());
  const auto kept = [&](int head) {
    PingRequest asked = request(scene, Preset::fast);
    asked.settings.aperture.beam_edges_rad = equal_angle_edges(8 + head, 0.5);
    renderer.render_echo(asked, head);
    const PingStatistics& statistics = renderer.last_statistics();
    return statistics.skipped.of(SkipRule::unchanged_settings) > 1;  // the transmission loss counts one
  };
  for (int head = 0; head < 8; ++head) {
    EXPECT_FALSE(kept(head)) << head;
  }
  for (int head = 0; head < 8; ++head) {
    EXPECT_TRUE(kept(head)) << head;
  }
}

TEST_F(RasterPreset, TheImageDependsOnTheRequestAlone) {
  const test::Scene scene = test::make_scene("flat100k");
  PingRequest asked = request(scene, Preset::fast);
  asked.settings.aperture.beam_edges_rad = equal_angle_edges(32, 0.5);
  const std::vector<float> alone = SonarRenderer(scene.world, options()).render_echo(asked).intensity;

  SonarRenderer renderer(scene.world, options());
  EXPECT_EQ(renderer.render_echo(asked).intensity, alone);
  std::vector<PingRequest> others(4, asked);
  others[0].settings.sampling.preset = Preset::normal;
  others[1].settings.aperture.beam_edges_rad = equal_angle_edges(7, 0.9);
  others[2].T_world_sonar.position_m.z += 2;
  others[3].settings.sampling = Sampling::of_grid(2, 30, 50);
  for (const PingRequest& other : others) {
    EXPECT_NE(renderer.render_echo(other).intensity, alone);
    EXPECT_EQ(renderer.render_echo(asked).intensity, alone);
  }
}

}  // namespace
}  // namespace sonard::render
