// SPDX-License-Identifier: Apache-2.0
// Features that the three scenes of figure 8 must show: docs/worlds.md has their geometry in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/gl/scenes_of_the_paper/scene_echo.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {
namespace {

constexpr double half_beam = 1.5 * degree;

class ScannedScenes : public EngineTest {};
INSTANTIATE_TEST_SUITE_P(Engines, ScannedScenes, all_engines(), engine_name);

const render::RendererOptions scanned_on_cpu{render::EngineKind::cpu};

/// Distances, m, from a point inside an upright rectangle to its sides.
struct Room {
  double ahead, port, astern, starboard;

  double range(double azimuth) const {
    const double x = std::cos(azimuth);
    const double y = std::sin(azimuth);
    return std::min((x > 0 ? ahead : astern) / std::max(std::abs(x), 1e-9),
                    (y > 0 ? port : starboard) / std::max(std::abs(y), 1e-9));
  }
  double nearest(double azimuth) const { return extreme(azimuth, -1); }
  double farthest(double azimuth) const { return extreme(azimuth, 1); }

 private:
  /// Over the width of a beam.
  double extreme(double azimuth, double sign) const {
    double best = sign * range(azimuth);
    for (double off = -half_beam; off <= half_beam; off += half_beam / 50) {
      best = std::max(best, sign * range(azimuth + off));
    }
    return sign * best;
  }
};

TEST_P(ScannedScenes, WallsOfTheTank) {
  const SceneEcho scene("tank", options(), 5);
  ASSERT_EQ(scene.beams(), 40);
  const Room tank{8, 5.5, 6, 4.5};
  const auto occupied = [](double bearing_deg) {  // docs/worlds.md: pillar, ladder, inlet, target
    for (const auto& [low, high] : {std::pair{11, 18}, {67, 73}, {155, 165}, {-66, -54}}) {
      if (bearing_deg > low - 2 && bearing_deg < high + 2) {
        return true;
      }
    }
    return false;
  };
  int walls = 0;
  for (int line = 0; line < scene.beams(); ++line) {
    const double azimuth = scene.azimuth_rad(line);
    if (occupied(std::remainder(azimuth / degree, 360))) {
      continue;
    }
    const double strongest = scene.strongest(line, 0, 12);
    EXPECT_NEAR(scene.first_range_m(line, 0, 1e-3 * strongest), tank.nearest(azimuth), 1.5 * scene.step_m())
        << azimuth / degree;
    // Nothing lies beyond the farthest wall at the beam's upper and lower edge, 17.5 degrees off.
    EXPECT_EQ(scene.energy(line, tank.farthest(azimuth) / std::cos(17.5 * degree) + 0.1, 12), 0)
        << azimuth / degree;
    ++walls;
  }
  EXPECT_GT(walls, 33);
}

TEST(ScannedScenesOnRay, PillarOfTheTankHidesTheWall) {
  const SceneEcho scene("tank", scanned_on_cpu);
  // Radius 0.3 m about (5, 1.3) from the sonar: nearest at hypot(5, 1.3) - 0.3, half of its width is
  // asin(0.3 / 5.166) = 3.3 degrees.
  const double bearing = std::atan2(1.3, 5.0);
  const int line = scene.beam_at(bearing);
  EXPECT_NEAR(scene.first_range_m(line, 0, 1e-3 * scene.strongest(line, 0, 12)), std::hypot(5, 1.3) - 0.3,
              1.5 * scene.step_m());
  EXPECT_EQ(scene.energy(line, 6, 12), 0);
}

TEST(ScannedScenesOnRay, TargetInTheTank) {
  const SceneEcho scene("tank", scanned_on_cpu);
  // A sphere of radius 0.25 m about (1.5, -2.6, 0) from the sonar.
  const int line = scene.beam_at(std::atan2(-2.6, 1.5));
  EXPECT_NEAR(scene.first_range_m(line, 0, 1e-3 * scene.strongest(line, 0, 4)), std::hypot(1.5, 2.6) - 0.25,
              1.5 * scene.step_m());
}

/// Yaw of the vehicle, rad, during a line of the scene `grid`: lines are 0.05 s apart and the turn of 2
/// degrees per second begins with the first.
double yaw_at(int line) {
  return 2 * degree * 0.05 * line;
}

const Room cage{4, 4, 4, 4};

/// True if the first echo of a line comes from the walls of the cage, with bars and rails of up to 0.1 m.
bool agrees_with_cage(const SceneEcho& scene, int line, double yaw) {
  const double heading = scene.azimuth_rad(line) + yaw;
  const double first = scene.first_range_m(line, 0, 1e-2 * scene.strongest(line, 0, 8));
  return first > cage.nearest(heading) - 0.16 && first < cage.farthest(heading) + 0.03;
}

bool in_gate(double heading) {
  return std::abs(std::remainder(heading, 2 * std::numbers::pi)) < std::atan2(1.0, 4.0) + half_beam;
}

TEST(ScannedScenesOnRay, CageIsShearedByTheTurn) {
  const SceneEcho scene("grid", scanned_on_cpu);
  ASSERT_EQ(scene.beams(), 200);
  int agree = 0;
  int agree_at_rest = 0;
  int lines = 0;
  for (int line = 0; line < scene.beams(); ++line) {
    const double heading = scene.azimuth_rad(line) + yaw_at(line);
    if (in_gate(heading)) {
      continue;
    }
    ++lines;
    EXPECT_TRUE(agrees_with_cage(scene, line, yaw_at(line))) << heading / degree;
    agree += agrees_with_cage(scene, line, yaw_at(line)) ? 1 : 0;
    agree_at_rest += agrees_with_cage(scene, line, 0) ? 1 : 0;
  }
  EXPECT_GT(lines, 180);
  EXPECT_EQ(agree, lines);
  EXPECT_LT(agree_at_rest, 0.6 * lines);  // a vehicle at rest has another picture
}

TEST(ScannedScenesOnRay, BarsOfTheCageDriftAgainstTheTurn) {
  const SceneEcho scene("grid", scanned_on_cpu);
  const auto energy_near = [&](double heading, double range_m, int& line) {
    // The line in which the head, with the vehicle's turn, points along this heading.
    line = 0;
    const auto off = [&](int l) {
      return std::abs(std::remainder(scene.azimuth_rad(l) + yaw_at(l) - heading, 2 * std::numbers::pi));
    };
    for (int l = 1; l < scene.beams(); ++l) {
      line = off(l) < off(line) ? l : line;
    }
    return scene.energy(line, range_m - 0.25, range_m + 0.35);
  };
  for (const double side : {0.0, 90.0, 180.0, 270.0}) {
    for (int y = -2; y < 2; ++y) {
      // The gate has no bar and no rails. The turn takes 20 degrees off the end of the scan, beyond astern.
      if ((side == 0.0 && (y == -1 || y == 0)) || (side == 180.0 && y >= 0)) {
        continue;
      }
      // A bar, and half-way to the next one, where there are only rails.
      int bar_line = 0;
      int gap_line = 0;
      const double bar = energy_near(side * degree + std::atan2(y, 4.0), std::hypot(y, 4.0), bar_line);
      const double gap =
          energy_near(side * degree + std::atan2(y + 0.5, 4.0), std::hypot(y + 0.5, 4.0), gap_line);
      EXPECT_NE(bar_line, gap_line);
      EXPECT_GT(bar, 1.2 * gap) << "side " << side << " bar " << y;
    }
  }
}

TEST(ScannedScenesOnRay, GateOfTheCageIsOpen) {
  const SceneEcho scene("grid", scanned_on_cpu);
  int open = 0;
  for (int line = 0; line < scene.beams(); ++line) {
    const double heading = std::remainder(scene.azimuth_rad(line) + yaw_at(line), 2 * std::numbers::pi);
    // No bar at y = 0, no rails between y = -1 and 1, 2 m above and below: the beam, 1.26 m high there,
    // passes.
    if (std::abs(heading) < std::atan2(0.9, 4.0) - half_beam) {
      EXPECT_EQ(scene.energy(line, 0, 6), 0) << heading / degree;
      ++open;
    }
  }
  EXPECT_GE(open, 10);
}

// Oil and gas: from (0, 0, -24.5); azimuth 0 is straight down, port is north. The manifold stands on -30.009.
constexpr double level_below = 30.009 - 24.5;

TEST(ScannedScenesOnRay, SpoolsBelowAndManifoldToPort) {
  const SceneEcho scene("oil_and_gas", scanned_on_cpu);
  const auto first = [&](double azimuth) {
    const int line = scene.beam_at(azimuth);
    return scene.first_range_m(line, 1, 0.02 * scene.strongest(line, 1, 12));
  };
  // The thicker spool: radius 0.2, along x = -0.9 at 0.75 m above the bed.
  EXPECT_NEAR(first(0), std::hypot(0.9, level_below - 0.75) - 0.20, 0.05);
  // The bar of the upper ring nearest to the sonar: radius 0.12, y = 4 - 1.6, at 2.3 m above the bed.
  const double bar_y = 2.4;
  const double bar_below = level_below - 2.3;
  EXPECT_NEAR(first(std::atan2(bar_y, bar_below)), std::hypot(bar_y, bar_below) - 0.12, 0.06);
}

TEST(ScannedScenesOnRay, RisersToStarboard) {
  const SceneEcho scene("oil_and_gas", scanned_on_cpu);
  // The risers leave the bend at the bed at y = -13.5 + 6 + 0.75, 0.75 m above the bed. Over the 30.26 m to
  // their top they lean away by a twelfth of their whole 31.01 m. x = -0.9, radius 0.2.
  const auto riser_m = [](double azimuth) {
    constexpr double lean = 31.01 / 12 / 30.26;
    const double distance =
        (6.75 + lean * (level_below - 0.75)) / (std::sin(-azimuth) + lean * std::cos(azimuth));
    return std::hypot(0.9, distance) - 0.2;
  };
  for (double azimuth = -115 * degree; azimuth < -65 * degree; azimuth += 5 * degree) {
    const int line = scene.beam_at(azimuth);
    const double seen = scene.azimuth_rad(line);
    const double nearest = std::min({riser_m(seen - half_beam), riser_m(seen), riser_m(seen + half_beam)});
    EXPECT_NEAR(scene.first_range_m(line, 5, 1e-3 * scene.strongest(line, 5, 9)), nearest, 0.03)
        << azimuth / degree;
  }
}

TEST(ScannedScenesOnRay, BedLiesBelow) {
  const SceneEcho scene("oil_and_gas", scanned_on_cpu);
  // The bed is level around the manifold. Between the manifold and the spools' supports the strongest echo
  // comes from bed or spools, and nothing lies beyond the bed. Straight down the beam is 35 degrees wide
  // along the vehicle.
  const int line = scene.beam_at(0);
  EXPECT_EQ(scene.energy(line, (level_below + 0.35) / std::cos(17.5 * degree) + 0.2, 12), 0);
  EXPECT_GT(scene.energy(line, level_below - 0.4, level_below + 0.4), 0);
}

}  // namespace
}  // namespace sonard::test
