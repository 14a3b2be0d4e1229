// SPDX-License-Identifier: Apache-2.0
// The ping that a fire command requests (protocol/oculus/README.md 3.3, 4.4, 4.7, 8).
#include "protocol/oculus/ping_plan.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

namespace sonard::oculus {
namespace {

using std::chrono::milliseconds;

SimpleFire fire_with(std::uint8_t mode, double range_m) {
  SimpleFire fire;
  fire.fire.master_mode = mode;
  fire.fire.range = range_m;
  return fire;
}

TEST(OculusPlan, AcknowledgesModeGammaFlagsRangeAndSalinityExactly) {
  for (const std::uint8_t mode : {1, 2}) {
    SimpleFire fire = fire_with(mode, 1234.56);  // beyond the range of the head
    fire.fire.gamma = 200;
    fire.fire.flags = 0x4D;
    fire.fire.salinity_ppt = 33.3;
    fire.fire.gain_percent = 50.0;
    fire.fire.sound_speed_mps = 1510.0;
    const PingPlan plan = plan_ping(fire, {});
    SimpleFire wanted = fire;
    wanted.version = 1;
    wanted.fire.gain_percent = mode == 2 ? 70.0 : 50.0;
    EXPECT_TRUE(plan.result.fire == wanted);
    EXPECT_EQ(plan.range_m, mode == 1 ? 120.0 : 40.0);
  }
}

TEST(OculusPlan, GainAndSpeedAreEchoedAsTheConfigurationSays) {
  SimpleFire fire = fire_with(2, 2.0);
  const PingPlan usual = plan_ping(fire, {});
  EXPECT_EQ(usual.result.fire.fire.sound_speed_mps, usual.result.sound_speed_mps);
  PlanConfig plain;
  plain.rescales_high_frequency_gain = false;
  plain.reports_sound_speed_used = false;
  const PingPlan other = plan_ping(fire, plain);
  EXPECT_EQ(other.result.fire.fire.gain_percent, 50.0);
  EXPECT_EQ(other.result.fire.fire.sound_speed_mps, 0.0);
}

// Readers of viewer logs accept versions 1 and 2 only, but the recording of a real head has version 0.
TEST(OculusPlan, VersionOfTheResultFollowsTheLengthOfTheFire) {
  for (const bool reports_version_1 : {true, false}) {
    PlanConfig config;
    config.reports_version_1 = reports_version_1;
    for (const std::uint16_t stated : {0, 1, 2}) {
      SimpleFire fire = fire_with(1, 5.0);
      fire.version = stated;
      EXPECT_EQ(plan_ping(fire, config).result.fire.version, reports_version_1 || stated == 1 ? 1 : 0);
      fire.extension = FireExtension{};
      EXPECT_EQ(plan_ping(fire, config).result.fire.version, 2);
    }
  }
}

// A column of 10 m of water weighs about as much as the air above it.
TEST(OculusPlan, PressureIsThatOfAirAndOfTheWaterAbove) {
  PlanConfig config;
  config.pressure_bar = 1.7;
  EXPECT_NEAR(pressure_bar(20.0, config), 3.013, 1e-9);
  EXPECT_NEAR(pressure_bar(0.0, config), 1.013, 1e-9);
  EXPECT_NEAR(pressure_bar(-5.0, config), 1.013, 1e-9) << "in the air";
  EXPECT_EQ(pressure_bar(std::nullopt, config), 1.7) << "the world has no surface";
  config.surface_pressure_bar = 0.0;
  EXPECT_NEAR(pressure_bar(20.0, config), 2.0, 1e-9);
  EXPECT_EQ(pressure_bar(-5.0, config), 0.0);
}

TEST(OculusPlan, AttitudeIsInDegreesWithTheSignsOfTheConfiguration) {
  const SensorReadings readings{.heading_rad = std::numbers::pi / 3,
                                .pitch_rad = -std::numbers::pi / 12,
                                .roll_rad = std::numbers::pi / 60,
                                .depth_m = 20.0};
  struct Case {
    int sign;
    double heading_deg, pitch_deg, roll_deg;
  };
  for (const Case& it : {Case{1, 60.0, -15.0, 3.0}, Case{-1, 300.0, 15.0, -3.0}, Case{0, 0.0, 0.0, 0.0}}) {
    PlanConfig config;
    config.heading_sign = config.pitch_sign = config.roll_sign = it.sign;
    PingResult ping;
    report_readings(readings, config, ping);
    EXPECT_NEAR(ping.heading_deg, it.heading_deg, 1e-9);
    EXPECT_NEAR(ping.pitch_deg, it.pitch_deg, 1e-9);
    EXPECT_NEAR(ping.roll_deg, it.roll_deg, 1e-9);
    EXPECT_NEAR(ping.pressure_bar, 3.013, 1e-9);
  }
  PlanConfig other_way;
  other_way.heading_sign = -1;
  PingResult north;
  report_readings({.heading_rad = 1e-18, .depth_m = std::nullopt}, other_way, north);
  EXPECT_EQ(north.heading_deg, 0.0) << "not 360";
}

TEST(OculusPlan, RatesAreLimits) {
  SimpleFire fire = fire_with(2, 2.0);
  const auto period = [&](int rate) {
    fire.fire.ping_rate = static_cast<std::uint8_t>(rate);
    return plan_ping(fire, {}).period;
  };
  EXPECT_EQ(period(0), milliseconds{100});
  EXPECT_NEAR(static_cast<double>(period(1).count()), 1e9 / 15.0, 1.0);
  EXPECT_EQ(period(2), milliseconds{25});
  EXPECT_EQ(period(3), milliseconds{200});
  EXPECT_EQ(period(4), milliseconds{500});
  EXPECT_EQ(period(195), milliseconds{100});
  EXPECT_FALSE(period_of_rate(5));
}

TEST(OculusPlan, FarEchoesAndSlowLinksTakeLonger) {
  SimpleFire fire = fire_with(1, 120.0);
  fire.fire.sound_speed_mps = 1500.0;
  EXPECT_EQ(plan_ping(fire, {}).period, milliseconds{165});
  fire = fire_with(2, 2.0);
  fire.fire.ping_rate = 2;
  fire.fire.network_speed = 10;
  const PingPlan plan = plan_ping(fire, {});
  EXPECT_NEAR(static_cast<double>(plan.period.count()),
              8.0 * static_cast<double>(plan.result.image_offset + plan.image_size()) * 100.0, 1.0);
}

TEST(OculusPlan, PercentAreOfTheModesRange) {
  SimpleFire fire = fire_with(1, 25.0);
  fire.fire.flags = 0x08;
  EXPECT_EQ(plan_ping(fire, {}).range_m, 30.0);
}

TEST(OculusPlan, ModesHaveAperturesOfTheirOwn) {
  PlanConfig config;
  config.model = m1200d;
  EXPECT_EQ(plan_ping(fire_with(1, 5.0), config).result.bearings_cdeg.back(), 6500);
  EXPECT_EQ(plan_ping(fire_with(2, 5.0), config).result.bearings_cdeg.back(), 3000);
  EXPECT_EQ(plan_ping(fire_with(0, 5.0), config).result.bearings_cdeg.back(), 3000);
}

TEST(OculusPlan, NumbersThatMeanNothingDoNoHarm) {
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e300, 1e300}) {
    SimpleFire fire = fire_with(2, value);
    fire.fire.sound_speed_mps = value;
    fire.fire.salinity_ppt = value;
    const PingPlan plan = plan_ping(fire, {});
    EXPECT_GE(plan.result.ranges, 1);
    EXPECT_LE(plan.result.ranges, 1200);
    EXPECT_GE(plan.result.sound_speed_mps, 1400.0);
    EXPECT_LE(plan.result.sound_speed_mps, 1600.0);
  }
}

