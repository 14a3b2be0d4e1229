// SPDX-License-Identifier: Apache-2.0
// Specific force and rates from the attitude (2.4).
#include "protocol/sonar3d15/imu.hpp"

#include <gtest/gtest.h>

#include <numbers>

namespace sonard::sonar3d15 {
namespace {

using namespace std::chrono_literals;
constexpr double quarter = std::numbers::pi / 2;

SensorReadings attitude(double heading_rad, double pitch_rad, double roll_rad) {
  return {heading_rad, pitch_rad, roll_rad, {}};
}

void expect_vector(const google::protobuf::RepeatedField<float>& numbers, int sample, double x, double y,
                   double z) {
  ASSERT_GE(numbers.size(), 3 * (sample + 1));
  EXPECT_NEAR(static_cast<double>(numbers[3 * sample]), x, 1e-5);
  EXPECT_NEAR(static_cast<double>(numbers[3 * sample + 1]), y, 1e-5);
  EXPECT_NEAR(static_cast<double>(numbers[3 * sample + 2]), z, 1e-5);
}

ImuBatch at_rest(const SensorReadings& readings) {
  return make_imu_batch(0, 1, 0s, readings, readings, 0s);
}

TEST(Imu, GravityPointsUpInEveryAttitude) {
  expect_vector(at_rest({}).specific_force(), 0, 0, 0, -9.8);
  expect_vector(at_rest(attitude(2.0, quarter, 0.0)).specific_force(), 0, 9.8, 0, 0);
  expect_vector(at_rest(attitude(0.0, 0.0, quarter)).specific_force(), 0, 0, -9.8, 0);
  expect_vector(at_rest(attitude(0.0, 0.3, 0.0)).rate_of_turn(), 0, 0, 0, 0);
}

TEST(Imu, RatesAreThoseOfTheBody) {
  const auto rate = [](SensorReadings before, SensorReadings now) {
    return make_imu_batch(0, 1, 0s, before, now, 100ms).rate_of_turn();
  };
  expect_vector(rate(attitude(6.2, 0.0, 0.0), attitude(0.1, 0.0, 0.0)), 0, 0, 0,
                (0.1 - 6.2 + 2 * std::numbers::pi) / 0.1);  // through north
  expect_vector(rate(attitude(0.0, -0.05, 0.0), attitude(0.0, 0.0, 0.0)), 0, 0, 0.5, 0);
  expect_vector(rate(attitude(0.0, 0.0, 0.0), attitude(0.0, 0.0, 0.05)), 0, 0.5, 0, 0);
  // Nose up, a turn is about the x axis; on the side, about the y axis.
  expect_vector(rate(attitude(0.0, quarter, 0.0), attitude(0.05, quarter, 0.0)), 0, -0.5, 0, 0);
  expect_vector(rate(attitude(0.0, 0.0, quarter), attitude(0.05, 0.0, quarter)), 0, 0, 0.5, 0);
}

TEST(Imu, NoiseHasItsDeviation) {
  DeviceConfig config;
  config.imu_force_noise_mps2 = 0.5;
  ImuBatch batch = make_imu_batch(0, 1000, 1000s, {}, {}, 0s);
  Noise noise(1);
  add_noise(config, noise, batch);
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const double error = static_cast<double>(batch.specific_force(3 * i + 2)) + 9.8;
    sum += error;
    squares += error * error;
    ASSERT_EQ(batch.rate_of_turn(3 * i), 0.0F);
  }
  EXPECT_NEAR(sum / 1000, 0.0, 0.06);
  EXPECT_NEAR(std::sqrt(squares / 1000), 0.5, 0.05);
}

TEST(Imu, SamplesLeadToTheNewestReading) {
  const ImuBatch batch = make_imu_batch(7, 20, 1000s, {}, attitude(0.0, 0.0, quarter), 190ms);
  EXPECT_EQ(batch.batch_sequence_id(), 7U);
  EXPECT_EQ(batch.samples(), 20U);
  ASSERT_EQ(batch.timestamps_size(), 20);
  EXPECT_EQ(batch.timestamps(0).seconds(), 999);
  EXPECT_EQ(batch.timestamps(0).nanos(), 810'000'000);
  EXPECT_EQ(batch.timestamps(19).seconds(), 1000);
  expect_vector(batch.specific_force(), 0, 0, 0, -9.8);
  expect_vector(batch.specific_force(), 19, 0, -9.8, 0);
}

}  // namespace
}  // namespace sonard::sonar3d15
