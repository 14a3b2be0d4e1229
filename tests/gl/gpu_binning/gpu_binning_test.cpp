// SPDX-License-Identifier: Apache-2.0
// Binning on the GPU against binning on the CPU. Both bin the samples of one rasteriser, equal to the bit, so
// all differences come from binning.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

#include <gmock/gmock.h>

#include "renderer/engines/gpu/egl_context.hpp"
#include "renderer/engines/gpu/gpu_binner.hpp"
#include "renderer/pipeline/self_test.hpp"
#include "renderer/sample_grid/grid_binner.hpp"
#include "tests/gl/gpu_binning/double_binning.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using test::looking;
using test::make_body;
using test::make_quad;
using test::make_sphere;
using test::make_world;

/// A wall across the whole fan.
TriangleMesh wall(float distance_m) {
  return make_quad({distance_m, -80, -80}, {0, 160, 0}, {0, 0, 160});
}

TriangleMesh bed(float altitude_m) {
  return make_quad({-200, -200, -altitude_m}, {400, 0, 0}, {0, 400, 0});
}

/// The largest difference of a bin, relative to the strongest bin of its beam in `truth`.
template <class A, class B>
double worst_difference(const std::vector<A>& truth, const std::vector<B>& image, std::size_t lines) {
  EXPECT_EQ(truth.size(), image.size());
  double worst = 0;
  for (std::size_t beam = 0; beam < truth.size() / lines; ++beam) {
    double strongest = 0, difference = 0;
    for (std::size_t i = beam * lines; i < (beam + 1) * lines; ++i) {
      strongest = std::max(strongest, static_cast<double>(truth[i]));
      difference =
          std::max(difference, std::abs(static_cast<double>(truth[i]) - static_cast<double>(image[i])));
    }
    if (strongest > 0) {
      worst = std::max(worst, difference / strongest);
    } else {
      EXPECT_EQ(difference, 0.0);
    }
  }
  return worst;
}

/// Bins the samples of one rasteriser on the GPU, on the CPU and in double precision.
class GpuBinningTest : public ::testing::Test {
 protected:
  void SetUp() override { test::require_gl(); }

  struct Case {
    std::string name;
    World world;
    Pose T_world_sonar{};
    Aperture aperture{};
    Sampling sampling = Sampling::of_grid(3, 256, 512);
    RangeLines range{1000, 0.02, 0, false};
    BinningOptions options{};
    GridOptions grid_options{};
    SurfaceModel surface{};
  };

  static RendererOptions gpu() { return {EngineKind::gpu, 0}; }

  /// The numbers of all beams of a grid.
  static std::vector<int> all_beams(const SampleGrid& grid) {
    std::vector<int> beams(static_cast<std::size_t>(grid.beam_count()));
    std::iota(beams.begin(), beams.end(), 0);
    return beams;
  }

