// SPDX-License-Identifier: Apache-2.0
// Messages of a vehicle become poses. The expected values are geometry by hand: the distance of a wall from
// the vehicle's position.
#include "server/pose/mavlink/poses.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "server/pose/pose_history.hpp"
#include "tests/unit/protocol/pose/pose_matchers.hpp"

namespace sonard::server {
namespace {

using mavlink::Attitude;
using mavlink::AttitudeQuaternion;
using mavlink::GlobalPositionInt;
using mavlink::LocalPositionNed;
using mavlink::MavFrame;
using mavlink::Odometry;
using pose::IsRotation;
using pose::IsVec3;
using pose::Vec3;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr float quarter = static_cast<float>(std::numbers::pi / 2);

struct MavlinkPosesTest : testing::Test {
  MavlinkPosesTest() { spdlog::set_level(spdlog::level::off); }

  void take(const mavlink::Message& message) {
    if (const auto sample = poses.take(message, now)) {
      samples.push_back(*sample);
    }
    now += milliseconds{1};
  }
  void use(const MavlinkPoseInput& input) { poses = MavlinkPoses{input}; }

  TimePoint now = seconds{1000};
  MavlinkPoses poses{MavlinkPoseInput{}};
  std::vector<pose::PoseSample> samples;
};

/// Distance to the world plane {p: normal . p = offset_m} along the vehicle's x axis, in metres.
double range_ahead_m(const pose::PoseSample& sample, const Vec3& normal, double offset_m) {
  const Vec3 ahead = rotate(sample.T_world_vehicle.orientation, {1, 0, 0});
  const Vec3& p = sample.T_world_vehicle.position_m;
  return (offset_m - (normal.x * p.x + normal.y * p.y + normal.z * p.z)) /
         (normal.x * ahead.x + normal.y * ahead.y + normal.z * ahead.z);
}

constexpr Vec3 east{1, 0, 0};
constexpr Vec3 north{0, 1, 0};
constexpr Vec3 up{0, 0, 1};

TEST_F(MavlinkPosesTest, AWallToTheNorthIsAheadOfAVehicleThatHeadsNorth) {
  // 4 m north, 2 m east, 3 m deep.
  take(Odometry{0, 4, 2, 3});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_THAT(samples[0].T_world_vehicle.position_m, IsVec3(Vec3{2, 4, -3}, 1e-9));
  EXPECT_NEAR(range_ahead_m(samples[0], north, 10), 6, 1e-6);
}

TEST_F(MavlinkPosesTest, AWallToTheEastIsAheadAtHeading90) {
  take(Attitude{10, 0, 0, quarter});
  take(LocalPositionNed{10, 4, 2, 3});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_NEAR(range_ahead_m(samples[0], east, 10), 8, 1e-5);
  // The vehicle's left is north, and its top is up.
  EXPECT_THAT(rotate(samples[0].T_world_vehicle.orientation, {0, 1, 0}), IsVec3(north, 1e-6));
  EXPECT_THAT(rotate(samples[0].T_world_vehicle.orientation, {0, 0, 1}), IsVec3(up, 1e-6));
}

TEST_F(MavlinkPosesTest, PositivePitchLooksUpAndPositiveRollLowersStarboard) {
  const double angle = 0.3;
  take(Attitude{10, 0, static_cast<float>(angle), 0});
  take(LocalPositionNed{10, 0, 0, 3});
  take(Attitude{20, static_cast<float>(angle), 0, 0});
  take(LocalPositionNed{20, 0, 0, 3});
  ASSERT_EQ(samples.size(), 2U);
  // At 3 m depth the distance to the surface, z = 0, is 3 m / sin(angle).
  EXPECT_NEAR(range_ahead_m(samples[0], up, 0), 3 / std::sin(angle), 1e-5);
  EXPECT_THAT(rotate(samples[1].T_world_vehicle.orientation, {0, -1, 0}),
              IsVec3(Vec3{std::cos(angle), 0, -std::sin(angle)}, 1e-6));
}

TEST_F(MavlinkPosesTest, AnglesAreTurnedInTheOrderYawPitchRoll) {
  // Heading east, nose straight up, then rolled by 90 degrees about the x axis, which is now vertical.
  take(Attitude{10, quarter, quarter, quarter});
  take(LocalPositionNed{10, 0, 0, 0});
  ASSERT_EQ(samples.size(), 1U);
  const pose::Quat& q = samples[0].T_world_vehicle.orientation;
  EXPECT_THAT(rotate(q, {1, 0, 0}), IsVec3(up, 1e-6));
  // Starboard pointed south. It turns to the direction of the belly, which pointed east.
  EXPECT_THAT(rotate(q, {0, -1, 0}), IsVec3(east, 1e-6));
}

TEST_F(MavlinkPosesTest, TheQuaternionSaysTheSameAsTheAngles) {
  const float half = static_cast<float>(std::sqrt(0.5));
  take(AttitudeQuaternion{10, half, 0, 0, half});  // heading east
  take(LocalPositionNed{10, 0, 0, 0});
  Odometry odometry{0, 0, 0, 0, {half, 0, 0, half}};
  take(odometry);
  ASSERT_EQ(samples.size(), 2U);
  for (const auto& sample : samples) {
    EXPECT_THAT(sample.T_world_vehicle.orientation, IsRotation(pose::Quat{}, 1e-6));
  }
}

TEST_F(MavlinkPosesTest, VelocityOfThePositionIsThatOfTheWorldInAxesOfTheVehicle) {
  // Heads east, drifts north at 1 m/s (to port), sinks at 0.5 m/s, and turns to starboard.
  take(Attitude{10, 0, 0, quarter, 0, 0, 0.2F});
  take(LocalPositionNed{10, 0, 0, 0, 1, 0, 0.5F});
  ASSERT_TRUE(samples.size() == 1 && samples[0].twist);
  EXPECT_THAT(samples[0].twist->linear_mps, IsVec3(Vec3{0, 1, -0.5}, 1e-6));
  EXPECT_THAT(samples[0].twist->angular_radps, IsVec3(Vec3{0, 0, -0.2}, 1e-6));
}

TEST_F(MavlinkPosesTest, VelocityOfOdometryIsInTheAxesThatItNames) {
  const float half = static_cast<float>(std::sqrt(0.5));
  Odometry heading_east{0, 0, 0, 0, {half, 0, 0, half}, 1, 2, 3, 0.1F, 0.2F, 0.3F};
  for (const auto axes : {MavFrame::body_frd, MavFrame::body_ned, MavFrame::local_ned, MavFrame{4}}) {
    heading_east.child_frame_id = axes;
    heading_east.time_usec += 1000;
    take(heading_east);
  }
  ASSERT_EQ(samples.size(), 4U);
  for (const std::size_t body : {0U, 1U}) {
    EXPECT_THAT(samples[body].twist.value().linear_mps, IsVec3(Vec3{1, -2, -3}, 1e-6));
  }
  // 1 m/s north, 2 east, 3 down is 2 ahead, 1 to port, 3 down.
  EXPECT_THAT(samples[2].twist.value().linear_mps, IsVec3(Vec3{2, 1, -3}, 1e-6));
  EXPECT_THAT(samples[2].twist.value().angular_radps, IsVec3(Vec3{0.1, -0.2, -0.3}, 1e-6));
  EXPECT_FALSE(samples[3].twist);
}

TEST_F(MavlinkPosesTest, FramesWithoutAPlaceInTheWorldAreDropped) {
  for (const int frame : {0, 4, 8, 12, 21, 255}) {
    Odometry odometry;
    odometry.frame_id = static_cast<MavFrame>(frame);
    take(odometry);
  }
  EXPECT_TRUE(samples.empty());
  EXPECT_EQ(poses.counters().unknown_frame, 6U);
}

TEST_F(MavlinkPosesTest, TheOriginPutsALocalFrameIntoTheWorld) {
  // LOCAL_FRD with its x axis along the world's east. x is read as north, so a quarter turn to starboard.
  MavlinkPoseInput input;
  input.T_world_local.position_m = {100, 200, -10};
  input.T_world_local.orientation = glm::angleAxis(-std::numbers::pi / 2, glm::dvec3(0, 0, 1));
  use(input);
  Odometry odometry{0, 5, 1, 2};
  odometry.frame_id = MavFrame::local_frd;
  take(odometry);
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_THAT(samples[0].T_world_vehicle.position_m, IsVec3(Vec3{105, 199, -12}, 1e-6));
  EXPECT_NEAR(range_ahead_m(samples[0], east, 110), 5, 1e-6);
}

TEST_F(MavlinkPosesTest, APositionWaitsForTheNextAttitudeAndTakesWhatIsBetween) {
  take(Attitude{100, 0, 0, 0.2F, 0, 0, 1});
  take(LocalPositionNed{125, 0, 0, 0});
  EXPECT_TRUE(samples.empty());
  take(Attitude{200, 0, 0, 0.6F, 0, 0, 3});
  ASSERT_EQ(samples.size(), 1U);
  // At a quarter of the interval the heading is 0.3 rad from north and the rate 1.5 rad/s.
  EXPECT_THAT(samples[0].T_world_vehicle.orientation,
              IsRotation(pose::yaw(std::numbers::pi / 2 - 0.3), 1e-6));
  EXPECT_NEAR(samples[0].twist.value().angular_radps.z, -1.5, 1e-6);
  EXPECT_EQ(poses.counters().without_attitude, 0U);
}

TEST_F(MavlinkPosesTest, WithoutANextAttitudeTheNearestIsTurnedOn) {
  take(Attitude{100, 0, 0, 0.2F, 0, 0, 1});
  take(LocalPositionNed{150, 0, 0, 0});
  take(LocalPositionNed{350, 0, 0, 0});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_THAT(samples[0].T_world_vehicle.orientation,
              IsRotation(pose::yaw(std::numbers::pi / 2 - 0.25), 1e-6));
  take(LocalPositionNed{450, 0, 0, 0});  // 250 ms after the only attitude
  EXPECT_EQ(samples.size(), 1U);
  EXPECT_EQ(poses.counters().without_attitude, 1U);
}

TEST_F(MavlinkPosesTest, AnAttitudeThatIsTooOldIsNotJoined) {
  take(Attitude{1000, 0, 0, 0});
  take(LocalPositionNed{1800, 0, 0, 0});
  take(Attitude{2600, 0, 0, 0});
  EXPECT_TRUE(samples.empty());
  EXPECT_EQ(poses.counters().without_attitude, 1U);
}

TEST_F(MavlinkPosesTest, ALateAttitudeFindsItsPlace) {
  take(Attitude{200, 0, 0, 0.6F});
  take(Attitude{100, 0, 0, 0.2F});
  take(LocalPositionNed{150, 0, 0, 0});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_THAT(samples[0].T_world_vehicle.orientation,
              IsRotation(pose::yaw(std::numbers::pi / 2 - 0.4), 1e-6));
}

TEST_F(MavlinkPosesTest, StampsKeepTheirSpacingFromTheFirstArrivalOn) {
  now = seconds{50};
  take(Odometry{1'700'000'000'000'000, 0, 0, 0});  // Unix time
  now = seconds{50} + milliseconds{37};            // late by 17 ms
  take(Odometry{1'700'000'000'020'000, 0, 0, 0});
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].time_ns, 50'000'000'000);
  EXPECT_EQ(samples[1].time_ns, 50'020'000'000);
}

TEST_F(MavlinkPosesTest, AClockThatBeginsAgainForgetsWhatWasBefore) {
  PoseHistory history{PoseConfig{}};
  const auto follow = [&](const mavlink::Message& message) {
    if (const auto sample = poses.take(message, now)) {
      history.insert(*sample, now);
    }
    now += milliseconds{10};
  };
  follow(Attitude{90'000, 0, 0, 0});
  follow(LocalPositionNed{90'000, 5, 0, 0});
  follow(LocalPositionNed{90'020, 5, 0, 0});  // waits, and is dropped at the restart
  follow(LocalPositionNed{1'000, 0, 7, 0});   // no attitude since the restart yet
  follow(Attitude{1'010, 0, 0, 0});
  follow(LocalPositionNed{1'010, 0, 7, 0});
  EXPECT_EQ(poses.counters().clock_restarts, 1U);
  EXPECT_EQ(history.counters().clock_restarts, 1U);
  const auto estimate = history.at(now);
  ASSERT_TRUE(estimate);
  EXPECT_NEAR(estimate->T_world_vehicle.position_m.x, 7, 1e-6);
  EXPECT_NEAR(estimate->T_world_vehicle.position_m.y, 0, 1e-6);
}

TEST_F(MavlinkPosesTest, OdometryGoesBeforeThePairWhileItComes) {
  take(Odometry{1'000'000, 1, 0, 0});
  take(Attitude{1000, 0, 0, 0});
  take(LocalPositionNed{1000, 2, 0, 0});
  EXPECT_EQ(samples.size(), 1U);
  EXPECT_EQ(poses.counters().not_wanted, 2U);
  now += MavlinkPoses::precedence;
  take(Attitude{3000, 0, 0, 0});
  take(LocalPositionNed{3000, 2, 0, 0});
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_NEAR(samples[1].T_world_vehicle.position_m.y, 2, 1e-6);
}

TEST_F(MavlinkPosesTest, OnlyWhatIsConfiguredIsTaken) {
  MavlinkPoseInput input;
  input.messages = MavlinkMessages::local_position;
  use(input);
  take(Odometry{0, 1, 0, 0});
  EXPECT_TRUE(samples.empty());
  input.messages = MavlinkMessages::odometry;
  use(input);
  take(Attitude{1000, 0, 0, 0});
  take(LocalPositionNed{1000, 2, 0, 0});
  EXPECT_TRUE(samples.empty());
  EXPECT_EQ(poses.counters().not_wanted, 2U);
}

TEST_F(MavlinkPosesTest, WhatMeansNothingIsCountedAndDropped) {
  take(Odometry{0, nan, 0, 0});
  take(Odometry{0, 2e8F, 0, 0});
  take(Odometry{0, 0, 0, 0, {0, 0, 0, 0}});
  take(Odometry{std::numeric_limits<std::uint64_t>::max(), 0, 0, 0});
  take(Attitude{10, nan, 0, 0});
  take(AttitudeQuaternion{10, 0, 0, 0, 0});
  EXPECT_TRUE(samples.empty());
  EXPECT_EQ(poses.counters().bad_value, 6U);
}

TEST_F(MavlinkPosesTest, ASpeedThatIsNotKnownIsNone) {
  take(Odometry{0, 0, 0, 0, {1, 0, 0, 0}, nan, nan, nan});
  take(Attitude{10, 0, 0, 0, nan, nan, nan});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_FALSE(samples[0].twist);
}

/// Metres per degree of latitude and longitude on WGS 84, from the radii of curvature of its ellipsoid.
Vec3 metres_per_degree(double latitude_deg) {
  constexpr double a_m = 6378137.0, e2 = 0.00669437999014;
  const double latitude = latitude_deg * std::numbers::pi / 180.0;
  const double root = std::sqrt(1.0 - e2 * std::sin(latitude) * std::sin(latitude));
  return {a_m / root * std::cos(latitude) * std::numbers::pi / 180.0,
          a_m * (1.0 - e2) / (root * root * root) * std::numbers::pi / 180.0, 0};
}

TEST_F(MavlinkPosesTest, AGlobalPositionIsMetresEastAndNorthOfTheOriginOfTheWorld) {
  MavlinkPoseInput input;
  input.messages = MavlinkMessages::global_position;
  input.world_origin = {45.0, 10.0, 100.0};
  use(input);
  take(Attitude{10, 0, 0, quarter});
  take(GlobalPositionInt{10, 450010000, 99990000, 95000, 100, 0, 50});
  ASSERT_EQ(samples.size(), 1U);
  const Vec3 per_degree = metres_per_degree(45.0);
  const Vec3& p = samples[0].T_world_vehicle.position_m;
  EXPECT_NEAR(p.x, -1e-3 * per_degree.x, 5e-3);
  EXPECT_NEAR(p.y, 1e-3 * per_degree.y, 5e-3);
  EXPECT_NEAR(p.z, -5.0, 5e-3);
  // Heads east, moves north at 1 m/s (to port), and sinks at 0.5 m/s.
  EXPECT_NEAR(range_ahead_m(samples[0], east, 0), 1e-3 * per_degree.x, 1e-2);
  EXPECT_THAT(samples[0].twist->linear_mps, IsVec3(Vec3{0, 1, -0.5}, 1e-6));
}

// ArduSub without GPS: latitude and longitude stay 0, and the depth sensor gives the altitude.
TEST_F(MavlinkPosesTest, ADepthAloneIsAPoseAtTheOriginWhereNothingBetterComes) {
  MavlinkPoseInput input;
  input.T_world_local = {{5, 6, -1}, {1, 0, 0, 0}};
  use(input);
  for (int i = 0; i < 21; ++i) {
    take(Attitude{static_cast<std::uint32_t>(10 + i), 0, 0, quarter});
    take(GlobalPositionInt{static_cast<std::uint32_t>(10 + i), 0, 0, -12500, 0, 0, 30});
    now += milliseconds{100};
  }
  ASSERT_FALSE(samples.empty());
  EXPECT_LT(samples.size(), 3U) << "LOCAL_POSITION_NED has two seconds to come";
  EXPECT_TRUE(poses.knows_depth_alone());
  EXPECT_THAT(samples[0].T_world_vehicle.position_m, IsVec3(Vec3{5, 6, -13.5}, 1e-9));
  EXPECT_THAT(samples[0].twist->linear_mps, IsVec3(Vec3{0, 0, -0.3}, 1e-6));
  take(LocalPositionNed{40, 1, 2, 3});
  take(Attitude{41});
  EXPECT_FALSE(poses.knows_depth_alone());
  EXPECT_THAT(samples.back().T_world_vehicle.position_m, IsVec3(Vec3{7, 7, -4}, 1e-9));
  const auto not_wanted = poses.counters().not_wanted;
  take(GlobalPositionInt{42, 0, 0, -12500});
  EXPECT_EQ(poses.counters().not_wanted, not_wanted + 1) << "the local position goes before it";
}

// A lake 300 m above the sea: `alt` stays positive, and only relative_alt has the depth.
TEST_F(MavlinkPosesTest, ADepthAloneIsTheHeightAboveHomeIfTheVehicleSendsOne) {
  const auto z_after = [&](std::int32_t alt_mm, std::int32_t relative_alt_mm) {
    const auto time_ms = static_cast<std::uint32_t>(now.count() / 1'000'000);
    take(GlobalPositionInt{time_ms, 0, 0, alt_mm, 0, 0, 0, relative_alt_mm});
    take(Attitude{time_ms});
    return samples.empty() ? 0.0 : samples.back().T_world_vehicle.position_m.z;
  };
  z_after(0, 0);
  now += MavlinkPoses::precedence;
  EXPECT_NEAR(z_after(-4000, 0), -4.0, 1e-9) << "only `alt` is there so far";
  EXPECT_NEAR(z_after(287'500, -12'500), -12.5, 1e-9);
  EXPECT_NEAR(z_after(0, -7'000), -7.0, 1e-9);
  EXPECT_NEAR(z_after(300'000, 0), 0.0, 1e-9) << "the vehicle is at the surface";
}

TEST_F(MavlinkPosesTest, AutoTakesGlobalPositionsWhereTheWorldHasAPlaceAndNothingBetterComes) {
  MavlinkPoseInput input;
  input.world_origin = {45.0, 10.0, 100.0};
  use(input);
  take(GlobalPositionInt{10, 450010000, 100000000, 95000});
  now += seconds{3};
  take(Attitude{3010});
  take(GlobalPositionInt{3010, 450010000, 100000000, 95000});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_FALSE(poses.knows_depth_alone());
  EXPECT_NEAR(samples[0].T_world_vehicle.position_m.y, 1e-3 * metres_per_degree(45.0).y, 5e-3);
  EXPECT_NEAR(samples[0].T_world_vehicle.position_m.z, -5.0, 5e-3);
}

TEST_F(MavlinkPosesTest, WhoAsksForGlobalPositionsGetsNoneOfAVehicleThatDoesNotKnowItsPlace) {
  MavlinkPoseInput input;
  input.messages = MavlinkMessages::global_position;
  input.world_origin = {45.0, 10.0, 0.0};
  use(input);
  take(Attitude{10});
  take(GlobalPositionInt{10, 0, 0, -5000});
  EXPECT_EQ(samples.size(), 0U);
  EXPECT_EQ(poses.counters().without_place, 1U);
  input.world_origin = {0.0, 0.0, 0.0};  // the simulator's own origin
  use(input);
  take(Attitude{10});
  take(GlobalPositionInt{10, 0, 0, -5000});
  EXPECT_EQ(samples.size(), 1U);
}

TEST_F(MavlinkPosesTest, OnlyTheKindOfPositionThatIsAskedForCounts) {
  take(Attitude{10});
  take(GlobalPositionInt{10, 450000000, 100000000});
  EXPECT_EQ(samples.size(), 0U);
  EXPECT_EQ(poses.counters().not_wanted, 1U);
  MavlinkPoseInput input;
  input.messages = MavlinkMessages::global_position;
  input.world_origin = {45.0, 10.0, 0.0};
  use(input);
  take(Attitude{10});
  take(LocalPositionNed{10});
  take(Odometry{});
  take(GlobalPositionInt{10, 910000000, 100000000});
  EXPECT_EQ(samples.size(), 0U);
  EXPECT_EQ(poses.counters().not_wanted, 2U);
  EXPECT_EQ(poses.counters().bad_value, 1U);
}

}  // namespace
}  // namespace sonard::server
