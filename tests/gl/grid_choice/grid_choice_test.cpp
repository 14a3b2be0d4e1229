// Backend `raster` finds the grid that an error preset takes (docs/accuracy.md).
#include "renderer/visibility/grid_choice.hpp"

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

// ---- the ladder

Aperture fan(int beams, double width_rad) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_angle_edges(beams, width_rad);
  return aperture;
}

TEST(GridLadder, TwoStepsDownIsEverySecondColumnAndRow) {
  const GridLadder ladder(fan(256, 2.0943951));
  for (int step = 2; step <= ladder.last_step(); ++step) {
    const Sampling fine = ladder.sampling(step);
    const Sampling coarse = ladder.sampling(step - 2);
    EXPECT_EQ(fine.columns_per_view, 2 * coarse.columns_per_view) << step;
    EXPECT_EQ(fine.rows, 2 * coarse.rows) << step;
    EXPECT_EQ(fine.views, coarse.views) << step;
  }
}

TEST(GridLadder, NoViewExceedsWhatCanBeDrawnAndNoGridTheMemory) {
  for (const auto& [beams, width_rad] : {std::pair{1, 0.05}, {256, 2.0943951}, {512, 6.28}, {4096, 2.4}}) {
    const GridLadder ladder(fan(beams, width_rad));
    for (int step = 0; step <= ladder.last_step(); ++step) {
      const Sampling sampling = ladder.sampling(step);
      EXPECT_LE(sampling.columns_per_view, 16384);
      EXPECT_LE(sampling.rows, 16384);
      EXPECT_GE(sampling.views * sampling.columns_per_view, beams);
      EXPECT_LE(width_rad / sampling.views, 1.0472);
      EXPECT_LE(1.0 * sampling.views * sampling.columns_per_view * sampling.rows, 0x1p25);
    }
    EXPECT_GE(ladder.first_step(Preset::normal), ladder.first_step(Preset::fast));
    EXPECT_EQ(ladder.first_step(Preset::reference), ladder.last_step());
  }
}

TEST(GridLadder, RowsAreAsNarrowInATallFan) {
  Aperture tall = fan(64, 1);
  tall.vertical_beamwidth_rad *= 3;
  EXPECT_EQ(GridLadder(tall).sampling(2).rows, 3 * GridLadder(fan(64, 1)).sampling(2).rows);
}

TEST(GridLadder, GoesFinerOnlyWhileTheErrorIsTooLarge) {
  const GridLadder ladder(fan(256, 2.0943951));
  EXPECT_EQ(next_step(ladder, 2, 0.05, 0.05), 2);
  EXPECT_EQ(next_step(ladder, 2, 0.051, 0.05), 3);
  EXPECT_GT(next_step(ladder, 2, 0.2, 0.05), 3);
  EXPECT_EQ(next_step(ladder, 2, INFINITY, 0.05), 6) << "one odd bin, at most 16 times the samples";
  EXPECT_EQ(next_step(ladder, ladder.last_step(), 0.9, 0.05), ladder.last_step());
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

TEST(ThinnedSamples, OfAPlaneAreThoseOfTheCoarseGrid) {
  GridLadder ladder(fan(8, 0.4));
  const SampleGrid& fine = ladder.grid(2);
  const SampleGrid& coarse = ladder.grid(0);
  ASSERT_EQ(fine.views.size(), 1u);
  const glm::dvec3 n = glm::normalize(glm::dvec3(1, 0.4, -0.7));
  const std::vector<SurfaceSample> samples = plane_samples(fine.views[0], n, 5);
  const std::vector<SurfaceSample> expected = plane_samples(coarse.views[0], n, 5);
  const ThinnedSamples thinned(fine, {samples.data()}, coarse);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const SurfaceSample& found = thinned.views()[0][i];
    ASSERT_NEAR(found.range_m, expected[i].range_m, 1e-5F) << i;
    ASSERT_NEAR(found.range_dx, expected[i].range_dx, 1e-3F) << i;
    ASSERT_NEAR(found.range_dy, expected[i].range_dy, 1e-3F) << i;
    ASSERT_EQ(found.response, 0.5F) << i;
  }
}

TEST(ThinnedSamples, WhereNothingIsSeenNothingIs) {
  GridLadder ladder(fan(2, 0.1));
  const SampleGrid& fine = ladder.grid(2);
  const std::vector<SurfaceSample> samples(
      static_cast<std::size_t>(fine.views[0].columns * fine.views[0].rows));
  const ThinnedSamples thinned(fine, {samples.data()}, ladder.grid(0));
  EXPECT_EQ(thinned.views()[0][0], SurfaceSample{});
}

// ---- the estimate

TEST(EstimatedError, CountsOnlyWhatIsLoudAfterTheLineWeights) {
  BinningResult image, thinned;
  image.beams = thinned.beams = 2;
  image.lines = thinned.lines = 3;
  image.echo = {1.0F, 1.0F, 0.005F, 0, 0, 0};  // the second beam hears nothing
  thinned.echo = {1.3F, 0.6F, 0.9F, 0, 0, 1.0F};
  EXPECT_NEAR(estimate_error(image, thinned, {}), 0.4 * std::sqrt((0.09 + 0.16) / 2), 1e-6);
  // A weight lifts the third bin above a hundredth of the beam's loudest and drops the second below.
  EXPECT_NEAR(estimate_error(image, thinned, {1, 0.001F, 100}), 0.4 * std::sqrt((0.09 + 179.0 * 179.0) / 2),
              1e-2);
  EXPECT_EQ(estimate_error(image, image, {}), 0);
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
      EXPECT_LT(error->bin_rms, target_error(preset)) << name;
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
