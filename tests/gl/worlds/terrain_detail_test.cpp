// SPDX-License-Identifier: Apache-2.0
// SkipRule::terrain_detail: tiles as coarse as the sonar allows against every pixel of the map.
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "renderer/scene/heightfield.hpp"
#include "renderer/scene/mesh.hpp"
#include "renderer/scene/terrain.hpp"
#include "tests/scenes/scenes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

class TerrainDetail : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, TerrainDetail, all_engines(), engine_name);

/// A map of 1024 x 1024 pixels, 0.1 m each, in a fan of 30 degrees. `cpu` uses slices; `gpu` uses a grid, the
/// same with the rule and without.
Scene scene_for(EngineKind engine) {
  Scene scene = make_terrain_scene("terrain", 1024);
  scene.settings.aperture.beam_edges_rad = equal_angle_edges(64, 30 * std::acos(-1.0) / 180);
  scene.settings.sampling.preset = Sampling::Preset::reference;
  if (engine == EngineKind::gpu) {
    scene.settings.sampling = Sampling::of_grid(1, 512, 1024);
  }
  return scene;
}

struct Comparison {
  double worst_of_maximum = 0.0;
  double bin_rms = 0.0;  ///< of bins above 1e-2 of their beam's largest
};

Comparison compare(const EchoImage& image, const EchoImage& full) {
  const float largest = *std::max_element(full.intensity.begin(), full.intensity.end());
  Comparison result;
  double squares = 0.0;
  int bins = 0;
  for (int beam = 0; beam < full.beams; ++beam) {
    const auto of_beam = full.intensity.begin() + static_cast<std::ptrdiff_t>(beam) * full.bins;
    const float faint = 0.01F * *std::max_element(of_beam, of_beam + full.bins);
    for (int line = 0; line < full.bins; ++line) {
      const auto a = static_cast<double>(image.at(beam, line)), b = static_cast<double>(full.at(beam, line));
      result.worst_of_maximum =
          std::max(result.worst_of_maximum, std::abs(a - b) / static_cast<double>(largest));
      if (full.at(beam, line) > faint) {
        squares += (a / b - 1) * (a / b - 1);
        ++bins;
      }
    }
  }
  result.bin_rms = std::sqrt(squares / bins);
  return result;
}

TEST_P(TerrainDetail, StaysWithinItsBound) {
  const Scene scene = scene_for(GetParam());
  RendererOptions off_options = options();
  off_options.skip.turn_off(SkipRule::terrain_detail);
  SonarRenderer renderer(scene.world, options());
  SonarRenderer off(scene.world, off_options);
  const double ground_m = scene.T_world_sonar.position_m.z - 6;
  for (const auto& [above_m, yaw_deg] : {std::pair{6.0, 0.0}, {3.0, 130.0}, {12.0, -80.0}}) {
    PingRequest request = scene.request();
    request.T_world_sonar = looking({0, 0, ground_m + above_m}, yaw_deg, 15);
    const EchoImage& image = renderer.render_echo(request);
    const EchoImage& full = off.render_echo(request);
    const auto skipped = renderer.last_statistics().skipped.of(SkipRule::terrain_detail);
    EXPECT_GT(skipped, 1'000'000U) << "of 2.1 million triangles";
    EXPECT_EQ(off.last_statistics().skipped.of(SkipRule::terrain_detail), 0U);
    const Comparison found = compare(image, full);
    std::printf("%g m above ground, %g triangles left out: worst bin %.4f of the maximum, bin RMS %.2f %%\n",
                above_m, static_cast<double>(skipped), found.worst_of_maximum, 100 * found.bin_rms);
    EXPECT_GT(found.worst_of_maximum, 0.0);
    EXPECT_LE(found.worst_of_maximum, entry_of(SkipRule::terrain_detail).bound);
    EXPECT_LE(found.bin_rms, 0.08);
  }
}

// The detail of a ping depends on its own place and settings, not on earlier pings.
TEST_P(TerrainDetail, DependsOnThePingAlone) {
  const Scene scene = scene_for(GetParam());
  PingRequest here = scene.request();
  here.settings.sampling = Sampling::of_grid(1, 128, 128);
  PingRequest there = here;
  there.T_world_sonar.position_m += glm::dvec3(-20, 15, 2);
  there.settings.range.step_m *= 0.5;
  RendererOptions always = options();
  always.skip.turn_off(SkipRule::unchanged_scene);
  SonarRenderer renderer(scene.world, always);
  SonarRenderer fresh(scene.world, always);
  const EchoImage first = renderer.render_echo(here);
  const EchoImage elsewhere = renderer.render_echo(there);
  EXPECT_NE(elsewhere.intensity, first.intensity);
  EXPECT_EQ(fresh.render_echo(there).intensity, elsewhere.intensity);
  for (int i = 0; i < 3; ++i) {  // two sonars in turn
    EXPECT_EQ(renderer.render_echo(here, 0).intensity, first.intensity);
    EXPECT_EQ(renderer.render_echo(there, 1).intensity, elsewhere.intensity);
  }
}

