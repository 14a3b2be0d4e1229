// SPDX-License-Identifier: Apache-2.0
// Trajectories that a vehicle can travel, trajectories with jumps, and independent poses.
#include "server/offline/jumps.hpp"

#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sonard::server {
namespace {

constexpr double degree = std::numbers::pi / 180;

pose::TrajectoryPoint point(double time_s, double x_m, double y_m, double heading_rad) {
  return {std::llround(1e9 * time_s),
          {{x_m, y_m, -5}, {std::cos(heading_rad / 2), 0, 0, std::sin(heading_rad / 2)}}};
}

std::vector<pose::TrajectoryPoint> points(int count, double step_s, auto pose_at) {
  std::vector<pose::TrajectoryPoint> made;
  for (int k = 0; k < count; ++k) {
    const auto [x_m, y_m, heading_rad] = pose_at(k * step_s);
    made.push_back(point(k * step_s, x_m, y_m, heading_rad));
  }
  return made;
}

struct Place {
  double x_m, y_m, heading_rad;
};

TEST(Jumps, AVehicleOnItsWayMakesNone) {
  const auto expect_none = [](const std::vector<pose::TrajectoryPoint>& way) {
    const Jumps jumps = find_jumps(way);
    EXPECT_EQ(jumps.count, 0U);
    EXPECT_FALSE(jumps.independent);
    EXPECT_EQ(jumps.steps.size() + 1, way.size());
  };
  expect_none({point(0, 0, 0, 0)});
  // 3 m/s, with points 10 s apart and 0.02 s apart.
  expect_none(points(20, 10, [](double t) { return Place{3 * t, 0, 0}; }));
  expect_none(points(500, 0.02, [](double t) { return Place{3 * t, 0, 0}; }));
  // Turning on the spot at 90 degrees per second, past 180 degrees.
  expect_none(points(40, 0.5, [](double t) { return Place{0, 0, 90 * degree * t}; }));
  // A circle with a radius of 5 m at 1.5 m/s.
  expect_none(points(60, 1, [](double t) {
    return Place{5 * std::cos(0.3 * t), 5 * std::sin(0.3 * t), 0.3 * t + std::numbers::pi / 2};
  }));
}

// A pose measured 50 times per second, with 1 cm and half a degree of noise.
TEST(Jumps, NoiseOfAMeasuredPoseIsNone) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const Jumps jumps = find_jumps(points(500, 0.02, [&](double t) {
    return Place{t + 0.01 * normal(random), 0.01 * normal(random), 0.5 * degree * normal(random)};
  }));
  EXPECT_EQ(jumps.count, 0U);
  EXPECT_FALSE(jumps.independent);
}

// A survey of two lines 400 m apart, with no points in between.
TEST(Jumps, ATeleportIsOneAndNamesItself) {
  std::vector<pose::TrajectoryPoint> way = points(10, 1, [](double t) { return Place{t, 0, 0}; });
  for (int k = 10; k < 20; ++k) {
    way.push_back(point(k, 19.0 - k, 400, 180 * degree));
  }
  const Jumps jumps = find_jumps(way);
  EXPECT_EQ(jumps.count, 1U);
  ASSERT_EQ(jumps.steps.size(), 19U);
  EXPECT_TRUE(jumps.steps[9]);
  EXPECT_FALSE(jumps.independent);
  EXPECT_EQ(jumps.first, "from t=9 to t=10: 400 m/s, 180 deg/s");
}

TEST(Jumps, ATurnThatIsTooFastIsOne) {
  EXPECT_EQ(find_jumps({point(0, 0, 0, 0), point(0.5, 0, 0, 80 * degree)}).count,
            0U);  // 160 degrees per second
  EXPECT_EQ(find_jumps({point(0, 0, 0, 0), point(0.5, 0, 0, 100 * degree)}).count, 1U);  // 200
  EXPECT_EQ(find_jumps({point(0, 0, 0, 0), point(1, 19, 0, 0)}).count, 0U);
  EXPECT_EQ(find_jumps({point(0, 0, 0, 0), point(1, 0, 21, 0)}).count, 1U);
}

// Each step is within the limits, but the change from step to step is not.
TEST(Jumps, AChangeThatIsTooFastIsNamedAsAChange) {
  const Jumps jumps =
      find_jumps({point(0, 0, 0, 0), point(1, 4, 0, 0), point(2, 0, 0, 0), point(3, 4, 0, 0)});
  EXPECT_EQ(jumps.count, 0U);
  EXPECT_TRUE(jumps.independent);
  EXPECT_EQ(jumps.first, "from t=1 to t=2: velocity changes by 8 m/s and turn rate by 0 deg/s within 1 s");
}

// In a tank of 6 m no step is fast, but no step continues the step before it.
TEST(Jumps, RandomPosesAreIndependent) {
  for (unsigned int seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-3, 3), heading(-std::numbers::pi, std::numbers::pi);
    EXPECT_TRUE(find_jumps(points(11, 1, [&](double) {
                  return Place{place(random), place(random), heading(random)};
                })).independent);
    EXPECT_TRUE(find_jumps(points(40, 1, [&](double) { return Place{0, 0, heading(random)}; })).independent);
    EXPECT_TRUE(find_jumps(points(40, 1, [&](double) {
                  return Place{place(random), place(random), 0};
                })).independent);
    // A sonar near a pipe at ten frames per second: no step is a jump.
    std::uniform_real_distribution<double> near(-0.4, 0.4), about(-8 * degree, 8 * degree);
    EXPECT_TRUE(find_jumps(points(60, 0.1, [&](double) {
                  return Place{near(random), near(random), about(random)};
                })).independent);
    EXPECT_TRUE(find_jumps(points(20, 0.02, [&](double) {
                  return Place{place(random), place(random), heading(random)};
                })).independent);
  }
}

}  // namespace
}  // namespace sonard::server
