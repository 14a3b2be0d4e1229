// SPDX-License-Identifier: Apache-2.0
// Frames of a run with a cause of a black picture, by cause.
#include <gtest/gtest.h>

#include "server/offline/frame_findings.hpp"

namespace sonard::server {
namespace {

constexpr std::int64_t one_s = 1'000'000'000;

/// Rises straight up by one metre in each of ten seconds, from 4.5 m below z = 0.
VehicleTrajectory rising() {
  return VehicleTrajectory(
      pose::Trajectory({{0, {{0, 0, -4.5}, {1, 0, 0, 0}}}, {10 * one_s, {{0, 0, 5.5}, {1, 0, 0, 0}}}}));
}

render::World sea() {
  render::World world;
  world.water_surface_z_m = 0.0;
  return world;
}

TEST(FrameFindings, CountsFramesInTheAir) {
  DaemonConfig config;
  config.heads.resize(1);
  const render::World world = sea();
  const VehicleTrajectory trajectory = rising();
  FrameFindings findings(world, config, 0, trajectory);
  for (int second = 0; second < 10; ++second) {
    ASSERT_TRUE(findings.wants(second));
    findings.add("ping_" + std::to_string(second), {.time_ns = second * one_s, .range_m = 5.0});
  }
  // At 5 s it is 0.5 m above the surface, and from then on it is above.
  EXPECT_EQ(findings.lines(), std::vector<std::string>{
                                  "5 of 10 frames: The sonar is 0.5 m above the water surface, in the air. "
                                  "(first in ping_5)"});
}

TEST(FrameFindings, AddsTheMountToThePose) {
  DaemonConfig config;
  config.heads.resize(1);
  config.heads[0].T_vehicle_sonar.position_m = {0, 0, -20};
  const render::World world = sea();
  const VehicleTrajectory trajectory = rising();
  FrameFindings findings(world, config, 0, trajectory);
  findings.add("ping_9", {.time_ns = 9 * one_s, .range_m = 5.0});
  EXPECT_TRUE(findings.lines().empty());
}

TEST(FrameView, OfASweepHasItsBestLine) {
  render::PingStatistics nothing, wall;
  nothing.sees_surface = false;
  nothing.echo_over_floor = 0.0;
  wall.sees_surface = true;
  wall.echo_over_floor = 7.0;
  FrameView view;
  view.add(nothing);
  EXPECT_FALSE(view.sees_surface);
  view.add(wall);
  view.add(nothing);
  EXPECT_TRUE(view.sees_surface);
  EXPECT_EQ(view.echo_over_floor, 7.0);
}

}  // namespace
}  // namespace sonard::server