TEST(OculusPlan, ImageHasAGainOfOneBeforeEachRowAndFullScale) {
  PingResult ping;
  ping.ranges = 2;
  ping.beams = 2;
  ping.fire.fire.flags = 0x0D;
  EXPECT_EQ(*image_bytes(ping, {1, 2, 3, 255}, {}),
            (std::vector<std::uint8_t>{1, 0, 0, 0, 1, 2, 1, 0, 0, 0, 3, 255}));
  ping.fire.fire.flags = 0x0B;
  ping.data_size = DataSize::bits_16;
  EXPECT_EQ(*image_bytes(ping, {}, {1, 2, 3, 0xFFFE}),
            (std::vector<std::uint8_t>{1, 0, 2, 0, 3, 0, 0xFE, 0xFF}));
  ping.data_size = DataSize::bits_32;
  ping.ranges = 1;
  EXPECT_EQ(*image_bytes(ping, {}, {0, 0xFFFF}),
            (std::vector<std::uint8_t>{0, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF}));
  EXPECT_FALSE(image_bytes(ping, {}, {0}));
}

TEST(OculusPlan, SamplesOfEightBitsAreWidenedAndWideOnesNotCut) {
  PingResult ping;
  ping.ranges = 1;
  ping.beams = 2;
  ping.fire.fire.flags = 0x0B;
  ping.data_size = DataSize::bits_16;
  EXPECT_EQ(*image_bytes(ping, {1, 0xFF}, {}), (std::vector<std::uint8_t>{1, 1, 0xFF, 0xFF}));
  ping.data_size = DataSize::bits_32;
  EXPECT_EQ(*image_bytes(ping, {1, 0xFF}, {}),
            (std::vector<std::uint8_t>{1, 1, 1, 1, 0xFF, 0xFF, 0xFF, 0xFF}));
  ping.data_size = DataSize::bits_8;
  EXPECT_FALSE(image_bytes(ping, {}, {1, 2}));
}

}  // namespace
}  // namespace sonard::oculus
