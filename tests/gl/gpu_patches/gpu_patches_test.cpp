// SPDX-License-Identifier: Apache-2.0
// The stages from visible segments to the image on the GPU: against those of the CPU engine, and closed
// forms.
#include <cmath>
#include <cstdint>
#include <iostream>
#include <memory>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "renderer/engines/gpu/egl_context.hpp"
#include "tests/gl/gpu_patches/both_sides.hpp"
#include "tests/support/gl_context_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

class GpuPatchesTest : public test::GlContextTest {
 protected:
  /// The image of the GPU must be that of the CPU engine.
  /// @return number of places where several patches lie side by side
  std::size_t compare(const std::string& name, const Ping& ping, double most_rms = 1e-4) {
    SCOPED_TRACE(name);
    BothSides sides(*context_, ping);
    const BinningResult cpu = sides.of_cpu(), gpu = sides.of_gpu();
    const int lines = ping.settings.range.count;
    const Difference joined = difference(cpu.echo, gpu.echo, lines);
    const Difference lone = difference(sides.of_lone_patches(), gpu.echo, lines);
    std::cout << name << ": RMS " << lone.rms << " (with joined ends " << joined.rms << "), totals "
              << lone.totals << ", patches " << gpu.samples << "\n";
    EXPECT_LE(joined.rms, 1e-3);
    EXPECT_LE(lone.rms, most_rms);
    EXPECT_LE(lone.totals, 1e-4);
    EXPECT_EQ(gpu.invalid_samples, cpu.invalid_samples);
    expect_count(gpu.samples, cpu.samples);
    expect_count(gpu.skipped.of(SkipRule::facet_kernel), cpu.skipped.of(SkipRule::facet_kernel));
    EXPECT_EQ(gpu.skipped.of(SkipRule::empty_beams), cpu.skipped.of(SkipRule::empty_beams));
    if (ping.open_water) {
      const Difference open = difference(cpu.open_sr, gpu.open_sr, lines);
      EXPECT_LE(open.rms, 1e-5);
      EXPECT_LE(open.totals, 1e-5);
    }
    return sides.count_beside();
  }

  /// A segment may be divided otherwise if a number lies at a limit.
  static void expect_count(std::uint64_t found, std::uint64_t expected) {
    EXPECT_NEAR(static_cast<double>(found), static_cast<double>(expected),
                1e-4 * static_cast<double>(expected));
  }
};

Ping ping_of(const std::string& scene) {
  return Ping(make_scene(scene));
}

/// A bed with smooth bumps and a normal map of finer ones, and a ball with vertex normals.
World bumpy_world(bool mapped) {
  constexpr std::uint32_t cells = 40;
  TriangleMesh bed;
  for (std::uint32_t i = 0; i <= cells; ++i) {
    for (std::uint32_t j = 0; j <= cells; ++j) {
      const float x = 2.0F + 18.0F * static_cast<float>(i) / cells,
                  y = 40.0F * static_cast<float>(j) / cells - 20.0F;
      bed.positions.emplace_back(x, y, 0.2F * std::sin(x) * std::cos(0.7F * y));
      bed.normals.push_back(glm::normalize(glm::vec3(-0.2F * std::cos(x) * std::cos(0.7F * y),
                                                     0.14F * std::sin(x) * std::sin(0.7F * y), 1.0F)));
      bed.texcoords.emplace_back(0.3F * x, 0.3F * y);
      bed.tangents.emplace_back(1, 0, 0, 1);
    }
  }
  for (std::uint32_t i = 0; i < cells; ++i) {
    for (std::uint32_t j = 0; j < cells; ++j) {
      const std::uint32_t at = i * (cells + 1) + j, beyond = at + cells + 1;
      bed.indices.insert(bed.indices.end(), {at, beyond, at + 1, at + 1, beyond, beyond + 1});
    }
  }
  NormalMap map{24, 17, {}};
  std::mt19937 random(1);  // NOLINT(cert-msc51-cpp): the same map in each run
  for (int i = 0; i < map.width_px * map.height_px; ++i) {
    map.rgb.insert(map.rgb.end(), {static_cast<std::uint8_t>(100 + random() % 56),
                                   static_cast<std::uint8_t>(100 + random() % 56), 240});
  }
  World world =
      make_world({make_body("bed", std::move(bed), 0.1), make_body("ball", make_sphere(0.8F, 24), 0.1)});
  world.bodies[1].T_world_body.position_m = {9, 1, 0.7};
  for (Body& body : world.bodies) {
    body.parts[0].material.pressure_reflection = 0.4;
    body.parts[0].material.rms_slope = 0.1;
  }
  if (mapped) {
    world.bodies[0].parts[0].normal_map = std::make_shared<const NormalMap>(std::move(map));
  }
  return world;
}

