// SPDX-License-Identifier: Apache-2.0
// What heads are asked for along a voyage.
#include <chrono>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "protocol/gemini/bearings.hpp"
#include "server/offline/gemini_frames.hpp"
#include "server/offline/scan_frames.hpp"

namespace sonard::server {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t second_ns = 1'000'000'000;

/// One metre a second along x, for `seconds`, from the stamp 100 s on.
Voyage ahead(int seconds) {
  const std::int64_t start = 100 * second_ns;
  return Voyage(pose::Trajectory({{start, {{0, 0, 0}, {1, 0, 0, 0}}},
                                  {start + seconds * second_ns, {{1.0 * seconds, 0, 0}, {1, 0, 0, 0}}}}));
}

TEST(GeminiFrames, PingAtTheRateAskedForWithNumberAndPose) {
  GeminiHeadConfig head;
  head.T_vehicle_sonar.position_m = {0.5, 0, 0};
  head.seed = 9;
  const Voyage voyage = ahead(2);
  OfflineOptions options;
  options.rate_hz = 4.0;
  const GeminiFrames frames(head, {1, 0}, voyage, options, nullptr);
  EXPECT_EQ(frames.count(), 9);
  EXPECT_EQ(frames.name(3), "ping_000003");
  const render::PingRequest ping = frames.request(3);
  EXPECT_EQ(ping.ping_number, 3U);
  EXPECT_EQ(ping.seed, 9U);
  EXPECT_DOUBLE_EQ(ping.T_world_sonar.position_m.x, 0.75 + 0.5);
  // 20 m and back at 1500 m/s take 2411 lines of 1 / 90422 s.
  ASSERT_TRUE(ping.T_world_sonar_at_end);
  EXPECT_NEAR(ping.T_world_sonar_at_end->position_m.x, 1.25 + 2411 / 90422.0, 1e-8);
  EXPECT_EQ(ping.settings.range.count, 2411);
}

// docs/protocols/gemini.md 8.4, 8.5.
TEST(GeminiFrames, TheNaturalRateIsTheFastestThatHeadWaterAndLinkAllow) {
  GeminiHeadConfig head;
  const Voyage voyage = ahead(10);
  const auto frames_with = [&](double range_m, int compression_log2) {
    OfflineOptions options;
    options.gemini.range_m = range_m;
    options.gemini.compression_log2 = compression_log2;
    return GeminiFrames(head, {}, voyage, options, nullptr).count();
  };
  head.device.min_ping_period = 100ms;
  EXPECT_EQ(frames_with(20, 0), 101);  // the head
  head.device.min_ping_period = 1ms;
  head.device.line_period = 100us;
  EXPECT_EQ(frames_with(20, 0), 1 + static_cast<int>(10.0 / (2413 * 100e-6)));  // the link
  EXPECT_EQ(frames_with(20, 4), 1 + static_cast<int>(10.0 * 90422.0 / 2411));   // the water
}

TEST(GeminiFrames, RecordsAreThoseOfTheLog) {
  GeminiHeadConfig head;
  head.device.sonar_id = 777;
  const Voyage voyage = ahead(1);
  OfflineOptions options;
  options.rate_hz = 2.0;
  options.gemini.range_m = 1.0;
  options.gemini.gain_percent = 30.0;
  const GeminiFrames frames(head, {0, 2}, voyage, options, nullptr);
  constexpr int lines = 121;  // 1 m of 1500 / 2 / 90422 m
  std::vector<std::uint8_t> pixels(lines * 256U, 7);
  pixels[1] = 200;
  const auto record = frames.record(1, npy_bytes({lines, 256, pixels, {}}));
  ASSERT_TRUE(record);
  EXPECT_EQ(record->pixels, pixels);
  EXPECT_EQ(record->lines, 121U);
  EXPECT_EQ(record->origin.device_id, 777);
  EXPECT_EQ(record->origin.node_id, 102);
  EXPECT_DOUBLE_EQ(record->origin.time_s, 100.5);  // the trajectory's own stamp
  EXPECT_DOUBLE_EQ(record->transmit_time_s, 100.5);
  EXPECT_EQ(record->gain_percent, 30);
  EXPECT_GT(record->bearings_rad.front(), 1.0);  // beam 0, to port, is positive in a log
  EXPECT_FALSE(frames.record(1, npy_bytes({lines, 255, std::vector<std::uint8_t>(lines * 255U), {}})));
}

TEST(ScanFrames, ATurnEndsBeforeItsFirstBearingComesAgain) {
  const MicronHeadConfig head;
  const Voyage voyage = ahead(10);
  OfflineOptions options;
  options.rate_hz = 50.0;  // 501 lines
  const ScanFrames frames(head, 0, voyage, options, nullptr);
  EXPECT_EQ(frames.count(), 2);
  EXPECT_EQ(frames.first_line(1), 200);
  EXPECT_EQ(frames.first_line(2), 400);
  // Ahead first, then clockwise: line 50 looks to starboard, which is -y.
  const glm::dvec3 ahead_axis = frames.request(0).T_world_sonar.orientation * glm::dvec3(1, 0, 0);
  const glm::dvec3 axis = frames.request(50).T_world_sonar.orientation * glm::dvec3(1, 0, 0);
  EXPECT_NEAR(ahead_axis.x, 1.0, 1e-12);
  EXPECT_NEAR(axis.y, -1.0, 1e-12);
  EXPECT_EQ(frames.request(250).ping_number, 250U);
  EXPECT_DOUBLE_EQ(frames.request(250).T_world_sonar.position_m.x, 5.0);
}

TEST(ScanFrames, ASweepEndsWithTheLineAtTheOtherLimit) {
  const MicronHeadConfig head;
  const Voyage voyage = ahead(3);
  OfflineOptions options;
  options.rate_hz = 50.0;                                  // 151 lines
  options.micron.sector = micron::ScanSector{2400, 4000};  // 90 degrees about ahead: 51 bearings
  const ScanFrames frames(head, 0, voyage, options, nullptr);
  ASSERT_EQ(frames.count(), 3);
  EXPECT_EQ(frames.first_line(1), 51);
  EXPECT_EQ(frames.first_line(2), 101);
  EXPECT_EQ(frames.first_line(3), 151);
  const auto azimuth_rad = [&](int line) {
    const glm::dvec3 axis = frames.request(line).T_world_sonar.orientation * glm::dvec3(1, 0, 0);
    return std::atan2(axis.y, axis.x);
  };
  EXPECT_NEAR(azimuth_rad(0), std::numbers::pi / 4, 1e-12);  // port first
  EXPECT_NEAR(azimuth_rad(50), -std::numbers::pi / 4, 1e-12);
  EXPECT_NEAR(azimuth_rad(100), std::numbers::pi / 4, 1e-12);
}

TEST(ScanFrames, WithoutTimeForASweepThereIsNone) {
  const MicronHeadConfig head;
  const Voyage voyage = ahead(1);
  EXPECT_EQ(ScanFrames(head, 0, voyage, {}, nullptr).count(), 0);
}

}  // namespace
}  // namespace sonard::server
