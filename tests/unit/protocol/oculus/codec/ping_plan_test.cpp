// SPDX-License-Identifier: Apache-2.0
// What a fire makes of a ping (docs/protocols/oculus.md 3.3, 4.4, 4.7, 8).
#include "protocol/oculus/ping_plan.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace sonard::oculus {
namespace {

using std::chrono::milliseconds;

SimpleFire fire_with(std::uint8_t mode, double range_m) {
  SimpleFire fire;
  fire.fire.master_mode = mode;
  fire.fire.range = range_m;
  return fire;
}

TEST(OculusPlan, acknowledges_mode_gamma_flags_range_and_salinity_exactly) {
  for (const std::uint8_t mode : {1, 2}) {
    SimpleFire fire = fire_with(mode, 1234.56);  // beyond what the head can do
    fire.fire.gamma = 200;
    fire.fire.flags = 0x4D;
    fire.fire.salinity_ppt = 33.3;
    fire.fire.gain_percent = 50.0;
    fire.fire.sound_speed_mps = 1510.0;
    const PingPlan plan = plan_ping(fire, {});
    SimpleFire wanted = fire;
    wanted.fire.gain_percent = mode == 2 ? 70.0 : 50.0;
    EXPECT_TRUE(plan.result.fire == wanted);
    EXPECT_EQ(plan.range_m, mode == 1 ? 120.0 : 40.0);
  }
}

TEST(OculusPlan, gain_and_speed_are_echoed_as_the_configuration_says) {
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

TEST(OculusPlan, version_of_the_result_follows_the_length_of_the_fire) {
  for (const std::uint16_t stated : {0, 1, 2}) {
    SimpleFire fire = fire_with(1, 5.0);
    fire.version = stated;
    EXPECT_EQ(plan_ping(fire, {}).result.fire.version, stated == 1 ? 1 : 0);
    fire.extension = FireExtension{};
    EXPECT_EQ(plan_ping(fire, {}).result.fire.version, 2);
  }
}

TEST(OculusPlan, rates_are_limits) {
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

TEST(OculusPlan, far_echoes_and_slow_links_take_longer) {
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

TEST(OculusPlan, percent_are_of_the_modes_range) {
  SimpleFire fire = fire_with(1, 25.0);
  fire.fire.flags = 0x08;
  EXPECT_EQ(plan_ping(fire, {}).range_m, 30.0);
}

TEST(OculusPlan, modes_have_apertures_of_their_own) {
  PlanConfig config;
  config.model = m1200d;
  EXPECT_EQ(plan_ping(fire_with(1, 5.0), config).result.bearings_cdeg.back(), 6500);
  EXPECT_EQ(plan_ping(fire_with(2, 5.0), config).result.bearings_cdeg.back(), 3000);
  EXPECT_EQ(plan_ping(fire_with(0, 5.0), config).result.bearings_cdeg.back(), 3000);
}

TEST(OculusPlan, numbers_that_mean_nothing_do_no_harm) {
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

TEST(OculusPlan, image_has_a_gain_of_one_before_each_row_and_full_scale) {
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

TEST(OculusPlan, samples_of_eight_bits_are_widened_and_wide_ones_not_cut) {
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
