// SPDX-License-Identifier: Apache-2.0
// Attitude and depth that a head's sensors read. The expected values are turns about one axis, and products
// of rotation matrices by hand (docs/frames-and-units.md).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "server/devices/device_type.hpp"
#include "server/devices/head_poses.hpp"
#include "tests/support/degree.hpp"

namespace sonard::server {
namespace {

/// A pose by roll, pitch, yaw in degrees, as in a mount: positive pitch is nose down, yaw 0 is east.
render::Pose turned(double roll_deg, double pitch_deg, double yaw_deg, glm::dvec3 position_m = {}) {
  const auto about = [](double deg, const glm::dvec3& axis) { return glm::angleAxis(deg * degree, axis); };
  return {position_m, about(yaw_deg, {0, 0, 1}) * about(pitch_deg, {0, 1, 0}) * about(roll_deg, {1, 0, 0})};
}

void expect_deg(const render::Pose& T_world_mount, double heading, double pitch, double roll) {
  const SensorReadings readings = sensor_readings(T_world_mount, std::nullopt);
  EXPECT_NEAR(std::remainder(readings.heading_rad / degree - heading, 360.0), 0.0, 1e-3);
  EXPECT_GE(readings.heading_rad, 0.0);
  EXPECT_LT(readings.heading_rad, 2 * std::numbers::pi);
  EXPECT_NEAR(readings.pitch_rad / degree, pitch, 1e-3);
  EXPECT_NEAR(std::remainder(readings.roll_rad / degree - roll, 360.0), 0.0, 1e-3);
}

TEST(SensorReadings, HeadingGrowsClockwiseFromNorth) {
  expect_deg(turned(0, 0, 0), 90, 0, 0);
  expect_deg(turned(0, 0, 30), 60, 0, 0);
  expect_deg(turned(0, 0, 90), 0, 0, 0);
  expect_deg(turned(0, 0, 91), 359, 0, 0);
  expect_deg(turned(0, 0, 180), 270, 0, 0);
  expect_deg(turned(0, 0, -90), 180, 0, 0);
}

TEST(SensorReadings, HeadingIsBelowAWholeTurnHoweverLittleIsWestOfNorth) {
  const double half = std::sqrt(0.5);
  for (const double z : {std::nextafter(half, 0.0), half, std::nextafter(half, 1.0)}) {
    expect_deg({{}, {half, 0.0, 0.0, z}}, 0, 0, 0);
  }
}

TEST(SensorReadings, PitchIsPositiveNoseUpAndRollStarboardDown) {
  expect_deg(turned(0, 20, 30), 60, -20, 0);
  expect_deg(turned(0, -10, 30), 60, 10, 0);
  expect_deg(turned(3, 0, 30), 60, 0, 3);
  expect_deg(turned(-3, 20, 30), 60, -20, -3);
}

TEST(SensorReadings, AreThoseOfTheMount) {
  // Close to the sums of the angles, but not equal, because the mount pitches about an axis that has rolled.
  expect_deg(turned(3, 5, 30) * turned(0, 10, 0), 59.461, -14.986, 3.094);
  expect_deg(turned(0, 5, 0) * turned(0, 0, -90), 180, 0, -5);  // looks to starboard of a nose-down vehicle
  expect_deg(turned(0, 0, 30) * turned(180, 0, 0), 60, 0, 180);
  expect_deg(turned(0, 20, 30) * turned(180, 0, 0), 60, -20, 180);
}

TEST(SensorReadings, LookingStraightDownOrUpHasAHeadingAndNoRoll) {
  expect_deg(turned(0, 0, 30) * turned(0, 90, 0), 60, -90, 0);
  expect_deg(turned(0, 0, 30) * turned(0, -90, 0), 60, 90, 0);
}

TEST(SensorReadings, DepthIsBelowTheSurface) {
  EXPECT_EQ(sensor_readings(turned(0, 0, 0, {1, 2, -20}), 0.0).depth_m, 20.0);
  EXPECT_EQ(sensor_readings(turned(0, 0, 0, {1, 2, -20}), 5.0).depth_m, 25.0);
  EXPECT_EQ(sensor_readings(turned(0, 0, 0, {1, 2, 1.5}), 0.0).depth_m, -1.5);
  EXPECT_EQ(sensor_readings(turned(0, 0, 0, {1, 2, -20}), std::nullopt).depth_m, std::nullopt);
}

TEST(SensorReadings, HaveTheOrientationAndTheVelocityOfTheMount) {
  const render::Pose T_world_mount = turned(3, 5, 30);
  const SensorReadings readings = sensor_readings(T_world_mount, std::nullopt, {1, 2, 3});
  const glm::dquat& q = T_world_mount.orientation;
  EXPECT_EQ(readings.orientation_wxyz, (std::array{q.w, q.x, q.y, q.z}));
  EXPECT_EQ(readings.velocity_mps, (std::array{1.0, 2.0, 3.0}));
}

// The vehicle goes ahead with 1 m/s and turns to port with 0.5 rad/s. The mount is 2 m ahead and looks down.
TEST(SensorReadings, VelocityOfTheMountHasThatOfItsArm) {
  HeadConfig head;
  head.T_vehicle_sonar = turned(0, 90, 0, {2, 0, 0});
  PoseHistory history({});
  pose::PoseSample sample;
  sample.twist = pose::Velocity{{1, 0, 0}, {0, 0, 0.5}};
  history.insert(sample, TimePoint{});
  const HeadPoses poses(head, history, "");
  const glm::dvec3 expected{0, 1, 1};  // down, to port, ahead
  EXPECT_LT(glm::distance(poses.mount_velocity_mps(TimePoint{}), expected), 1e-12);
  ASSERT_TRUE(poses.at(TimePoint{}));
  EXPECT_LT(glm::distance(poses.at(TimePoint{})->sonar_velocity_mps, expected), 1e-12);
}

}  // namespace
}  // namespace sonard::server