Ping ping_over_bumps(bool mapped) {
  Scene scene = make_scene("plane");
  scene.world = bumpy_world(mapped);
  scene.settings.aperture.elevation = Aperture::Elevation::sinc;
  scene.settings.aperture.beam_edges_rad = equal_angle_edges(48, 1.2);
  scene.settings.sampling.preset = Sampling::Preset::fast;
  return Ping(scene);
}

TEST_F(GpuPatchesTest, PlainSurfaces) {
  for (const char* scene : {"flat100k", "b3_cluster", "b4_manifold_1e4", "b7_pipes", "msis_swell"}) {
    compare(scene, ping_of(scene));
  }
}

TEST_F(GpuPatchesTest, ElevationPatternAndOpenWater) {
  Ping ping = ping_of("swell100k");
  ping.settings.aperture.elevation = Aperture::Elevation::sinc;
  ping.open_water = true;
  compare("swell100k, sinc", ping);
}

/// Vertex normals, facets of many materials, some wide or side by side, and lines that would be negative.
TEST_F(GpuPatchesTest, FacetsAndVertexNormals) {
  Ping ping = ping_of("docking_demo");
  ping.settings.sampling.preset = Sampling::Preset::fast;
  EXPECT_GT(compare("docking_demo", ping), 1000U) << "facets at one side of the wedge";
  ping.skip.turn_off(SkipRule::facet_kernel);
  compare("docking_demo, facets everywhere", ping);
}

/// Of smooth metal, whose facets echo within a few degrees.
TEST_F(GpuPatchesTest, FacetsAcrossTheWedge) {
  Ping ping = ping_over_bumps(false);
  for (Body& body : ping.world.bodies) {
    body.parts[0].material.pressure_reflection = 0.94;
    body.parts[0].material.rms_slope = 0.01;
  }
  compare("smooth metal", ping);
}

TEST_F(GpuPatchesTest, MeansOfThePaper) {
  Ping ping = ping_of("b3_cluster");
  ping.settings.model = Model::paper;
  ping.settings.paper = PaperModel::release_2018();
  ping.settings.sampling.preset = Sampling::Preset::fast;
  compare("b3_cluster", ping, 1e-3);  // the mean of a line with few echoes is a ratio of small numbers
}

TEST_F(GpuPatchesTest, NormalMaps) {
  Ping ping = ping_over_bumps(true);
  compare("bumps", ping);
  ping.settings.physical.backscatter = PhysicalModel::Backscatter::lambert;
  compare("bumps without facets", ping);
}

TEST_F(GpuPatchesTest, Refraction) {
  Ping ping = ping_over_bumps(false);
  ping.bend_per_m = 2e-3;
  ping.skip.turn_off(SkipRule::coplanar_facets);
  compare("bent bumps", ping);
  Ping mapped = ping_over_bumps(true);
  mapped.bend_per_m = 2e-3;
  mapped.skip.turn_off(SkipRule::coplanar_facets);
  compare("bent mapped bumps", mapped);
}

