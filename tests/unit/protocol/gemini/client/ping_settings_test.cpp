// SPDX-License-Identifier: Apache-2.0
// The expected values are the worked example of protocol/gemini/README.md 10 and values seen from a later
// library (tests/data/gemini/messages.json).
#include "protocol/gemini/ping_settings.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "protocol/gemini/codec.hpp"

namespace sonard::gemini {
namespace {

TEST(PingSettings, FourMetresGiveTheWorkedExample) {
  PingSettings settings;
  settings.range_m = 4.0;
  settings.gain_percent = 50.0;
  settings.sound_speed_mps = 1499.2;
  PingConfig config = make_ping_config(settings);
  config.header.sonar_id = 601;
  const std::vector<std::uint8_t> expected{
      0x21, 0x01, 0x59, 0x02, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00,  //
      0x00, 0x00, 0x04, 0x02, 0x00, 0x00, 0xe3, 0x01, 0x40, 0x0d, 0x03, 0x00, 0x04, 0x00, 0x00, 0x00,  //
      0xe8, 0x83, 0x00, 0x00, 0x00, 0x1e, 0x00, 0x00, 0x43, 0x00, 0x00, 0x00, 0x07, 0x00, 0x01, 0x00,  //
      0x90, 0x3a, 0x01, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x01, 0x1d, 0x00, 0x00,  //
      0x01, 0x12, 0x1e, 0x11};
  EXPECT_EQ(encode(Command{config}), expected);
}

struct ByRange {
  double range_m;
  double sound_speed_mps;
  int end_range;
};

class RangeBins : public testing::TestWithParam<ByRange> {};

TEST_P(RangeBins, AreThoseSeenOnTheWire) {
  PingSettings settings;
  settings.range_m = GetParam().range_m;
  settings.sound_speed_mps = GetParam().sound_speed_mps;
  EXPECT_EQ(make_ping_config(settings).end_range, GetParam().end_range);
}

INSTANTIATE_TEST_SUITE_P(Observed, RangeBins,
                         testing::Values(ByRange{1, 1500, 121}, ByRange{5, 1500, 603},
                                         ByRange{10, 1500, 1206}, ByRange{30, 1500, 3617},
                                         ByRange{50, 1500, 6028}, ByRange{75, 1500, 9042},
                                         ByRange{120, 1500, 14468}, ByRange{10, 1450, 1247},
                                         ByRange{0.1, 1500, 32},       // never below 32
                                         ByRange{400, 1500, 18084}));  // 150 m is the limit

TEST(PingSettings, PulseAndFilterFollowTheRange) {
  struct Row {
    double range_m;
    int tx_length;
    int filter_bank;
  };
  for (const Row& row : {Row{5, 4, 7}, Row{10, 4, 6}, Row{20, 11, 4}, Row{30, 18, 2}, Row{50, 32, 0},
                         Row{75, 80, 0}, Row{120, 128, 0}}) {
    PingSettings settings;
    settings.range_m = row.range_m;
    const PingConfig config = make_ping_config(settings);
    EXPECT_EQ(config.tx_length, row.tx_length) << row.range_m << " m";
    EXPECT_EQ(config.filter_bank, row.filter_bank) << row.range_m << " m";
  }
}

TEST(PingSettings, SixteenBitStopsAtTenThousandLines) {
  PingSettings settings;
  settings.range_m = 120.0;
  settings.sixteen_bit = true;
  const PingConfig config = make_ping_config(settings);
  EXPECT_EQ(config.end_range, 10'000);
  EXPECT_FALSE(config.eight_bit());
  EXPECT_TRUE(config.pings_out_of_water());
}

TEST(PingSettings, AnIntervalMeansContinuous) {
  PingSettings settings;
  EXPECT_EQ(make_ping_config(settings).mode(), RunMode::single);
  settings.interval = std::chrono::milliseconds{250};
  EXPECT_EQ(make_ping_config(settings).mode(), RunMode::continuous);
  EXPECT_EQ(make_ping_config(settings).interping_us, 250'000U);
}

}  // namespace
}  // namespace sonard::gemini
