// SPDX-License-Identifier: Apache-2.0
#include "server/offline/vehicle_trajectory.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

VehicleTrajectory trajectory_from(std::int64_t start_ns) {
  return VehicleTrajectory(pose::Trajectory(
      {{start_ns, {{0, 0, 0}, {1, 0, 0, 0}}}, {start_ns + 2 * second_ns, {{4, 0, -2}, {1, 0, 0, 0}}}}));
}

TEST(PingTimes, AreRoundedEachByItself) {
  const PingTimes times{5, 1e9 / 3};
  EXPECT_EQ(times.at(0), 5);
  EXPECT_EQ(times.at(1), 333'333'338);
  EXPECT_EQ(times.at(3), second_ns + 5);
  EXPECT_EQ(times.at(3'000'000), 1'000'000 * second_ns + 5);
}

TEST(PingTimes, TheLastPingMayBeAtTheEnd) {
  EXPECT_EQ((PingTimes{0, 1e8}.count_until(second_ns)), 11);
  EXPECT_EQ((PingTimes{0, 1e8}.count_until(second_ns - 1)), 10);
  EXPECT_EQ((PingTimes{7, 1e9 / 3}.count_until(7 + second_ns)), 4);
  EXPECT_EQ((PingTimes{7, 1e9}.count_until(7)), 1);
}

TEST(PingTimes, MoreThanCanBeNumberedAreRefused) {
  EXPECT_THROW((void)(PingTimes{0, 1e-3}.count_until(second_ns)), Error);
}

TEST(VehicleTrajectory, GoesStraightFromPointToPointAndRestsBeyond) {
  const VehicleTrajectory trajectory = trajectory_from(0);
  EXPECT_EQ(trajectory.T_world_vehicle(second_ns).position_m, glm::dvec3(2, 0, -1));
  EXPECT_EQ(trajectory.T_world_vehicle(9 * second_ns).position_m, glm::dvec3(4, 0, -2));
}

TEST(PingTimes, MayBeGiven) {
  const PingTimes times{5, 1e9, {5, 5, 9}};
  EXPECT_EQ(times.count_until(second_ns), 3);
  EXPECT_EQ(times.at(1), 5);
  EXPECT_EQ(times.at(2), 9);
}

// Points at 0, 1, 2 and 3 s, and a ping that listens for 0.1 s.
TEST(VehicleTrajectory, RestsInPingsThatFallIntoAGivenStep) {
  std::vector<pose::TrajectoryPoint> points;
  for (int k = 0; k < 4; ++k) {
    points.push_back({k * second_ns, {{10.0 * k, 0, 0}, {1, 0, 0, 0}}});
  }
  VehicleTrajectory trajectory{pose::Trajectory(points)};
  const auto moved_m = [&](double sent_s) {
    const auto sent_ns = static_cast<std::int64_t>(1e9 * sent_s);
    return trajectory.T_world_vehicle_at_end(sent_ns, sent_ns + second_ns / 10).position_m.x - 10.0 * sent_s;
  };
  EXPECT_NEAR(moved_m(1.5), 1.0, 1e-9);
  trajectory.rest_in({false, true, false});
  EXPECT_NEAR(moved_m(0.5), 1.0, 1e-9);
  EXPECT_NEAR(moved_m(0.95), 0.0, 1e-9) << "it ends in the step";
  EXPECT_NEAR(moved_m(1.0), 0.0, 1e-9);
  EXPECT_NEAR(moved_m(1.95), 0.0, 1e-9) << "it begins in the step";
  EXPECT_NEAR(moved_m(2.0), 1.0, 1e-9);
  trajectory.rest_in_all_pings();
  EXPECT_NEAR(moved_m(0.5), 0.0, 1e-9);
}

// 1980-01-01 00:00:00 UTC is 3652 days after 1970-01-01.
TEST(VehicleTrajectory, StampsCountFrom1980UnlessTheyAreUnixTimes) {
  constexpr std::int64_t of_1980 = 3652LL * 86'400 * second_ns;
  EXPECT_EQ(trajectory_from(0).unix_ns(second_ns), of_1980 + second_ns);
  EXPECT_EQ(trajectory_from(of_1980 - 1).unix_ns(of_1980), 2 * of_1980);
  EXPECT_EQ(trajectory_from(of_1980).unix_ns(of_1980 + 7), of_1980 + 7);
}

}  // namespace
}  // namespace sonard::server
