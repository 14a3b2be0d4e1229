// SPDX-License-Identifier: Apache-2.0
// Numbers of the images (4), and shots in logs.
#include "protocol/sonar3d15/shot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/unit/protocol/sonar3d15/device/bench.hpp"

namespace sonard::sonar3d15::testing {
namespace {

DeviceConfig still_water() {
  DeviceConfig config = small();
  config.water_sound_speed_mps = 1491.0;
  config.gain = 1.0;
  return config;
}

Shot shot_of(const DeviceConfig& config, double speed_mps = 1491.0) {
  Settings settings;
  settings.range_m = 15.0;
  return make_shot(config, settings, speed_mps);
}

/// Both numbers of one echo of this linear strength, in all pixels.
std::pair<std::uint32_t, int> codes(const DeviceConfig& config, double range_m, double strength,
                                    double speed_mps = 1491.0, double least_m = 0.0) {
  Shot shot = shot_of(config, speed_mps);
  const std::size_t pixels = 32;
  DirectionRanges echoes{8, 4, std::vector<float>(pixels, static_cast<float>(range_m)),
                         std::vector<float>(pixels, static_cast<float>(strength * strength))};
  EXPECT_TRUE(add_echoes(echoes, config, least_m, shot));
  return {shot.range.image_pixel_data(31), static_cast<std::uint8_t>(shot.signal.image_pixel_data()[31])};
}

TEST(Shot, ARangeIsAWholeNumberOfSteps) {
  const DeviceConfig config = still_water();
  constexpr double step_m = 1491e-6, scale_m = 50.0 / 65536;
  for (int k = 1; k < 10'060; k += 7) {
    const auto wanted = static_cast<std::uint32_t>(std::floor(k * step_m / scale_m));
    EXPECT_EQ(codes(config, (k + 0.01) * step_m, 1000).first, wanted) << k;
    EXPECT_EQ(codes(config, (k + 0.99) * step_m, 1000).first, wanted) << k;
  }
}

TEST(Shot, SignalsAreHundredTimesTheLogarithm) {
  const DeviceConfig config = still_water();
  const std::pair<double, int> signals[] = {{29.9, 0},      {30.01, 1},   {30.5, 1},     {37.6, 9},
                                            {48, 20},       {300.1, 100}, {3000.1, 200}, {1504.0, 170},
                                            {32767.0, 255}, {1e9, 255}};
  for (const auto& [strength, code] : signals) {
    EXPECT_EQ(codes(config, 5.0, strength).second, code) << strength;
  }
}

TEST(Shot, ClientsReadTheStrengthOfTheExample) {
  const std::pair<int, double> linear[] = {{20, 48}, {40, 75}, {60, 119}, {80, 189}, {100, 300}, {170, 1504}};
  for (const auto& [code, strength] : linear) {
    EXPECT_EQ(std::round(30.0 * std::pow(10.0, code / 100.0)), strength);
    EXPECT_EQ(codes(still_water(), 5.0, strength + 0.5).second, code);
  }
}

TEST(Shot, WhatIsNotSentIsZeroInBothImages) {
  using Codes = std::pair<std::uint32_t, int>;
  DeviceConfig config = still_water();
  EXPECT_EQ(codes(config, 5.0, 30.0), (Codes{0, 0}));                 // not above the threshold
  EXPECT_EQ(codes(config, 0.0, 1000.0), (Codes{0, 0}));               // no echo
  EXPECT_EQ(codes(config, 0.0005, 1000.0), (Codes{0, 0}));            // range 0
  EXPECT_EQ(codes(config, 15.01, 1000.0), (Codes{0, 0}));             // beyond the range
  EXPECT_EQ(codes(config, 1.0, 1000.0, 1491.0, 1.1), (Codes{0, 0}));  // too near
  EXPECT_NE(codes(config, 1.2, 1000.0, 1491.0, 1.1).first, 0U);
  config.pixel_scale_m = 1e-4;
  EXPECT_EQ(codes(config, 7.0, 1000.0), (Codes{0, 0}));  // beyond 16 bits
}

TEST(Shot, TheAssumedSpeedOfSoundScalesRanges) {
  const DeviceConfig config = still_water();
  const double scale_m = config.pixel_scale_m;
  EXPECT_NEAR(codes(config, 5.0, 1000.0, 1491.0).first * scale_m, 5.0, 0.003);
  EXPECT_NEAR(codes(config, 5.0, 1000.0, 1789.2).first * scale_m, 6.0, 0.003);
}

TEST(Shot, AnImageOfAnotherSizeIsRefused) {
  Shot shot = shot_of(still_water());
  EXPECT_FALSE(add_echoes({}, still_water(), 0.0, shot));
  EXPECT_FALSE(add_echoes({8, 4, std::vector<float>(32), std::vector<float>(31)}, still_water(), 0.0, shot));
}

TEST(Shot, ShadesShowHowSurfacesLean) {
  // Columns and rows lie 1 degree apart. A wall at 45 degrees: the range changes by as much as a step across.
  Shot shot;
  shot.range.set_width(3);
  shot.range.set_height(2);
  shot.range.set_fov_horizontal(2.0F);
  shot.range.set_fov_vertical(1.0F);
  shot.range.set_image_pixel_scale(0.001F);
  for (const std::uint32_t code : {9825U, 10000U, 10175U, 10000U, 10000U, 0U}) {
    shot.range.add_image_pixel_data(code);
  }
  shot.signal.set_image_pixel_data(std::string("\x01\x01\x01\x01\x01\x00", 6));
  const std::string shades = shaded(shot).image_pixel_data();
  const auto shade = [&](std::size_t pixel) {
    return static_cast<int>(static_cast<std::uint8_t>(shades[pixel]));
  };
  EXPECT_NEAR(shade(1), 255 * std::sqrt(0.5), 2);
  EXPECT_EQ(shade(4), 255) << "beside a pixel without an echo";
  EXPECT_EQ(shade(5), 0);
}

TEST(Shot, AJobHasTheDirectionsOfTheMode) {
  DeviceConfig config;
  config.water_sound_speed_mps = 1500.0;
  Settings settings;
  settings.high_frequency = true;
  settings.least_range_m = 1.0;
  settings.range_m = 4.0;
  const PingJob job = make_job(config, settings, 1200.0);
  EXPECT_EQ(job.directions.columns, 256);
  EXPECT_EQ(job.directions.rows, 64);
  EXPECT_DOUBLE_EQ(job.directions.horizontal_fov_rad, job.directions.vertical_fov_rad);
  EXPECT_DOUBLE_EQ(job.directions.nearest_m, 1.25);  // true range of an echo reported at 1 m
  EXPECT_NEAR(job.range_m(), 5.0, 0.01);
  EXPECT_EQ(job.period, std::chrono::milliseconds{50});
  EXPECT_EQ(job.mode, 1);
  EXPECT_DOUBLE_EQ(job.frequency_hz, 2.4e6);
}

TEST(Shot, ARecordIsAFanAndKeepsBothImages) {
  const DeviceConfig config = still_water();
  Shot shot = shot_of(config);
  DirectionRanges echoes{8, 4, std::vector<float>(32), std::vector<float>(32)};
  echoes.range_m[3] = 7.51F;  // in the lowest row
  echoes.intensity[3] = 100.0F * 100.0F;
  echoes.range_m[16 + 3] = 7.52F;  // in the same bin and column, stronger
  echoes.intensity[16 + 3] = 3001.0F * 3001.0F;
  ASSERT_TRUE(add_echoes(echoes, config, 0.0, shot));
  set_header(std::chrono::seconds{5}, 9, shot);
  std::vector<std::uint8_t> wire = encode(shot.range, PacketId::rip2);
  const auto signal = encode(shot.signal, PacketId::rip1);
  wire.insert(wire.end(), signal.begin(), signal.end());
  const PingRecord record = record_of(shot, 1.2e6, wire);
  EXPECT_EQ(record.settings.bins, fan_bins);
  EXPECT_EQ(record.settings.beams, 8);
  EXPECT_DOUBLE_EQ(record.settings.range_m(), 15.0);
  EXPECT_NEAR(record.bearings_rad.front(), -record.sector_rad / 2, 1e-9);
  EXPECT_NEAR(record.bearings_rad.back(), record.sector_rad / 2, 1e-9);
  EXPECT_EQ(record.samples[128 * 8 + 3], 200);
  EXPECT_EQ(std::ranges::count(record.samples, 0), 256 * 8 - 1);

  const auto played = recorded_form(wire);
  ASSERT_TRUE(played);
  EXPECT_EQ(played->range.SerializeAsString(), shot.range.SerializeAsString());
  EXPECT_EQ(played->signal.SerializeAsString(), shot.signal.SerializeAsString());
}

TEST(Shot, ARecordHasThePointsOfItsEchoes) {
  Shot shot = shot_of(still_water());
  DirectionRanges echoes{8, 4, std::vector<float>(32), std::vector<float>(32)};
  echoes.range_m[7] = 6.0F;  // the lowest row, the last column: 20 degrees down, 45 to starboard
  echoes.intensity[7] = 1e6F;
  ASSERT_TRUE(add_echoes(echoes, still_water(), 0.0, shot));
  const PingRecord record = record_of(shot, 1.2e6, {});
  ASSERT_TRUE(record.points.has_value());
  ASSERT_EQ(record.points->size(), 1U);
  const EchoPoint& point = record.points->front();
  constexpr double down_rad = 20.0 * std::numbers::pi / 180.0;
  const double side_m = 6.0 * std::cos(down_rad) * std::sqrt(0.5);
  EXPECT_NEAR(static_cast<double>(point.x), side_m, 0.003);
  EXPECT_NEAR(static_cast<double>(point.y), -side_m, 0.003);
  EXPECT_NEAR(static_cast<double>(point.z), -6.0 * std::sin(down_rad), 0.003);
  EXPECT_EQ(point.intensity, 152.0F);
}

TEST(Shot, AWireThatIsNotOneShotIsNoRecording) {
  Shot shot = shot_of(still_water());
  ASSERT_TRUE(add_echoes({8, 4, std::vector<float>(32), std::vector<float>(32)}, still_water(), 0.0, shot));
  const auto range = encode(shot.range, PacketId::rip1), signal = encode(shot.signal, PacketId::rip1);
  const auto joined = [](const std::vector<std::vector<std::uint8_t>>& parts) {
    std::vector<std::uint8_t> all;
    for (const auto& part : parts) {
      all.insert(all.end(), part.begin(), part.end());
    }
    return all;
  };
  EXPECT_TRUE(recorded_form(joined({range, signal})));
  EXPECT_FALSE(recorded_form({}));
  EXPECT_FALSE(recorded_form(range));
  EXPECT_FALSE(recorded_form(joined({signal, range})));
  EXPECT_FALSE(recorded_form(joined({range, signal, signal})));
  EXPECT_FALSE(recorded_form(joined({range, signal, {0}})));
  shot.range.set_speed_of_sound(0.0F);
  EXPECT_FALSE(recorded_form(joined({encode(shot.range, PacketId::rip1), signal})));
}

}  // namespace
}  // namespace sonard::sonar3d15::testing
