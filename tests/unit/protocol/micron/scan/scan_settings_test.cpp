// SPDX-License-Identifier: Apache-2.0
// Scan settings as fields on the wire (protocol/micron/README.md 4, 5.3, 5.4).
#include "protocol/micron/scan_settings.hpp"

#include <gtest/gtest.h>

namespace sonard::micron {
namespace {

TEST(ScanSettings, IntervalsAreCutOffAsMostDriversDo) {
  // 2 * 10 m / (1500 m/s * 200) / 640 ns = 104.17. 75 m in 500 bins is 312.5; rounding would give 313.
  EXPECT_EQ(ad_interval({.range_m = 10.0, .bins = 200}), 104);
  EXPECT_EQ(ad_interval({.range_m = 10.0, .bins = 400}), 52);
  EXPECT_EQ(ad_interval({.range_m = 75.0, .bins = 500}), 312);
  EXPECT_EQ(ad_interval({.range_m = 10.0, .bins = 400, .sound_speed_mps = 1450.0}), 53);
}

TEST(ScanSettings, ARangeThatWasCoveredIsCoveredAgain) {
  for (int interval = 1; interval < 3000; ++interval) {
    ScanSettings settings;
    settings.bins = 371;
    settings.sound_speed_mps = 1483.0;
    settings.range_m = 371 * interval * 640e-9 * 1483.0 / 2.0;
    ASSERT_EQ(ad_interval(settings), interval);
  }
}

TEST(ScanSettings, CoversWhatTheIntervalSaysNotWhatWasAskedFor) {
  const ScanSettings settings{.range_m = 10.0, .bins = 400};
  EXPECT_NEAR(bin_length_m(settings), 52 * 0.00048, 1e-12);
  EXPECT_NEAR(covered_range_m(settings), 9.984, 1e-9);
}

TEST(ScanSettings, AllRoundIsTheCommandOfCommonDrivers) {
  const HeadCommand command = make_head_command({});
  EXPECT_EQ(command.control, 0x2307);
  EXPECT_EQ(command.range_scale, 100);
  EXPECT_EQ(command.gain[0], 105);
  EXPECT_EQ(command.step, 32);
  EXPECT_EQ(command.ad_interval, 52);
  EXPECT_EQ(command.bins, 400);
}

TEST(ScanSettings, ASectorTurnsBetweenItsLimits) {
  const HeadCommand command =
      make_head_command({.sector = ScanSector{2400, 4000}, .clockwise = false, .eight_bit = false});
  EXPECT_EQ(command.control, 0x2300);
  EXPECT_EQ(command.left_limit, 2400);
  EXPECT_EQ(command.right_limit, 4000);
}

TEST(ScanSettings, DecibelsArePartsOf80) {
  const HeadCommand command =
      make_head_command({.gain_percent = 40.0, .ad_low_db = 12.5, .ad_span_db = 25.1});
  EXPECT_EQ(command.gain[0], 84);
  EXPECT_EQ(command.ad_low, 40);   // 39.8
  EXPECT_EQ(command.ad_span, 80);  // 80.0
}

TEST(ScanSettings, BearingsAreDegreesFromAhead) {
  EXPECT_DOUBLE_EQ(bearing_deg(3200), 0.0);
  EXPECT_DOUBLE_EQ(bearing_deg(4800), 90.0);
  EXPECT_DOUBLE_EQ(bearing_deg(1600), -90.0);
  EXPECT_DOUBLE_EQ(bearing_deg(0), -180.0);
}

}  // namespace
}  // namespace sonard::micron
