// SPDX-License-Identifier: Apache-2.0
// Backend `raster` finds the grids that an error preset takes (docs/accuracy.md).
#include "renderer/engines/gpu/grid_choice.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "tests/bench/image_error.hpp"
#include "tests/bench/reference.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/backend_test.hpp"

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
  // All of the beam's solid angle is there, once.
  const SampleGrid grid = make_sample_grid(aperture, {run});
  double solid_angle = 0;
  for (const float weight : grid.weights) {
    solid_angle += static_cast<double>(weight);
  }
  const double expected = 0.01 * 2 * std::sin(aperture.elevation_limit_rad());
  EXPECT_NEAR(solid_angle / expected, 1, 1e-5);
}

// ---- beams to refine

constexpr GridTargets one_per_cent{0.01, {0.001, 0.05}};

/// A beam of even columns, none of which adds an error.
BeamState sure(const Aperture& aperture, int beam, const BeamDensity& density) {
  BeamState state{density, {}, 0};
  const auto b = static_cast<std::size_t>(beam);
  const double port = aperture.beam_edges_rad[b];
  const double width = (port - aperture.beam_edges_rad[b + 1]) / density.columns;
  for (int i = 0; i < density.columns; ++i) {
    state.estimate.columns.push_back({port - i * width, port - (i + 1) * width, {}});
  }
  return state;
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
  std::vector<BeamChoice> to_refine() const { return beams_to_refine(aperture_, beams_, one_per_cent); }
};

TEST_F(BeamsToRefine, NoneWhereAllAgree) {
  for (BeamState& beam : beams_) {
    beam.bin_rms = 0.01;
    beam.estimate.by_rows = {0.0005, 0.025};
    beam.estimate.by_columns = {0.0005, 0.025};
  }
  EXPECT_TRUE(to_refine().empty());
}

TEST_F(BeamsToRefine, MoreRowsWhereEdgesLieBetweenRows) {
  beams_[3].estimate.by_rows = {0.002, 0};
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 1u);
  EXPECT_EQ(choices[0].beam, 3);
  EXPECT_EQ(choices[0].density.columns, first_.columns);
  EXPECT_EQ(choices[0].density.rows, 4 * first_.rows);
}

TEST_F(BeamsToRefine, MoreOfBothWhereBinsAreOff) {
  beams_[5].bin_rms = 0.02;
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 1u);
  EXPECT_EQ(choices[0].density, (BeamDensity{2 * first_.columns, 2 * first_.rows, 0, 0, 0, 0}));
}

TEST_F(BeamsToRefine, ALoneEdgeIsLookedAtInAZone) {
  BeamState& beam = beams_[2];
  beam.estimate.columns[1].error = beam.estimate.columns[2].error = {0.1, 0};
  beam.estimate.by_columns = {0.14, 0};
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 1u);
  const BeamDensity& density = choices[0].density;
  EXPECT_EQ(density.zone_port_rad, beam.estimate.columns[1].port_rad);
  EXPECT_EQ(density.zone_starboard_rad, beam.estimate.columns[2].starboard_rad);
  EXPECT_GE(density.columns, 32 * 2);
  EXPECT_EQ(density.rows, first_.rows);
  EXPECT_EQ(density.port_columns, 2);
  EXPECT_EQ(density.starboard_columns, 2);
  EXPECT_LT(density.samples(), 20 * first_.samples());
}

TEST_F(BeamsToRefine, ManyEdgesTakeColumnsInAllOfTheBeam) {
  BeamState& beam = beams_[2];
  for (ColumnError& column : beam.estimate.columns) {
    column.error = {0.001, 0};
  }
  beam.estimate.by_columns = {0.002, 0};
  const auto choices = to_refine();
  ASSERT_EQ(choices.size(), 1u);
  EXPECT_FALSE(choices[0].density.has_zone());
  EXPECT_EQ(choices[0].density.columns, 4 * first_.columns);
}

TEST_F(BeamsToRefine, OneThinThingHasAllBeamsLookedAtWithMoreColumns) {
  beams_[7].estimate.thin = true;
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
    beams.back().bin_rms = 1;
  }
  double samples = 0;
  for (const BeamChoice& choice : beams_to_refine(wide, beams, one_per_cent)) {
    EXPECT_GT(choice.density.samples(), first.samples());
    samples += choice.density.samples();
  }
  EXPECT_GT(samples, 0);
  EXPECT_LE(samples, 0x1p25);
}

TEST_F(BeamsToRefine, WhatIsAsFineAsItGetsIsLeftAsItIs) {
  const BeamDensity finest{512, 2048, 0, 0, 0, 0};
  beams_[0] = sure(aperture_, 0, finest);
  beams_[0].bin_rms = 1;
  beams_[0].estimate.by_rows = {1, 1};
  EXPECT_TRUE(to_refine().empty());
}

// ---- thinned samples

