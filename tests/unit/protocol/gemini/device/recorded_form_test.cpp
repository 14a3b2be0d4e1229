// SPDX-License-Identifier: Apache-2.0
// How a 720i sends a ping from a log, and which differences from the request are reported.
#include "protocol/gemini/recorded_form.hpp"

#include <algorithm>
#include <iterator>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

RecordedSettings settings(double bin_m = 1500.0 / (2 * 90422.0)) {
  RecordedSettings settings;
  settings.bins = 482;
  settings.beams = 256;
  settings.bin_m = bin_m;
  settings.sound_speed_mps = 1500.0;
  settings.gain_percent = 50.0;
  return settings;
}

TEST(RecordedForm, CompressionFollowsFromTheLengthOfALine) {
  for (int log2 = 0; log2 <= 4; ++log2) {
    const auto form = recorded_form(settings(1500.0 / (2 * 90422.0) * (1 << log2)));
    ASSERT_TRUE(form);
    EXPECT_EQ(form->compression_log2, log2);
    EXPECT_EQ(form->lines, 482);
    EXPECT_TRUE(form->exact);
  }
  // Rounded as in a .glf: 90422 / 16 = 5651.4 is written as 5651.
  EXPECT_TRUE(recorded_form(settings(1500.0 / (2 * 5651.0)))->exact);
}

TEST(RecordedForm, LinesThatA720iDoesNotHaveAreNoExactOnes) {
  const auto form = recorded_form(settings(1500.0 / (2 * 18750.0)));
  ASSERT_TRUE(form);
  EXPECT_FALSE(form->exact);
}

TEST(RecordedForm, OtherBeamsOrTooManyLinesCannotBeSent) {
  RecordedSettings other = settings();
  other.beams = 512;
  EXPECT_FALSE(recorded_form(other));
  other = settings();
  other.bins = 0;
  EXPECT_FALSE(recorded_form(other));
  other.bins = 65'535;
  EXPECT_TRUE(recorded_form(other));
  other.bins = 65'536;
  EXPECT_FALSE(recorded_form(other));
  other.bin_m *= 16;
  other.bins = 4095;
  EXPECT_TRUE(recorded_form(other)) << "65520 native lines";
  other.bins = 4096;
  EXPECT_FALSE(recorded_form(other)) << "65536 native lines";
}

ReplayedPing recorded(const RecordedSettings& settings) {
  ReplayedPing ping;
  ping.settings = settings;
  return ping;
}

TEST(HeldTo, OfTheConfigurationOnlyItsPlaceInTimeIsLeft) {
  PingConfig config = ping_of(2411, RunMode::continuous, 100ms);
  config.ext_mode = 0x0200;
  config.rle_threshold = 9;
  config.sound_speed = 14'000;
  const PingPlan asked = plan_ping(config, example_config()).value();
  ReplayedPing ping = recorded(settings(4 * 1500.0 / (2 * 90422.0)));
  ping.settings.sound_speed_from_config = false;
  const PingPlan sent = held_to(ping, asked, example_config());
  EXPECT_EQ(sent.mode, RunMode::continuous);
  EXPECT_EQ(sent.interval, 100ms);
  EXPECT_EQ(sent.job.native_bins, 4 * 482);
  EXPECT_EQ(sent.job.compression_log2, 2);
  EXPECT_EQ(sent.job.bins(), 482);
  EXPECT_DOUBLE_EQ(sent.job.native_bin_m, 1500.0 / (2 * 90422.0));
  EXPECT_EQ(sent.job.sound_speed_mps, 1500.0);
  EXPECT_EQ(sent.job.assumed_sound_speed_mps, 1500.0);
  EXPECT_EQ(sent.job.listening_time, acoustic_time(4 * 482));
  EXPECT_FALSE(sent.job.sixteen_bit);
  EXPECT_EQ(sent.rle_threshold, 0);
  EXPECT_TRUE(sent.head.eight_bit());
  EXPECT_EQ(sent.head.line_count(), 482);
  EXPECT_EQ(sent.head.rle_threshold, 0);
  EXPECT_EQ(sent.head.sound_speed_used, 15'000);

  ping.due = 3s;
  EXPECT_EQ(held_to(ping, asked, example_config()).interval, 0ns) << "it has a time of its own";
}

TEST(HeldTo, WhatAHeadHasRecordedIsSentAsItWas) {
  for (const int log2 : {0, 1, 2, 3, 4}) {
    for (const std::uint16_t velocimeter_mode : {0, 1}) {
      PingConfig config = ping_of(2411);
      config.range_compression = static_cast<std::uint16_t>(log2);
      config.sound_speed = 14'805;
      config.velocimeter_mode = velocimeter_mode;
      Bench bench;
      bench.command(config);
      bench.run_for(1s);
      ASSERT_EQ(bench.records.size(), 1U);
      const PingHead then = std::get<PingHead>(decode_report(bench.records[0].wire).value());
      const PingPlan asked = plan_ping(ping_of(100), example_config()).value();
      const PingHead now = held_to(recorded(bench.records[0].settings), asked, example_config()).head;
      EXPECT_TRUE(recorded_form(bench.records[0].settings)->exact);
      EXPECT_EQ(now.line_count(), then.line_count());
      EXPECT_EQ(now.range_compression, then.range_compression);
      EXPECT_EQ(now.sound_speed_used, then.sound_speed_used);
    }
  }
}

std::vector<std::string> texts(const std::vector<Difference>& found) {
  std::vector<std::string> texts;
  std::ranges::transform(found, std::back_inserter(texts), &Difference::text);
  return texts;
}

struct Asked : testing::Test {
  PingPlan asked = plan_ping(ping_of(482), example_config()).value();
  RecordedSettings sent = settings();
  Asked() { asked.job.gain_percent = 50.2; }
  std::vector<std::string> all() const {
    return texts(differences(asked, held_to(recorded(sent), asked, example_config()), sent));
  }
};

TEST_F(Asked, TheSameIsNoDifference) {
  EXPECT_EQ(asked.job.native_bins, 482);
  EXPECT_DOUBLE_EQ(asked.job.native_bin_m, 1500.0 / (2 * 90422.0));
  EXPECT_EQ(asked.job.assumed_sound_speed_mps, 1500.0);
  EXPECT_TRUE(all().empty());
}

TEST_F(Asked, EachKindIsTold) {
  asked.job.native_bins = 2411;
  asked.job.compression_log2 = 2;
  asked.job.gain_percent = 80.0;
  asked.job.assumed_sound_speed_mps = 1480.0;
  asked.job.sixteen_bit = true;
  asked.rle_threshold = 3;
  asked.job.transmit = false;
  EXPECT_EQ(all(), (std::vector<std::string>{
                       "range 20.00 m requested, 4.00 m sent", "compression x4 requested, x1 sent",
                       "gain 80 % requested, 50 % sent", "sound speed 1480.0 m/s requested, 1500.0 m/s sent",
                       "16 bits requested, 8 bits sent", "run lengths requested, all samples sent",
                       "listening only requested, a ping with its echoes sent"}));
}

TEST_F(Asked, AGainThatTheLogDoesNotSayIsNoDifference) {
  asked.job.gain_percent = 80.0;
  sent.gain_percent = -1.0;
  EXPECT_TRUE(all().empty());
}

}  // namespace
}  // namespace sonard::gemini
