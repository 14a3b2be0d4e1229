// SPDX-License-Identifier: Apache-2.0
// Wire units (protocol/micron/README.md 4).
#include "protocol/micron/units.hpp"

#include <gtest/gtest.h>

namespace sonard::micron {
namespace {

TEST(Units, BearingsAreClockwiseFromAstern) {
  constexpr double quarter = std::numbers::pi / 2;
  EXPECT_DOUBLE_EQ(bearing_rad(3200), 0.0);
  EXPECT_DOUBLE_EQ(bearing_rad(4800), quarter) << "starboard";
  EXPECT_DOUBLE_EQ(bearing_rad(1600), -quarter) << "port";
  EXPECT_DOUBLE_EQ(bearing_rad(0), -2 * quarter) << "astern";
  EXPECT_DOUBLE_EQ(bearing_rad(6400), -2 * quarter);
  EXPECT_NEAR(bearing_rad(3201) * 180.0 / std::numbers::pi, 0.05625, 1e-12);
}

TEST(Units, TurnsTakeTheShortWay) {
  EXPECT_EQ(shortest_turn(6300, 100), 200);
  EXPECT_EQ(shortest_turn(100, 6300), -200);
  EXPECT_EQ(shortest_turn(0, 3200), 3200);
  EXPECT_EQ(shortest_turn(0, 3201), -3199);
  EXPECT_EQ(wrapped(-1), 6399);
  EXPECT_EQ(wrapped(6400), 0);
}

TEST(Units, LevelsAndGains) {
  EXPECT_DOUBLE_EQ(gain_db(210), 80.0);
  EXPECT_DOUBLE_EQ(gain_db(84), 32.0);
  EXPECT_DOUBLE_EQ(level_db(255), 80.0);
  EXPECT_NEAR(level_db(81), 25.4, 0.02);
  EXPECT_NEAR(level_db(8), 2.5, 0.02);
}

}  // namespace
}  // namespace sonard::micron
