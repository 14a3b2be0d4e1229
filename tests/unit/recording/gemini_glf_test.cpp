// SPDX-License-Identifier: Apache-2.0
// Expectations are worked out by hand from docs/protocols/gemini.md and docs/logs.md.
#include "server/recording/gemini_glf.hpp"

#include <gtest/gtest.h>

#include "protocol/gemini/gain_law.hpp"

namespace sonard::server {
namespace {

// 2026-11-20 14:22:33.25 UTC
constexpr std::int64_t transmit_unix_ns = 1'795'184'553'250'000'000;
constexpr double transmit_glf_s = 1'479'651'753.25;

GeminiPing ping_of(int native_lines, int compression) {
  GeminiPing ping;
  ping.head.header.sonar_id = 513;
  ping.head.ext_mode = gemini::ext_bits::eight_bit;
  ping.head.end_range = static_cast<std::uint16_t>(native_lines);
  ping.head.range_compression = static_cast<std::uint8_t>(compression);
  ping.head.sound_speed_used = 0x8000 | 14'856;
  ping.pixels.assign(static_cast<std::size_t>((native_lines >> compression) * 256), 7);
  ping.transmit_unix_ns = transmit_unix_ns;
  ping.gain_percent = 49.7;
  return ping;
}

TEST(GeminiGlf, AnImageSaysWhoAndWhen) {
  const glf::ImageRecord image = to_glf_image(ping_of(100, 0), {.utc_offset_s = 0, .gemini_number = 3});
  EXPECT_EQ(image.origin.device_id, 513);
  EXPECT_EQ(image.origin.node_id, 103);
  EXPECT_EQ(image.origin.time_s, transmit_glf_s);
  EXPECT_EQ(image.transmit_time_s, transmit_glf_s);
}

TEST(GeminiGlf, TimesFollowTheZoneOfTheLog) {
  const glf::ImageRecord image = to_glf_image(ping_of(100, 0), {.utc_offset_s = 3600, .gemini_number = 0});
  EXPECT_EQ(image.origin.time_s, transmit_glf_s + 3600.0);
  EXPECT_EQ(image.transmit_time_s, transmit_glf_s + 3600.0);
}

TEST(GeminiGlf, PortIsFirstAndPositive) {
  const glf::ImageRecord image = to_glf_image(ping_of(100, 0), {});
  ASSERT_EQ(image.beams, 256U);
  ASSERT_EQ(image.bearings_rad.size(), 256U);
  EXPECT_NEAR(image.bearings_rad.front(), 1.0405, 5e-5);
  EXPECT_NEAR(image.bearings_rad.back(), -1.0405, 5e-5);
  EXPECT_EQ(image.aperture_deg, 120.0F);
}

TEST(GeminiGlf, ALineIsAsLongAsTheHeadMadeIt) {
  // 90422 lines a second, sound goes there and back.
  for (const int compression : {0, 1, 2, 3, 4}) {
    const glf::ImageRecord image = to_glf_image(ping_of(1024, compression), {});
    EXPECT_EQ(image.lines, 1024U >> compression);
    EXPECT_EQ(image.range_compression, 0);
    EXPECT_NEAR(image.sound_speed_mps, 1485.6, 1e-3);
    const double line_m = image.sound_speed_mps / 2.0 / image.modulation_frequency_hz;
    EXPECT_NEAR(image.lines * line_m, 1024 * 1485.6 / 2.0 / 90422.0, 0.001) << compression;
  }
  EXPECT_EQ(to_glf_image(ping_of(100, 1), {}).modulation_frequency_hz, 45'211U);
}

TEST(GeminiGlf, FlagsSayWhereTheSoundSpeedIsFromAndThatTheFrequencyIsTheLowOne) {
  GeminiPing ping = ping_of(100, 0);
  EXPECT_EQ(to_glf_image(ping, {}).ping_flags, 0x8000);
  ping.head.sound_speed_used = 15'000;
  EXPECT_EQ(to_glf_image(ping, {}).ping_flags, 0);
}

TEST(GeminiGlf, GainIsInWholePercent) {
  EXPECT_EQ(to_glf_image(ping_of(100, 0), {}).gain_percent, 50);
}

TEST(GeminiGlf, PercentIsWhatTheEarlyLibraryTurnsIntoSpreading) {
  // trunc(500 exp((g - 100) / 25))
  EXPECT_NEAR(gemini::gain_percent(67), 50.0, 0.4);
  EXPECT_NEAR(gemini::gain_percent(500), 100.0, 1e-9);
  EXPECT_NEAR(gemini::gain_percent(9), 0.0, 0.5);
  EXPECT_EQ(gemini::gain_percent(0), gemini::gain_percent(9));
  EXPECT_EQ(gemini::gain_percent(65'535), 100.0);
}

TEST(GeminiGlf, SixteenBitsLoseTheLowerEight) {
  EXPECT_EQ(eight_bit_pixels({0x0000, 0x00FF, 0x0100, 0xABCD, 0xFFFF}),
            (std::vector<std::uint8_t>{0, 0, 1, 0xAB, 0xFF}));
}

TEST(GeminiGlf, AStatusSaysHowTheHeadIs) {
  gemini::Status status;
  status.sonar_id = 513;
  status.alternate_ip = 0x7F000002;
  status.mac.octets = {0x00, 0x12, 0x34, 0x56, 0x78, 0x9A};
  status.vga2a_temperature = gemini::temperature_code(22.25);
  status.tx1_temperature = gemini::temperature_code(24.0);
  status.die_temperature = gemini::die_temperature_code(45.0);
  status.clock_us = 123'456'789'012;
  status.shutdown_status = 0x0004;
  const glf::StatusRecord record =
      to_glf_status(status, transmit_unix_ns, {.utc_offset_s = -60, .gemini_number = 0});
  EXPECT_EQ(record.origin.time_s, transmit_glf_s - 60.0);
  EXPECT_EQ(record.origin.node_id, 100);
  EXPECT_EQ(record.origin.device_id, 513);
  EXPECT_EQ(record.device_id, 513);
  EXPECT_EQ(record.bf_firmware_version, 0x0119);
  EXPECT_EQ(record.alternate_ip, 0x7F000002U);
  EXPECT_EQ(record.mac, (std::array<std::uint16_t, 3>{0x0012, 0x3456, 0x789A}));
  EXPECT_EQ(record.afe_c.at(2), 22.25);
  EXPECT_EQ(record.afe_c.at(0), 0.0);  // no sensor answers
  EXPECT_EQ(record.tx_c, 24.0);
  EXPECT_NEAR(record.die_c, 45.0, 0.25);
  EXPECT_EQ(record.fpga_time_us, 123'456'789'012U);
  EXPECT_EQ(record.shutdown_status, 0x0004);
  EXPECT_EQ(record.link_type, 0x1100);  // negotiated Ethernet of 100 Mb/s
}

}  // namespace
}  // namespace sonard::server