// Noise that no coarser level approximates: the number of triangles is still limited.
TEST_P(TerrainDetail, DrawsNoMoreThanTwoMillionTriangles) {
  GreyImage noise{1100, 1100, {}};
  std::uint32_t random = 1;
  for (int i = 0; i < noise.width_px * noise.height_px; ++i) {
    random = random * 1664525U + 1013904223U;
    noise.value.push_back(static_cast<std::uint16_t>(random >> 16));
  }
  World world;
  world.bodies.push_back({"bed", {{0, 0, -5}, {1, 0, 0, 0}}, {}});
  add_heightmap(std::move(noise), {50, 50, 1}, {}, world, 0, world.bodies[0].parts);
  PingRequest request;
  request.T_world_sonar = looking({0, 0, 0}, 20, 20);
  request.settings.aperture.beam_edges_rad = equal_angle_edges(8, 0.3);
  request.settings.range = {500, 0.08, 0, false};
  request.settings.sampling = Sampling::of_grid(1, 64, 64);
  SonarRenderer renderer(world, options());
  renderer.render_echo(request);
  const std::uint64_t all = 2 * 1099 * 1099;
  EXPECT_GE(renderer.last_statistics().skipped.of(SkipRule::terrain_detail), all - 2'000'000);
  EXPECT_LT(renderer.last_statistics().skipped.of(SkipRule::terrain_detail), all);
}

// A plane is a plane at any level: tiles have the echo of two triangles, across all their seams.
TEST_P(TerrainDetail, OfAPlaneIsThePlane) {
  World tiles;
  tiles.bodies.push_back({"bed", {{0, 0, -5}, {1, 0, 0, 0}}, {}});
  BodyPart part;
  part.material.lambert_mu = 1.0;
  add_heightmap({700, 600, std::vector<std::uint16_t>(std::size_t{700} * 600, 0)}, {70, 60, 1}, part, tiles,
                0, tiles.bodies[0].parts);
  const World plane = make_world({make_body("bed", make_quad({-35, -30, -5}, {70, 0, 0}, {0, 60, 0}))});
  PingRequest request;
  request.T_world_sonar = looking({0, 0, 0}, 20, 20);
  request.settings.aperture.beam_edges_rad = equal_angle_edges(32, 1.0);
  request.settings.aperture.vertical_beamwidth_rad = 0.35;
  request.settings.range = {500, 0.04, 0, false};
  request.settings.sampling = Sampling::of_grid(2, 256, 512);
  SonarRenderer of_tiles(tiles, options());
  SonarRenderer of_plane(plane, options());
  const Comparison found = compare(of_tiles.render_echo(request), of_plane.render_echo(request));
  EXPECT_LE(found.worst_of_maximum, 1e-3);
  EXPECT_LE(found.bin_rms, 1e-3);
}

GreyImage waves_picture() {
  GreyImage picture{300, 280, {}};
  for (int y = 0; y < picture.height_px; ++y) {
    for (int x = 0; x < picture.width_px; ++x) {
      picture.value.push_back(
          static_cast<std::uint16_t>(30000 + 20000 * std::sin(0.15 * x) * std::cos(0.11 * y)));
    }
  }
  return picture;
}

/// 64 x 64 texels of crossing ripples, repeated once over the map.
std::shared_ptr<const NormalMap> ripples() {
  NormalMap map{64, 64, {}};
  for (int i = 0; i < 64 * 64; ++i) {
    map.rgb.push_back(static_cast<std::uint8_t>(128 + 60 * std::sin(0.6 * (i % 64))));
    map.rgb.push_back(static_cast<std::uint8_t>(128 + 40 * std::sin(0.3 * (i / 64))));
    map.rgb.push_back(230);
  }
  return std::make_shared<const NormalMap>(std::move(map));
}

// At their finest, tiles echo like the whole map in one mesh, with a normal map or without.
TEST_P(TerrainDetail, TilesAreHeardAsOneMesh) {
  const glm::dvec3 size_m(30, 28, 1);
  for (const bool mapped : {false, true}) {
    BodyPart part;
    part.T_body_part.position_m = {12, 0, -4};
    part.normal_map = mapped ? ripples() : nullptr;
    World whole;
    whole.bodies.push_back({"bed", {}, {part}});
    TriangleMesh mesh = make_heightfield(waves_picture(), size_m, {});
    add_tangents(mesh);
    whole.bodies[0].parts[0].mesh = std::make_shared<const TriangleMesh>(std::move(mesh));
    World tiles;
    tiles.bodies.push_back({"bed", {}, {}});
    add_heightmap(waves_picture(), size_m, part, tiles, 0, tiles.bodies[0].parts);
    RendererOptions finest = options();
    finest.skip.turn_off(SkipRule::terrain_detail);
    SonarRenderer of_tiles(tiles, finest);
    SonarRenderer of_whole(whole, finest);
    PingRequest request;
    request.T_world_sonar = looking({0, 0, 0}, 5, 20);
    request.settings.aperture.beam_edges_rad = equal_angle_edges(32, 1.0);
    request.settings.range = {500, 0.04, 0, false};
    request.settings.sampling = Sampling::of_grid(2, 256, 512);
    const Comparison found = compare(of_tiles.render_echo(request), of_whole.render_echo(request));
    std::printf("%s: worst bin %.2g of the maximum\n", mapped ? "mapped" : "plain", found.worst_of_maximum);
    EXPECT_LE(found.worst_of_maximum, mapped ? 0.01 : 0.001);
  }
}

}  // namespace
}  // namespace sonard::render