  static void expect_agreement(Case c) {
    if (c.aperture.beam_edges_rad.empty()) {
      c.aperture.beam_edges_rad = equal_angle_edges(256, 120 * degree);
    }
    RasterSampler sampler(c.world);
    GpuBinner binner(sampler);
    WorkerPool workers;
    const SampleGrid grid = make_sample_grid(c.aperture, c.sampling, c.grid_options);
    const double max_range_m = c.range.max_range_m() * 1.05;
    const auto on_gpu = binner.load(grid, all_beams(grid));
    const std::vector<float> no_weights;
    binner.begin({grid.beam_count(), c.range, c.options, no_weights});
    binner.add(*on_gpu, sampler.draw(c.T_world_sonar, grid, c.surface, max_range_m));
    binner.ask_image();
    const BinningResult gpu = binner.take_image();
    const auto samples = sampler.sample(c.T_world_sonar, grid, c.surface, max_range_m);
    const BinningResult cpu = bin_echoes(grid, CellWeights(grid), samples, c.range, c.options, workers);
    const std::vector<double> exact = test::bin_in_double(grid, samples, c.range, c.options);

    const auto lines = static_cast<std::size_t>(c.range.count);
    const double from_cpu = worst_difference(cpu.echo, gpu.echo, lines);
    const double from_exact = worst_difference(exact, gpu.echo, lines);
    const double cpu_from_exact = worst_difference(exact, cpu.echo, lines);
    const auto echoes = std::count_if(cpu.echo.begin(), cpu.echo.end(), [](float v) { return v > 0; });
    std::printf("%-28s %7td echoes, worst bin: GPU - double %.1e, CPU - double %.1e, GPU - CPU %.1e\n",
                c.name.c_str(), echoes, from_exact, cpu_from_exact, from_cpu);
    EXPECT_GT(echoes, 0) << c.name;
    EXPECT_LT(from_cpu, 1e-3) << c.name;
    EXPECT_LT(from_exact, 1e-5) << c.name;
    if (c.options.open_water) {
      EXPECT_LT(worst_difference(cpu.open_sr, gpu.open_sr, lines), 1e-4) << c.name;
    }
    EXPECT_EQ(gpu.open_sr.size(), cpu.open_sr.size()) << c.name;
    EXPECT_EQ(gpu.samples, cpu.samples) << c.name;
    EXPECT_EQ(gpu.invalid_samples, cpu.invalid_samples) << c.name;
    EXPECT_EQ(gpu.saturated_samples, 0U) << c.name;
  }
};

TEST_F(GpuBinningTest, AgreesOnAPerpendicularWall) {
  Case wall_at_10_m{"wall", make_world({make_body("wall", wall(10))})};
  wall_at_10_m.range = {1500, 0.008, 0, false};
  expect_agreement(wall_at_10_m);
}

TEST_F(GpuBinningTest, AgreesOnABedSeenAtGrazingIncidence) {
  Case flat{"bed", make_world({make_body("bed", bed(2))})};
  flat.range = {1000, 0.05, 0, false};
  expect_agreement(flat);
}

TEST_F(GpuBinningTest, AgreesOnASlope) {
  Case slope{"slope", make_world({make_body("slope", wall(0))})};
  slope.world.bodies[0].T_world_body = looking({9, 0, 0}, 25, 35);
  expect_agreement(slope);
}

TEST_F(GpuBinningTest, AgreesOnASphere) {
  Case sphere{"sphere", make_world({make_body("sphere", make_sphere(0.5F, 64))})};
  sphere.world.bodies[0].T_world_body.position_m = {8, 1, 0.1};
  sphere.sampling = Sampling::of_grid(3, 512, 512);
  expect_agreement(sphere);
}

/// Odd numbers of columns and rows, so that beams cut columns; an elevation pattern and its limit.
TEST_F(GpuBinningTest, AgreesUnderATiltedSonarWithAnElevationPattern) {
  Case tilted{"tilted, pattern, odd grid",
              make_world({make_body("bed", bed(4)), make_body("wall", wall(15))})};
  tilted.T_world_sonar = looking({0, 0, 0}, 3, 20);
  tilted.sampling = Sampling::of_grid(5, 151, 301);
  tilted.aperture.elevation = Aperture::Elevation::sinc;
  tilted.aperture.beam_edges_rad = equal_sine_edges(240, 60 * degree);
  expect_agreement(tilted);
}

TEST_F(GpuBinningTest, AgreesOnTheDockingStation) {
  Case docking{"docking station",
               load_world(std::string(SONARD_SOURCE_DIR) + "/configs/worlds/docking_station.sdf", {})};
  docking.T_world_sonar = looking({-2.136, -11.913, -25.6}, 80, 20);
  docking.range = {2411, 0.0083, 0, false};
  expect_agreement(docking);
}