/// What the rays of a grid see of the plane n.p = distance_m, in the frame of a view on the x axis.
std::vector<SurfaceSample> plane_samples(const SubView& view, const glm::dvec3& n, double distance_m) {
  std::vector<SurfaceSample> samples;
  for (int j = 0; j < view.rows; ++j) {
    for (int i = 0; i < view.columns; ++i) {
      const double x = -view.tan_half_width + (i + 0.5) * view.pixel_width();
      const double y = -view.tan_half_height + (j + 0.5) * view.pixel_height();
      const auto range = [&](double u, double v) {
        const glm::dvec3 q(1, -u, v);
        return distance_m * glm::length(q) / glm::dot(n, q);
      };
      constexpr double h = 1e-5;
      samples.push_back({static_cast<float>(range(x, y)), 0.5F,
                         static_cast<float>((range(x + h, y) - range(x - h, y)) / (2 * h)),
                         static_cast<float>((range(x, y + h) - range(x, y - h)) / (2 * h))});
    }
  }
  return samples;
}

/// A small fan in one view, and every second column and row of it.
struct TwoGrids {
  Aperture aperture = fan(8, 0.4);
  BeamRun run = whole_fan(aperture, {2, 256, 0, 0, 0, 0});
  SampleGrid fine = make_sample_grid(aperture, {run});
  SampleGrid coarse = make_sample_grid(aperture, thinned({run}));
};

TEST(ThinnedSamples, OfAPlaneAreThoseOfTheCoarseGrid) {
  const TwoGrids grids;
  ASSERT_EQ(grids.fine.views.size(), 1u);
  const glm::dvec3 n = glm::normalize(glm::dvec3(1, 0.4, -0.7));
  const std::vector<SurfaceSample> samples = plane_samples(grids.fine.views[0], n, 5);
  const std::vector<SurfaceSample> expected = plane_samples(grids.coarse.views[0], n, 5);
  EXPECT_EQ(4 * expected.size(), samples.size());
  const ThinnedSamples thinned(grids.fine, {samples.data()}, grids.coarse);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const SurfaceSample& found = thinned.views()[0][i];
    ASSERT_NEAR(found.range_m, expected[i].range_m, 1e-5F) << i;
    ASSERT_NEAR(found.range_dx, expected[i].range_dx, 1e-3F) << i;
    ASSERT_NEAR(found.range_dy, expected[i].range_dy, 1e-3F) << i;
    ASSERT_EQ(found.response, 0.5F) << i;
  }
}

TEST(ThinnedSamples, WhereNothingIsSeenNothingIs) {
  const TwoGrids grids;
  const std::vector<SurfaceSample> samples(
      static_cast<std::size_t>(grids.fine.views[0].columns * grids.fine.views[0].rows));
  const ThinnedSamples thinned(grids.fine, {samples.data()}, grids.coarse);
  EXPECT_EQ(thinned.views()[0][0], SurfaceSample{});
}

// ---- the estimate

TEST(BinError, CountsOnlyWhatIsLoudAfterTheLineWeights) {
  const std::vector<float> echo{1.0F, 1.0F, 0.005F};
  const std::vector<float> thinned{1.3F, 0.6F, 0.9F};
  const auto error = [&](const std::vector<float>& of, const std::vector<float>& line_weight) {
    return bin_error(echo.data(), of.data(), 3, line_weight);
  };
  EXPECT_NEAR(error(thinned, {}), 0.4 * std::sqrt((0.09 + 0.16) / 2), 1e-6);
  // A weight lifts the third bin above a hundredth of the beam's loudest and drops the second below.
  EXPECT_NEAR(error(thinned, {1, 0.001F, 100}), 0.4 * std::sqrt((0.09 + 179.0 * 179.0) / 2), 1e-2);
  EXPECT_EQ(error(echo, {}), 0);
  const std::vector<float> silent{0, 0, 0};
  EXPECT_EQ(bin_error(silent.data(), thinned.data(), 3, {}), 0);
}

// ---- the presets

class RasterPreset : public ::testing::Test {
 protected:
  void SetUp() override { test::require_raster(); }

  static RendererOptions options() {
    RendererOptions options;
    options.backend = Backend::raster;
    options.skip.turn_off(SkipRule::unchanged_scene);  // or a repeated ping would not be rendered
    return options;
  }

  static PingRequest request(const test::Scene& scene, Preset preset) {
    PingRequest request = scene.request();
    request.settings.sampling.preset = preset;
    return request;
  }

  /// @return the number of samples each preset took.
  static std::pair<std::uint64_t, std::uint64_t> expect_targets(const std::string& name) {
    const test::Scene scene = test::make_scene(name);
    const auto truth = bench::find_reference(scene, SONARD_SOURCE_DIR "/tests/data/oracle");
    EXPECT_TRUE(truth.has_value());
    SonarRenderer renderer(scene.world, options());
    std::vector<std::uint64_t> samples;
    for (const Preset preset : {Preset::fast, Preset::normal}) {
      const EchoImage& image = renderer.render_echo(request(scene, preset));
      const auto error = bench::compare_images(image, truth->image);
      samples.push_back(renderer.last_statistics().samples);
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
  EXPECT_LT(4 * fast, normal);
}

TEST_F(RasterPreset, MeetsItsTargetOnASwellOfFacets) {
  const auto [fast, normal] = expect_targets("swell100k");
  EXPECT_LT(4 * fast, normal);
}

TEST_F(RasterPreset, MeetsItsTargetInOneBeamOfAScanningSonar) {
  const auto [fast, normal] = expect_targets("msis_ripple");
  EXPECT_LT(fast, normal);
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