/// All of a ping on the GPU, with one read-back, against all of it on the CPU.
TEST_F(GpuPatchesTest, SlicesOfTheGpu) {
  const Ping ping = ping_of("b3_cluster");
  BothSides sides(*context_, ping);
  const BinningResult cpu = sides.of_cpu(), gpu = sides.of_gpu(false);
  const Difference off = difference(cpu.echo, gpu.echo, cpu.lines);
  EXPECT_LE(off.rms, 2e-3);
  EXPECT_LE(off.totals, 1e-3);
}

/// A beam receives mu cos(phi) of a wall across the axis from all its directions, and cos(phi) is the product
/// of the cosines of azimuth and elevation.
TEST_F(GpuPatchesTest, WallInClosedForm) {
  const Ping ping = ping_of("b1_wall");
  BothSides sides(*context_, ping);
  const BinningResult gpu = sides.of_gpu();
  const std::vector<double>& edges = ping.settings.aperture.beam_edges_rad;
  const double limit = ping.settings.aperture.elevation_limit_rad();
  for (std::size_t beam = 0; beam + 1 < edges.size(); ++beam) {
    const auto first = gpu.echo.begin() + static_cast<std::ptrdiff_t>(beam) * gpu.lines;
    const double truth = scene_lambert_mu * (std::sin(edges[beam]) - std::sin(edges[beam + 1])) *
                         (limit + 0.5 * std::sin(2 * limit));
    ASSERT_NEAR(std::accumulate(first, first + gpu.lines, 0.0), truth, 1e-3 * truth) << "beam " << beam;
  }
}

/// Slices, and so lists and segments, in another order; and parts in buffers that were too small at first.
TEST_F(GpuPatchesTest, PlacesInBuffersDoNotMatter) {
  const Ping ping = ping_over_bumps(false);
  BothSides sides(*context_, ping);
  const BinningResult once = sides.of_gpu();
  EXPECT_EQ(sides.tries, 1);
  std::shuffle(sides.gpu_cells.begin(), sides.gpu_cells.end(), std::mt19937(2));  // NOLINT(cert-msc51-cpp)
  sides.buffers.room.pieces = 1000;
  const BinningResult again = sides.of_gpu();
  EXPECT_GT(sides.tries, 1);
  EXPECT_EQ(once.echo, again.echo);
  EXPECT_EQ(once.samples, again.samples);
}

TEST_F(GpuPatchesTest, SeveralPingsInFlight) {
  const Ping ping = ping_over_bumps(false);
  BothSides sides(*context_, ping);
  const BinningResult all = sides.of_gpu();
  PingBuffers others(sides.compute().gl());
  others.room = sides.buffers.room;
  sides.begin(sides.buffers);
  sides.gpu_cells.resize(sides.gpu_cells.size() / 2);
  sides.begin(others);
  const auto first = sides.finish(sides.buffers), second = sides.finish(others);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->echo, all.echo);
  EXPECT_GT(second->samples, 0U);
  EXPECT_LT(second->samples, all.samples);
}

/// Slices that were divided have no echo: their parts have it.
TEST_F(GpuPatchesTest, DividedSlicesHaveNoEcho) {
  const Ping ping = ping_over_bumps(false);
  BothSides sides(*context_, ping);
  const BinningResult once = sides.of_gpu();
  std::vector<GpuSlice> wholes(sides.gpu_cells.begin(), sides.gpu_cells.begin() + 20);
  for (GpuSlice& whole : wholes) {
    whole.state = records::is_divided;
  }
  sides.gpu_cells.insert(sides.gpu_cells.begin() + 7, wholes.begin(), wholes.end());
  EXPECT_EQ(once.echo, sides.of_gpu().echo);
}

/// As many invocations as on a GPU.
TEST_F(GpuPatchesTest, LargeGroups) {
  const Ping ping = ping_over_bumps(true);
  BothSides few(*context_, ping), many(*context_, ping, {.group = 64});
  const BinningResult of_few = few.of_gpu(), of_many = many.of_gpu();
  EXPECT_LE(difference(of_few.echo, of_many.echo, of_few.lines).rms, 1e-4);
}

}  // namespace
}  // namespace sonard::render