/// Lines of a millimetre: there a float alone resolves a few thousandths of a line.
TEST_F(GpuBinningTest, AgreesInLinesFarOut) {
  Case far{"bed, 40,000 lines", make_world({make_body("bed", bed(8))})};
  far.T_world_sonar = looking({0, 0, 0}, 0, 20);
  far.range = {40'000, 0.001, 0, false};
  far.aperture.beam_edges_rad = equal_angle_edges(24, 120 * degree);
  far.sampling = Sampling::of_grid(3, 64, 512);
  expect_agreement(far);
}

TEST_F(GpuBinningTest, AgreesOnOneBeam) {
  Case scanning{"one beam of 3 x 35 degrees", make_world({make_body("bed", bed(3))})};
  scanning.T_world_sonar = looking({0, 0, 0}, 0, 20);
  scanning.aperture.vertical_beamwidth_rad = 35 * degree;
  scanning.aperture.beam_edges_rad = equal_angle_edges(1, 3 * degree);
  scanning.sampling = Sampling::of_grid(1, 8, 512);
  expect_agreement(scanning);
}

/// The open solid angle of each beam, line by line: behind a wall, over a bed, and in open water.
TEST_F(GpuBinningTest, AgreesOnOpenWater) {
  Case open{"open water", make_world({make_body("bed", bed(2)),
                                      make_body("wall", make_quad({7, 0, -80}, {0, 80, 0}, {0, 0, 160}))})};
  open.options.open_water = true;
  expect_agreement(open);
}

/// Means, and all variants of binning in the paper.
TEST_F(GpuBinningTest, AgreesInModePaper) {
  Case paper{"paper", make_world({make_body("bed", bed(4)), make_body("wall", wall(12))})};
  paper.T_world_sonar = looking({0, 0, 0}, 0, 20);
  paper.options.mean = true;
  paper.surface.model = Model::paper;
  paper.surface.sigmoid_slope = 5;  // steep ones leave few bins above 0
  expect_agreement(paper);
  paper.name = "paper, points";
  paper.options.footprint = false;
  expect_agreement(paper);
  paper.name = "paper, points, legacy";
  paper.options.legacy_bin_index = true;
  paper.grid_options = {true, false};
  paper.sampling = Sampling::of_grid(1, 1024, 512);
  expect_agreement(paper);
}

/// S19: all samples in one line.
TEST_F(GpuBinningTest, AgreesWhereAllSamplesFallIntoOneLine) {
  Case one{"one line", make_world({make_body("wall", wall(5))})};
  one.range = {1, 20.0, 0, false};
  one.aperture.beam_edges_rad = equal_angle_edges(2, 60 * degree);
  one.sampling = Sampling::of_grid(1, 512, 512);
  expect_agreement(one);
}

/// The order of samples in the grid, of threads and of pings does not change the image.
TEST_F(GpuBinningTest, IsRepeatableToTheBit) {
  const World world = make_world({make_body("bed", bed(4)), make_body("wall", wall(15))});
  const Pose T_world_sonar = looking({0, 0, 0}, 3, 20);
  Aperture aperture;
  aperture.beam_edges_rad = equal_angle_edges(128, 120 * degree);
  RasterSampler sampler(world);
  GpuBinner binner(sampler);
  SampleGrid grid = make_sample_grid(aperture, Sampling::of_grid(3, 256, 256));
  const RangeLines range{1000, 0.02, 0, false};
  const auto bin = [&](bool mean) {
    BinningOptions options;
    options.mean = mean;
    const auto on_gpu = binner.load(grid, all_beams(grid));
    const std::vector<float> no_weights;
    binner.begin({grid.beam_count(), range, options, no_weights});
    binner.add(*on_gpu, sampler.draw(T_world_sonar, grid, {}, 21.0));
    binner.ask_image();
    return binner.take_image().echo;
  };
  const std::vector<float> echo = bin(false), mean = bin(true);
  std::mt19937 random(1);
  for (int i = 0; i < 10; ++i) {
    for (std::size_t beam = 0; beam + 1 < grid.beam_parts.size(); ++beam) {
      std::shuffle(grid.parts.begin() + grid.beam_parts[beam], grid.parts.begin() + grid.beam_parts[beam + 1],
                   random);
    }
    ASSERT_EQ(bin(false), echo);
    ASSERT_EQ(bin(true), mean);
  }
}

/// Extremely bright surfaces: sums saturate instead of wrapping around, and the samples are counted.
TEST_F(GpuBinningTest, CountsEchoesBeyondWhatItsSumsHold) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_angle_edges(16, 60 * degree);
  request.settings.range = {1, 20.0, 0, false};  // all of a beam in one line
  request.settings.physical.absorption_db_per_m = 0;
  request.settings.sampling = Sampling::of_grid(1, 64, 64);
  const auto render = [&](double mu) {
    SonarRenderer renderer(make_world({make_body("wall", wall(5), mu)}), gpu());
    const EchoImage image = renderer.render_echo(request);
    const PingStatistics statistics = renderer.last_statistics();
    EXPECT_GT(statistics.samples, 0U);
    // Slivers of pixels at the sides of beams do not saturate.
    EXPECT_GE(static_cast<double>(statistics.saturated_samples),
              mu > 1 ? 0.99 * static_cast<double>(statistics.samples) : 0.0);
    EXPECT_EQ(statistics.saturated_samples > 0, mu > 1);
    EXPECT_EQ(statistics.invalid_samples, 0U);
    return image;
  };
  const EchoImage unit = render(1);
  const EchoImage bright = render(1e10);  // one sample fits into a sum, all of a beam do not
  for (int beam = 0; beam < bright.beams; ++beam) {
    // Limited to 2^22 to 2^23 times its share of the fullest beam; the response of `unit` is cos phi > 0.8.
    EXPECT_GT(bright.at(beam, 0), 0x1p21F * unit.at(beam, 0));
    EXPECT_LT(bright.at(beam, 0), 0x1p23F / 0.8F * unit.at(beam, 0));
  }
  const EchoImage brighter = render(1e30);
  for (int beam = 0; beam < bright.beams; ++beam) {
    EXPECT_NEAR(brighter.at(beam, 0) / bright.at(beam, 0), 1, 0.01);
  }
}

