// SPDX-License-Identifier: Apache-2.0
// Features that the three scenes of figure 7 must show. Places and sizes are computed by hand from
// configs/worlds/generate and the trajectories, not measured in the images.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/gl/scenes_of_the_paper/scene_echo.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {
namespace {

class FanScenes : public EngineTest {};
INSTANTIATE_TEST_SUITE_P(Engines, FanScenes, all_engines(), engine_name);

const render::RendererOptions on_cpu{render::EngineKind::cpu};

// The manifold, seen from (0, -11.9), 5.5 m above its level bed: 1.8 m high, its back 13.3 m ahead.
// docs/physics.md T7: shadow on (r_base, r_top h / (h - H)), both ranges of the back.
constexpr double altitude_m = 5.5;
constexpr double height_m = 1.8;
constexpr double front_m = 10.5;
constexpr double back_m = 13.3;

TEST_P(FanScenes, ShadowBehindTheManifold) {
  const SceneEcho scene("manifold", options());
  for (double bearing = -8; bearing <= 8; bearing += 1) {
    const int beam = scene.beam_at(bearing * degree);
    const double along = back_m / std::cos(scene.azimuth_rad(beam));
    const double base_m = std::hypot(along, altitude_m);
    const double end_m = std::hypot(along, altitude_m - height_m) * altitude_m / (altitude_m - height_m);
    const double bed = scene.median(beam, end_m + 0.2, end_m + 1.2);
    ASSERT_GT(bed, 0) << bearing;
    // Across the beam the end moves by up to 3 cm; the shadow is 6 m long.
    EXPECT_EQ(scene.energy(beam, base_m + 0.05, end_m - 0.10), 0) << bearing;
    EXPECT_NEAR(scene.first_range_m(beam, base_m + 0.05, 0.1 * bed), end_m, 0.05) << bearing;
  }
}

TEST(FanScenesOnRay, FrontalFaceOfTheManifold) {
  const SceneEcho scene("manifold", on_cpu);
  const double bed = scene.median(scene.beam_at(30 * degree), 12.0, 12.6);
  for (double bearing = -12; bearing <= 12; bearing += 1) {
    const int beam = scene.beam_at(bearing * degree);
    const double along = front_m / std::cos(scene.azimuth_rad(beam));
    const double top_m = std::hypot(along, altitude_m - height_m);
    const double face = scene.strongest(beam, top_m - 0.3, top_m + 0.8);
    EXPECT_GT(face, 10 * bed) << bearing;
    // The face begins at its upper edge; receptacles are up to 0.18 m nearer.
    const double seen_m = scene.first_range_m(beam, top_m - 0.5, 0.1 * face);
    EXPECT_GT(seen_m, top_m - 0.25) << bearing;
    EXPECT_LT(seen_m, top_m + 0.05) << bearing;
  }
}

TEST(FanScenesOnRay, FlowlinesOfTheManifoldGoOn) {
  const SceneEcho scene("manifold", on_cpu);
  // Along y = 0 between the ends of the cover and x = +-8, their crowns at 4.6 to 5.6 m below the sonar.
  for (const double side : {-1.0, 1.0}) {
    double before_m = 0;
    int followed = 0;
    const int first = scene.beam_at(side * 18.5 * degree);
    const int last = scene.beam_at(side * 33 * degree);
    for (int beam = first; beam != last; beam += last > first ? 1 : -1) {
      const double along = 11.9 / std::cos(scene.azimuth_rad(beam));
      const double from_m = std::hypot(along - 0.25, 4.6);
      const double to_m = std::hypot(along, 5.6);
      const double pipe_m = scene.strongest_range_m(beam, from_m, to_m);
      EXPECT_GT(scene.strongest(beam, from_m, to_m), 4 * scene.median(beam, to_m + 3, to_m + 4)) << beam;
      if (followed++ > 0) {
        EXPECT_LT(std::abs(pipe_m - before_m), 0.15) << beam;
      }
      before_m = pipe_m;
    }
    EXPECT_GT(followed, 30);
  }
}

// The docking station, seen from (-2.136, -11.913, -25.6), heading 80 degrees. The pipeline, 0.6 m thick,
// half buried in places, runs along y = -3.7 + 0.7 sin^2((x + 3) / 15) - 0.3 sin(x / 6.5) on a bed 30 m deep.
double pipeline_y(double x) {
  const double wave = std::sin((x + 3) / 15);
  return -3.7 + 0.7 * wave * wave - 0.3 * std::sin(x / 6.5);
}

/// Horizontal distance from the sonar to the pipeline along a heading.
double distance_to_pipeline(double heading_rad) {
  double distance = 8;
  for (int i = 0; i < 50; ++i) {  // a fixed point: the line is nearly straight
    const double x = -2.136 + distance * std::cos(heading_rad);
    distance = (pipeline_y(x) + 11.913) / std::sin(heading_rad);
  }
  return distance;
}

TEST_P(FanScenes, PipelineBeforeTheDockingStationGoesOn) {
  const SceneEcho scene("docking_station", options());
  int followed = 0;
  double before_m = 0;
  // Between the mattresses that lie over it at x = -12.6 and 12.
  for (int beam = scene.beam_at(40 * degree); beam < scene.beam_at(-35 * degree); ++beam) {
    const double along = distance_to_pipeline(80 * degree + scene.azimuth_rad(beam));
    const double from_m = std::hypot(along - 0.3, 3.6);
    const double to_m = std::hypot(along, 4.7);
    const double pipe_m = scene.strongest_range_m(beam, from_m, to_m);
    EXPECT_GT(scene.strongest(beam, from_m, to_m), 4 * scene.median(beam, 15, 18)) << beam;
    if (followed++ > 0) {
      EXPECT_LT(std::abs(pipe_m - before_m), 0.25) << beam;
    }
    before_m = pipe_m;
  }
  EXPECT_GT(followed, 100);
}

TEST(FanScenesOnRay, DockingStationIsBrighterThanTheBedAndCastsAShadow) {
  const SceneEcho scene("docking_station", on_cpu);
  // Base beam of the south side: y = 0.6 - 1.35 - 0.10, z = -30.044 + 0.32 +- 0.11, x from -1.5 to 1.5.
  for (double x = -1.4; x <= 1.4; x += 0.4) {
    const double heading = std::atan2(-0.85 + 11.913, x + 2.136);
    const int beam = scene.beam_at(heading - 80 * degree);
    const double face_m = std::sqrt(std::pow(-0.85 + 11.913, 2) + std::pow(x + 2.136, 2) + std::pow(4.12, 2));
    // Upright steel, mu -15 dB, over sand, -13 dB, at a grazing angle of sine 4.4 / 9.2: 4.4 dB, 2.8 times.
    EXPECT_GT(scene.strongest(beam, face_m - 0.15, face_m + 0.25), 2.8 * scene.median(beam, 8.8, 9.6)) << x;
    // Behind roof, tunnel and equipment at least half of the bed is in shadow; beside it hardly any.
    const double behind = scene.energy(beam, 16.5, 19.5);
    const double beside = scene.energy(scene.beam_at(-22 * degree), 16.5, 19.5);
    EXPECT_LT(behind, 0.5 * beside) << x;
  }
}

// The SSIV, seen from 13.5 (cos -70, sin -70) and z = -37.7, heading 110 degrees. Its bed is at -42.249. The
// long member of its base ring, radius a = 0.17, runs along y = -2.5 at 0.22 above the bed. In its first line
// of 8.3 mm a tube of mu -15 dB has the energy 2 a / R * mu cos^2(off) * 0.31. A line of the bed of -13 dB
// has mu sin(gamma) tan(gamma) / R * 8.3 mm. At 15 to 32 degrees off its normal a beam of 0.4 degrees spreads
// the tube over 3 to 7 lines, so the tube is 14 to 4.6 times as strong as the bed.
TEST(FanScenesOnRay, FrontalFaceOfTheValve) {
  const SceneEcho scene("ssiv", on_cpu);
  const double sonar_x = 13.5 * std::cos(-70 * degree);
  const double sonar_y = 13.5 * std::sin(-70 * degree);
  const double below = -37.7 + 42.249 - 0.22;
  for (double x = -1.8; x <= 1.8; x += 0.3) {
    const int beam = scene.beam_at(std::atan2(-2.5 - sonar_y, x - sonar_x) - 110 * degree);
    const double heading = 110 * degree + scene.azimuth_rad(beam);
    const double along = (-2.5 - sonar_y) / std::sin(heading);
    const double face_m = std::hypot(along, below) - 0.17;
    const double bed = scene.median(beam, face_m - 1.5, face_m - 0.5);
    EXPECT_NEAR(scene.first_range_m(beam, face_m - 0.4, 3 * bed), face_m, 0.08) << x;
  }
}

TEST(FanScenesOnRay, ShadowOfTheValve) {
  const SceneEcho scene("ssiv", on_cpu);
  // Its roof, 3.1 m high, shadows the bed far beyond the range. Behind its far side, at most 3.6 m from the
  // middle, the bed echoes through gaps only.
  const double beside = scene.energy(scene.beam_at(-29 * degree), 17.5, 19.5);
  for (double bearing = -4; bearing <= 8; bearing += 1) {
    const int beam = scene.beam_at(bearing * degree);
    EXPECT_LT(scene.energy(beam, 17.8, 19.5), 0.3 * beside) << bearing;
  }
}

}  // namespace
}  // namespace sonard::test
