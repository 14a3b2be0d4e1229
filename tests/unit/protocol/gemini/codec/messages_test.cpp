// SPDX-License-Identifier: Apache-2.0
// Meaning of the raw integers in the messages.
#include "protocol/gemini/messages.hpp"

#include <gtest/gtest.h>

namespace sonard::gemini {
namespace {

TEST(Temperature, CodesOfTheStatusExample) {
  EXPECT_EQ(temperature_code(21.25), 0x8055);
  EXPECT_EQ(temperature_code(21.5), 0x8056);
  EXPECT_EQ(temperature_code(22.0), 0x8058);
  EXPECT_EQ(temperature_code(30.0), 0x8078);
  EXPECT_EQ(temperature_code(60.0), 0x80F0);
  EXPECT_EQ(temperature_code(70.0), 0x8118);
}

TEST(Temperature, IsTenBitTwosComplementInQuarters) {
  EXPECT_EQ(temperature_code(0.0), 0x8000);
  EXPECT_EQ(temperature_code(-0.25), 0x83FF);
  EXPECT_EQ(temperature_code(-128.0), 0x8200);
  EXPECT_EQ(temperature_code(127.75), 0x81FF);
  EXPECT_EQ(temperature_code(500.0), 0x81FF) << "clamped";
  EXPECT_EQ(temperature_code(-500.0), 0x8200) << "clamped";
  EXPECT_EQ(temperature_code(20.1), 0x8050) << "80.4 quarters round to 80";
}

TEST(Temperature, DecodesEveryQuarterItEncodes) {
  for (int quarters = -512; quarters <= 511; ++quarters) {
    EXPECT_EQ(temperature_celsius(temperature_code(quarters * 0.25)), quarters * 0.25);
  }
}

TEST(Temperature, SensorNotFitted) {
  EXPECT_EQ(temperature_celsius(0), std::nullopt);
  EXPECT_EQ(temperature_celsius(0x0055), std::nullopt);
}

TEST(Temperature, DieHasAScaleOfItsOwn) {
  EXPECT_EQ(die_temperature_code(45.0), 646);
  EXPECT_EQ(die_temperature_code(85.0), 728);
  EXPECT_NEAR(die_temperature_celsius(646), 44.79, 0.01);
  EXPECT_EQ(die_temperature_code(-300.0), 0);
  EXPECT_EQ(die_temperature_code(1000.0), 1023);
}

TEST(PingConfig, RunModeIsTwoBits) {
  PingConfig config;
  config.run_mode = 0x8002;
  EXPECT_EQ(config.mode(), RunMode::external_trigger);
  config.run_mode = 0x0011;  // later clients set more bits
  EXPECT_EQ(config.mode(), RunMode::continuous);
}

TEST(PingConfig, EightBitHoldsForMagnitudesOnly) {
  PingConfig config;
  config.ext_mode = 0x0204;
  EXPECT_TRUE(config.eight_bit());
  EXPECT_TRUE(config.pings_out_of_water());
  config.ext_mode = 0x0000;
  EXPECT_FALSE(config.eight_bit());
  EXPECT_FALSE(config.pings_out_of_water());
  config.ext_mode = 0x0005;
  EXPECT_EQ(config.data_type(), DataType::beam_iq);
  EXPECT_FALSE(config.eight_bit());
}

TEST(PingConfig, CompressionOfFiveAndMoreIsNone) {
  EXPECT_EQ(compression_log2(0), 0);
  EXPECT_EQ(compression_log2(4), 4);
  EXPECT_EQ(compression_log2(5), 0);
  EXPECT_EQ(compression_log2(7), 0);
  EXPECT_EQ(compression_log2(0x0102), 2) << "bit 8 asks for peaks and is no part of the factor";
}

TEST(PingConfig, LineCountIsWhatClientsOfBothGenerationsExpect) {
  PingConfig config;
  config.end_range = 1206;
  config.range_compression = 1;
  EXPECT_EQ(config.line_count(), 603) << "10 m at n = 1 gives images of 603 lines";
  config.end_range = 483;
  config.range_compression = 2;
  EXPECT_EQ(config.line_count(), 120) << "rounded down";
  config.start_range = 100;
  EXPECT_EQ(config.line_count(), 120) << "the head takes the start as 0";
}

TEST(PingConfig, RleThresholdsOfOneAndTwoActAsThree) {
  PingConfig config;
  config.ext_mode = 0x0004;
  const std::pair<std::uint16_t, int> expected[]{{0, 0},   {1, 3},     {2, 3},    {3, 3},
                                                 {50, 50}, {255, 255}, {300, 255}};
  for (const auto& [asked, applied] : expected) {
    config.rle_threshold = asked;
    EXPECT_EQ(config.rle_threshold_applied(), applied) << asked;
  }
  config.ext_mode = 0x0000;
  config.rle_threshold = 50;
  EXPECT_EQ(config.rle_threshold_applied(), 0) << "no run-length coding of 16-bit samples";
}

TEST(PingHead, LineCountCountsFromStartAndIsNeverNegative) {
  PingHead head;
  head.end_range = 1206;
  head.start_range = 6;
  head.range_compression = 2;
  EXPECT_EQ(head.line_count(), 300);
  head.start_range = 2000;
  EXPECT_EQ(head.line_count(), 0);
}

TEST(PingHead, SoundSpeedLeavesOutTheSourceBit) {
  PingHead head;
  head.sound_speed_used = sound_speed_from_config | 14'992;
  EXPECT_DOUBLE_EQ(head.sound_speed_mps(), 1499.2);
}

TEST(PingLine, InfoWordOfTheDocument) {
  EXPECT_EQ(make_line_info(256, false, 0x0204), 0x2004);
  EXPECT_EQ(make_line_info(256, true, 0x0204), 0x2044);
  EXPECT_EQ(make_line_info(512, false, 0x0200), 0x4000) << "16-bit samples";
}

TEST(PingLine, FlagsAreNoPartOfTheNumber) {
  PingLine line;
  line.line_id = resent_line | 482;
  line.line_info = 0x2044;
  EXPECT_EQ(line.line_number(), 482);
  EXPECT_TRUE(line.resent());
  EXPECT_TRUE(line.last());
  EXPECT_EQ(line.word_count(), 64U);
}

TEST(PingTail, ResentFlag) {
  EXPECT_TRUE((PingTail{.ping_id = 5, .flags = 0x80}.resent()));
  EXPECT_FALSE((PingTail{.ping_id = 5, .flags = 0x7F}.resent()));
}

TEST(FlashResult, ReadyBitIsNoFailure) {
  EXPECT_TRUE((FlashResult{.result = 0x8000}.success()));
  EXPECT_TRUE((FlashResult{.result = 0x0000}.success()));
  EXPECT_FALSE((FlashResult{.result = 0x8001}.success()));
}

TEST(Status, DefaultDoesNotReadAsBootLoader) {
  const Status status;
  EXPECT_NE(status.boot_status & 0x1FF, 0x001U);
  EXPECT_EQ(status.product_code(), 0);
  EXPECT_EQ(status.link_type & link_bits::vdsl, 0);
}

}  // namespace
}  // namespace sonard::gemini