/// An image too large for one OpenGL buffer has several pages; S8_LargestImage renders one.
TEST_F(GpuBinningTest, LargeImagesHavePages) {
  RasterSampler sampler(World{});
  GpuBinner binner(sampler);
  const RangeLines range{65535, 0.001, 0, false};
  const std::vector<float> no_weights;
  const BinningOptions options;
  binner.begin({1000, range, options, no_weights});
  EXPECT_GT(binner.beams_per_page(), 0);
  binner.ask_image();
  EXPECT_EQ(binner.take_image().echo.size(), 65'535'000U);
}

/// Images of changing size and kind, one after the other: nothing of one is left in the next.
TEST_F(GpuBinningTest, LeavesNothingBehindInTheNextImage) {
  const World world = make_world({make_body("bed", bed(4)), make_body("wall", wall(15))});
  SonarRenderer one(world, gpu());
  const auto expect_as_fresh = [&](int beams, int lines, Model model, bool turbid) {
    PingRequest request;
    request.T_world_sonar = looking({0, 0, 0}, 0, 15);
    request.settings.model = model;
    request.settings.aperture.beam_edges_rad = equal_angle_edges(beams, 90 * degree);
    request.settings.range = {lines, 20.0 / lines, 0, false};
    request.settings.sampling = Sampling::of_grid(2, 96, 96);
    if (turbid) {
      request.settings.physical.volume_scattering_db = -60;
    }
    SonarRenderer fresh(world, gpu());
    EXPECT_EQ(one.render_echo(request).intensity, fresh.render_echo(request).intensity);
  };
  for (const int lines : {1000, 300, 1200, 300}) {
    for (const int beams : {64, 16}) {
      expect_as_fresh(beams, lines, Model::physical, false);
      expect_as_fresh(beams, lines, Model::physical, true);
      expect_as_fresh(beams, lines, Model::paper, false);
    }
  }
}

