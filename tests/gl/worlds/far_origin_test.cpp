// SPDX-License-Identifier: Apache-2.0
// Worlds in UTM coordinates: seven digits before the decimal point, and the echo of a millimetre.
#include <algorithm>
#include <cmath>

#include "renderer/scene/terrain.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

class FarOrigin : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, FarOrigin, all_engines(), engine_name);

/// Terrain and a ball. The terrain's part holds half of the offset, its body the other, as a file may.
World world_at(const glm::dvec3& origin_m) {
  World world;
  world.bodies.push_back({"bed", {origin_m / 2.0, {1, 0, 0, 0}}, {}});
  GreyImage picture{300, 300, {}};
  for (int i = 0; i < 300 * 300; ++i) {
    picture.value.push_back(
        static_cast<std::uint16_t>(30000 + 20000 * std::sin(0.1 * (i % 300)) * std::cos(3e-4 * i)));
  }
  BodyPart part;
  part.T_body_part.position_m = origin_m / 2.0 + glm::dvec3(20, 0, -5);
  add_heightmap(std::move(picture), {60, 60, 2}, part, world, 0, world.bodies[0].parts);
  world.bodies.push_back(make_body("ball", make_sphere(0.5F, 12)));
  world.bodies[1].T_world_body.position_m = origin_m + glm::dvec3(9, 1, -3.5);
  return world;
}

PingRequest request_at(const glm::dvec3& origin_m, bool by_grid) {
  PingRequest request;
  request.T_world_sonar = looking(origin_m + glm::dvec3(0.125, -0.25, 0), 10, 15);
  request.settings.aperture.beam_edges_rad = equal_angle_edges(64, 1.2);
  request.settings.range = {600, 0.03125, 0, false};
  if (by_grid) {
    request.settings.sampling = Sampling::of_grid(2, 256, 256);
  }
  return request;
}

double worst_of_maximum(const EchoImage& a, const EchoImage& b) {
  const float largest = *std::max_element(b.intensity.begin(), b.intensity.end());
  double worst = 0.0;
  for (std::size_t i = 0; i < a.intensity.size(); ++i) {
    worst = std::max(worst, static_cast<double>(std::abs(a.intensity[i] - b.intensity[i]) / largest));
  }
  return worst;
}

/// Both engines use a grid; `cpu` uses slices too.
std::vector<bool> ways_for(EngineKind engine) {
  return engine == EngineKind::cpu ? std::vector<bool>{true, false} : std::vector<bool>{true};
}

TEST_P(FarOrigin, HasTheSameImageToTheBit) {
  const glm::dvec3 utm(500'000, 6'000'000, -1024);
  SonarRenderer near(world_at({}), options());
  SonarRenderer far(world_at(utm), options());
  for (const bool by_grid : ways_for(GetParam())) {
    const EchoImage& expected = near.render_echo(request_at({}, by_grid));
    EXPECT_GT(*std::max_element(expected.intensity.begin(), expected.intensity.end()), 0.0F);
    EXPECT_EQ(far.render_echo(request_at(utm, by_grid)).intensity, expected.intensity);
  }
}

// Positions that doubles round to a nanometre: single samples at edges may fall to the other side.
TEST_P(FarOrigin, LosesNoMoreThanDoublesDo) {
  const glm::dvec3 utm(500'000.123, 6'000'000.789, -1024.4567);
  SonarRenderer near(world_at({}), options());
  SonarRenderer far(world_at(utm), options());
  for (const bool by_grid : ways_for(GetParam())) {
    const double worst = worst_of_maximum(far.render_echo(request_at(utm, by_grid)),
                                          near.render_echo(request_at({}, by_grid)));
    std::printf("%s: %.2g of the maximum\n", by_grid ? "grid" : "slices", worst);
    EXPECT_LE(worst, 1e-3);
  }
}

TEST_P(FarOrigin, BodiesMoveThereAsWell) {
  const glm::dvec3 utm(500'000, 6'000'000, -1024);
  SonarRenderer near(world_at({}), options());
  SonarRenderer far(world_at(utm), options());
  const glm::dvec3 there(12.0009765625, -2, -3);  // a millimetre, exact in doubles at both places
  near.set_body_pose("ball", {there, {1, 0, 0, 0}});
  far.set_body_pose("ball", {utm + there, {1, 0, 0, 0}});
  EXPECT_EQ(far.render_echo(request_at(utm, true)).intensity,
            near.render_echo(request_at({}, true)).intensity);
}

}  // namespace
}  // namespace sonard::render
