// SPDX-License-Identifier: Apache-2.0
// Dead reckoning: five reports a second, relative to the last reset.
#include "tests/unit/protocol/dvl_a50/device/bench.hpp"

namespace sonard::dvl_a50 {
namespace {

TEST(DvlPositions, ComeFiveTimesASecond) {
  Bench bench;
  bench.run_for(10s);
  EXPECT_EQ(bench.positions.size(), 50U);
  EXPECT_NEAR(bench.positions.back().report.time_s, 1767225610.0, 1e-3);
}

TEST(DvlPositions, AddTheMotionInTheFrameOfTheReset) {
  Bench bench;
  bench.move(moving({1.0, 0.0, 0.0}, 0.5));
  bench.ask("reset_dead_reckoning");
  bench.run_for(10s);
  const Position ahead = bench.positions.back().report;
  EXPECT_NEAR(ahead.position_m[0], 10.0, 0.21);
  EXPECT_NEAR(ahead.position_m[1], 0.0, 1e-6);
  EXPECT_NEAR(ahead.yaw_deg, 0.0, 1e-9);
  // Turns to starboard by a right angle and goes on ahead.
  const double right_angle = std::numbers::pi / 2;
  bench.move(moving({1.0, 0.0, 0.0}, 0.5 + right_angle));
  const Vector corner = bench.positions.back().report.position_m;
  bench.run_for(10s);
  const Position after = bench.positions.back().report;
  EXPECT_NEAR(after.yaw_deg, 90.0, 1e-6);
  EXPECT_NEAR(after.position_m[1] - corner[1], 10.0, 0.21);
  EXPECT_NEAR(after.position_m[0] - corner[0], 0.0, 0.21);
}

TEST(DvlPositions, AResetIsAnsweredFirstAndZeroWithin100ms) {
  Bench bench;
  bench.move(moving({1.0, 0.5, 0.1}, 1.0));
  bench.run_for(5s);
  EXPECT_GT(bench.positions.back().report.position_m[0], 0.5);
  bench.positions.clear();
  EXPECT_TRUE(bench.ask("reset_dead_reckoning").success);
  EXPECT_TRUE(bench.positions.empty()) << "the response is first";
  bench.run_for(100ms);
  ASSERT_FALSE(bench.positions.empty());
  const Position zero = bench.positions.front().report;
  EXPECT_LT(std::abs(zero.position_m[0]), 0.1);
  EXPECT_EQ(zero.std_m, 0.0);
  EXPECT_NEAR(zero.roll_deg, 0.0, 1e-9);
  EXPECT_NEAR(zero.pitch_deg, 0.0, 1e-9);
  EXPECT_NEAR(zero.yaw_deg, 0.0, 1e-9);
}

TEST(DvlPositions, YawDriftsAndTheErrorGrowsFasterWithoutBottom) {
  DeviceConfig config = quiet();
  config.heading_drift_deg_per_min = 0.3;
  config.position_noise_m = 0.01;
  Bench bench(config);
  bench.run_for(60s);
  const Position locked = bench.positions.back().report;
  EXPECT_NEAR(locked.yaw_deg, 0.3, 0.002);
  EXPECT_NEAR(locked.std_m, 0.01 * std::sqrt(60.0), 0.02);
  bench.height_m = 0.0;
  bench.run_for(60s);
  EXPECT_NEAR(bench.positions.back().report.std_m, 0.1 * std::sqrt(60.0), 0.03);
}

TEST(DvlPositions, InSimulatedTimeTheMotionIsAddedByTheTimeOfTheReadings) {
  DeviceConfig config = quiet();
  config.simulated_time = true;
  Bench bench(config);
  const auto at = [&](std::chrono::nanoseconds time, double ahead_mps) {
    SensorReadings readings = moving({ahead_mps, 0.0, 0.0});
    readings.simulated_time = time;
    bench.move(readings);
  };
  at(100s, 1.0);
  bench.ask("reset_dead_reckoning");
  bench.run_for(3s);
  EXPECT_EQ(bench.positions.back().report.position_m[0], 0.0) << "the simulation rests";
  at(104s, 1.0);
  at(106s, 2.0);
  bench.run_for(1s);
  EXPECT_NEAR(bench.positions.back().report.position_m[0], 4.0 + 3.0, 1e-9);
  at(1s, 2.0);  // the simulation begins again
  at(2s, 2.0);
  bench.run_for(1s);
  EXPECT_NEAR(bench.positions.back().report.position_m[0], 7.0 + 2.0, 1e-9);
}

TEST(DvlPositions, RollAndPitchAreThoseOfTheVehicle) {
  // The head looks down and ahead: the vehicle's nose is up by 0.1 rad from the reset on.
  Bench bench;
  bench.ask("reset_dead_reckoning");
  const double half_rad = (std::numbers::pi / 2 - 0.1) / 2;
  SensorReadings nose_up = moving({});
  // A turn by 90 degrees about the vertical, then nose down by 90 degrees less 0.1 rad.
  const double turn = std::numbers::pi / 4;
  nose_up.orientation_wxyz = {std::cos(turn) * std::cos(half_rad), -std::sin(turn) * std::sin(half_rad),
                              std::cos(turn) * std::sin(half_rad), std::sin(turn) * std::cos(half_rad)};
  bench.move(nose_up);
  bench.run_for(1s);
  EXPECT_NEAR(bench.positions.back().report.pitch_deg, 0.1 * 180.0 / std::numbers::pi, 1e-6);
  EXPECT_NEAR(bench.positions.back().report.roll_deg, 0.0, 1e-6);
}

}  // namespace
}  // namespace sonard::dvl_a50