// ---- estimates

/// A small fan of 8 columns a beam, in one view.
class BeamEstimates : public GpuBinningTest {
 protected:
  Aperture aperture_ = [] {
    Aperture aperture;
    aperture.beam_edges_rad = equal_angle_edges(4, 8 * degree);
    return aperture;
  }();
  const BeamRun run_{0, 4, {{4 * degree, -4 * degree, 32}}, 512};
  const BeamRun thinned_run_{0, 4, {{4 * degree, -4 * degree, 16}}, 256};
  const RangeLines range_{1000, 0.02, 0, false};
  const std::vector<float> no_weights_{};

  /// @param surface as RasterSampler::draw()
  std::vector<BeamEstimate> estimates(const World& world, const SurfaceModel& surface = {}) const {
    RasterSampler sampler(world);
    GpuBinner binner(sampler);
    const SampleGrid grid = make_sample_grid(aperture_, {run_});
    const SampleGrid thinned = make_sample_grid(aperture_, {thinned_run_});
    const auto on_gpu = binner.load(grid, all_beams(grid), &thinned);
    binner.begin({4, range_, options_, no_weights_, {0.001, 0.05}});
    binner.add(*on_gpu, sampler.draw({}, grid, surface, 21.0));
    binner.ask_estimates();
    return binner.take_estimates();
  }

  std::vector<float> image(const World& world, const BeamRun& run, const SurfaceModel& surface) const {
    RasterSampler sampler(world);
    GpuBinner binner(sampler);
    const SampleGrid grid = make_sample_grid(aperture_, {run});
    const auto on_gpu = binner.load(grid, all_beams(grid));
    binner.begin({4, range_, options_, no_weights_});
    binner.add(*on_gpu, sampler.draw({}, grid, surface, 21.0));
    binner.ask_image();
    return binner.take_image().echo;
  }

 private:
  const BinningOptions options_{};
};

/// A continuous surface has no edge. Every second sample, moved along the surface to the middle of its larger
/// pixel, makes the image of the coarser grid.
TEST_F(BeamEstimates, OfAPlaneAreSmallAndThoseOfTheCoarserGrid) {
  World world = make_world({make_body("slope", wall(0))});
  world.bodies[0].T_world_body = looking({9, 0, 0}, 25, 35);
  SurfaceModel even;  // a response of one half everywhere
  even.model = Model::paper;
  even.sigmoid_slope = 0;
  const std::vector<BeamEstimate> found = estimates(world, even);
  const std::vector<float> fine = image(world, run_, even), coarse = image(world, thinned_run_, even);
  for (std::size_t beam = 0; beam < 4; ++beam) {
    EXPECT_LT(found[beam].columns_total, 1e-4F) << beam;
    EXPECT_LT(found[beam].rows_total, 1e-4F) << beam;
    EXPECT_EQ(found[beam].thin, 0U) << beam;
    const float* echo = &fine[beam * 1000];
    const float strongest = *std::max_element(echo, echo + 1000);
    double squares = 0;
    unsigned bins = 0;
    for (std::size_t k = 0; k < 1000; ++k) {
      if (echo[k] > 0.01F * strongest) {
        squares += std::pow(static_cast<double>(coarse[beam * 1000 + k] / echo[k] - 1), 2);
        ++bins;
      }
    }
    EXPECT_EQ(found[beam].bins, bins) << beam;
    EXPECT_NEAR(static_cast<double>(found[beam].bin_squares), squares, 0.01 * squares + 1e-6) << beam;
  }
}

TEST_F(GpuBinningTest, PassesTheSelfTest) {
  EXPECT_LT(run_self_test(gpu()).error, 0.05);
}

}  // namespace
}  // namespace sonard::render
