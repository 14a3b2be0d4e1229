// SPDX-License-Identifier: Apache-2.0
// The expected values were calculated by hand from docs/logs.md.
#include "server/recording/glf_records.hpp"

#include <numbers>

#include <gtest/gtest.h>

#include "protocol/glf/log_view.hpp"
#include "server/recording/glf_log_writer.hpp"
#include "tests/unit/server/recording/fixture.hpp"

namespace sonard::server {
namespace {

// 2026-11-20 14:22:33.25 UTC
constexpr std::int64_t transmit_unix_ns = 1'795'184'553'250'000'000;
constexpr double transmit_glf_s = 1'479'651'753.25;
constexpr double line_rate_hz = 90'422.0;

/// A ping of a head that has 90422 lines per second and averages 2^compression_log2 of them.
PingRecord ping_of(int native_lines, int compression_log2) {
  constexpr double sound_speed_mps = 1485.6;
  PingRecord ping;
  ping.settings.bins = native_lines >> compression_log2;
  ping.settings.beams = 2;
  ping.settings.bin_m = sound_speed_mps / (2.0 * line_rate_hz) * (1 << compression_log2);
  ping.settings.sound_speed_mps = sound_speed_mps;
  ping.settings.gain_percent = 49.7;
  ping.range_compression_log2 = compression_log2;
  ping.bearings_rad = {-1.0405, 1.0405};
  ping.sector_rad = 2.0 * std::numbers::pi / 3.0;
  ping.samples.assign(static_cast<std::size_t>(ping.settings.bins * 2), 7);
  return ping;
}

glf::ImageRecord image_of(PingRecord ping, const GlfLogOrigin& origin = {}) {
  return glf_image(std::move(ping), transmit_unix_ns, origin);
}

TEST(GlfRecords, AnImageSaysWhoAndWhen) {
  const glf::ImageRecord image =
      image_of(ping_of(100, 0), {.utc_offset_s = 0, .number = 3, .device_id = 513});
  EXPECT_EQ(image.origin.device_id, 513);
  EXPECT_EQ(image.origin.node_id, 103);
  EXPECT_EQ(image.origin.time_s, transmit_glf_s);
  EXPECT_EQ(image.transmit_time_s, transmit_glf_s);
}

TEST(GlfRecords, TimesFollowTheZoneOfTheLog) {
  const glf::ImageRecord image = image_of(ping_of(100, 0), {.utc_offset_s = 3600});
  EXPECT_EQ(image.origin.time_s, transmit_glf_s + 3600.0);
  EXPECT_EQ(image.transmit_time_s, transmit_glf_s + 3600.0);
  EXPECT_EQ(glf_origin(transmit_unix_ns, {.utc_offset_s = -60}).time_s, transmit_glf_s - 60.0);
}

TEST(GlfRecords, PortIsFirstAndPositive) {
  const glf::ImageRecord image = image_of(ping_of(100, 0));
  EXPECT_EQ(image.beams, 2U);
  ASSERT_EQ(image.bearings_rad.size(), 2U);
  EXPECT_NEAR(image.bearings_rad.front(), 1.0405, 5e-5);
  EXPECT_NEAR(image.bearings_rad.back(), -1.0405, 5e-5);
  EXPECT_EQ(image.aperture_deg, 120.0F);
}

TEST(GlfRecords, ALineIsAsLongAsTheHeadMadeIt) {
  for (const int compression : {0, 1, 2, 3, 4}) {
    const glf::ImageRecord image = image_of(ping_of(1024, compression));
    EXPECT_EQ(image.lines, 1024U >> compression);
    EXPECT_EQ(image.range_compression, compression) << "2 to the power of it";
    EXPECT_NEAR(image.sound_speed_mps, 1485.6, 1e-3);
    const double line_m = image.sound_speed_mps / 2.0 / image.modulation_frequency_hz;
    EXPECT_NEAR(image.lines * line_m, 1024 * 1485.6 / 2.0 / line_rate_hz, 0.001) << compression;
  }
  EXPECT_EQ(image_of(ping_of(100, 1)).modulation_frequency_hz, 45'211U);
  EXPECT_EQ(image_of(ping_of(100, 2)).modulation_frequency_hz, 22'606U)
      << "22605.5, whatever the division leaves";
}

TEST(GlfRecords, FlagsSayWhereTheSoundSpeedIsFromAndThatTheFrequencyIsTheLowOne) {
  PingRecord ping = ping_of(100, 0);
  EXPECT_EQ(image_of(ping).ping_flags, 0x8000);
  ping.settings.sound_speed_from_config = false;
  EXPECT_EQ(image_of(ping).ping_flags, 0);
}

TEST(GlfRecords, GainIsInWholePercent) {
  EXPECT_EQ(image_of(ping_of(100, 0)).gain_percent, 50);
}

/// Node of the image that the log of a head stores.
std::uint16_t node_in_log(const std::vector<HeadToRecord>& heads, int head) {
  const test::TemporaryFolder folder;
  RecordingConfig config;
  config.directory = folder.path();
  const LogSetting setting{config, heads, {}, 0, "stem"};
  GlfLogWriter log(setting, head);
  RecordingEvent event = test::ping_event(1, 32, TimePoint{transmit_unix_ns});
  event.head = head;
  log.write(event);
  log.close();
  const std::vector<std::uint8_t> file = test::contents(log.file().path());
  const auto view = glf::LogView::open(file);
  EXPECT_TRUE(view && view->index().records.size() == 1U);
  return view->image(view->index().records.front())->origin.node_id;
}

TEST(GlfLogWriter, NumbersTheHeadsThatHaveGlfLogs) {
  std::vector<HeadToRecord> heads(12, test::one_head().front());
  heads[1].glf = nullptr;
  EXPECT_EQ(node_in_log(heads, 0), 100);
  EXPECT_EQ(node_in_log(heads, 2), 101);
  EXPECT_EQ(node_in_log(heads, 10), 109);
  EXPECT_EQ(node_in_log(heads, 11), 109) << "the highest number";
}

}  // namespace
}  // namespace sonard::server
