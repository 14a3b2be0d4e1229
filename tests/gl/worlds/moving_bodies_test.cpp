// SPDX-License-Identifier: Apache-2.0
// Bodies that move from ping to ping, and their shadows.
#include <cmath>
#include <string>
#include <vector>

#include "tests/scenes/scenes.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

class MovingBodies : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, MovingBodies, all_engines(), engine_name);

constexpr double height_m = 5.0;  // of the sonar
constexpr double line_m = 0.02;
const glm::dvec3 box_m(0.6, 4.0, 1.0);

PingRequest request_for(EngineKind engine) {
  PingRequest request;
  request.T_world_sonar = looking({0, 0, height_m}, 0, 25);
  request.settings.aperture.beam_edges_rad = equal_angle_edges(9, 0.1);
  request.settings.aperture.vertical_beamwidth_rad = 0.5;
  request.settings.range = {1000, line_m, 0, false};
  if (engine == EngineKind::gpu) {
    request.settings.sampling = Sampling::of_grid(1, 128, 4096);
  }
  return request;
}

// Straight ahead, with the far upper edge of the box at x and z = h: there is no echo between that edge, at
// hypot(x, H - h), and the end of the shadow on the bed, at x H / (H - h).
void expect_shadow(const EchoImage& image, double far_edge_m) {
  const int beam = image.beams / 2;
  const double first_m = std::hypot(far_edge_m, height_m - box_m.z);
  const double last_m = std::hypot(far_edge_m * height_m / (height_m - box_m.z), height_m);
  for (int line = 0; line < image.bins; ++line) {
    const double begin_m = line * line_m, end_m = begin_m + line_m;
    if (begin_m > first_m + 2 * line_m && end_m < last_m - 2 * line_m) {
      EXPECT_EQ(image.at(beam, line), 0.0F) << begin_m << " m, box to " << far_edge_m;
    } else if (begin_m > last_m + 2 * line_m && end_m < last_m + 0.5) {
      EXPECT_GT(image.at(beam, line), 0.0F) << begin_m << " m, box to " << far_edge_m;
    } else if (end_m < first_m && begin_m > first_m - 0.3) {
      EXPECT_GT(image.at(beam, line), 0.0F) << begin_m << " m, box to " << far_edge_m;
    }
  }
}

TEST_P(MovingBodies, TakeTheirShadowsAlong) {
  SonarRenderer renderer(make_world({make_body("bed", make_quad({-10, -30, 0}, {60, 0, 0}, {0, 60, 0})),
                                     make_body("box", make_block({0, 0, box_m.z / 2}, box_m, 0))}),
                         options());
  const PingRequest request = request_for(GetParam());
  for (const double far_edge_m : {9.0, 9.05, 10.4, 8.2}) {
    ASSERT_TRUE(renderer.set_body_pose("box", {{far_edge_m - box_m.x / 2, 0, 0}, {1, 0, 0, 0}}));
    expect_shadow(renderer.render_echo(request), far_edge_m);
  }
}

// 200 moved bodies echo as in a world that has them there from the start.
TEST_P(MovingBodies, AreHeardWhereTheyAre) {
  const Scene scene = make_bodies_scene("bodies");
  World there = scene.world;
  SonarRenderer renderer(scene.world, options());
  PingRequest by_grid = scene.request();
  by_grid.settings.sampling = Sampling::of_grid(2, 256, 256);
  PingRequest by_slices = scene.request();
  by_slices.settings.sampling.preset = Sampling::Preset::fast;
  const std::vector<PingRequest> ways =
      GetParam() == EngineKind::cpu ? std::vector{by_grid, by_slices} : std::vector{by_grid};
  for (const int ping : {1, 2, 7}) {
    for (std::size_t i = 1; i < there.bodies.size(); ++i) {
      there.bodies[i].T_world_body = drifting_pose(scene.world.bodies[i].T_world_body, i, ping);
      ASSERT_TRUE(renderer.set_body_pose(there.bodies[i].name, there.bodies[i].T_world_body));
    }
    SonarRenderer fresh(there, options());
    for (const PingRequest& request : ways) {
      const EchoImage image = renderer.render_echo(request);
      EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::unchanged_scene), 0U);
      EXPECT_EQ(fresh.render_echo(request).intensity, image.intensity) << "ping " << ping;
    }
    for (const Body& body : there.bodies) {  // a repeated pose moves nothing
      ASSERT_TRUE(renderer.set_body_pose(body.name, body.T_world_body));
    }
    renderer.render_echo(ways.back());
    EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::unchanged_scene), 1U);
  }
}

}  // namespace
}  // namespace sonard::render
