// SPDX-License-Identifier: Apache-2.0
// Gain fields to dB (protocol/gemini/README.md 5).
#include "protocol/gemini/gain_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace sonard::gemini {
namespace {

constexpr double epsilon_db = 1e-9;

TEST(GainLaw, MainGainIsBasePlusVariable) {
  EXPECT_NEAR(main_gain_db(1000), 8.0, epsilon_db);
  EXPECT_NEAR(main_gain_db(0), 8.0, epsilon_db);
  EXPECT_NEAR(main_gain_db(0x83E8), 11.0 + 8.0, epsilon_db);  // both libraries at short range
  EXPECT_NEAR(main_gain_db(0xC3E8), 16.5 + 8.0, epsilon_db);  // both libraries beyond it
  EXPECT_NEAR(main_gain_db(3700), 50.0, epsilon_db);
  EXPECT_NEAR(main_gain_db(4095), 50.0, epsilon_db);
  EXPECT_NEAR(main_gain_db(2350), 29.0, epsilon_db);  // half way
  EXPECT_NEAR(main_gain_db(0x4000 | 2350), 29.0 + 5.5, epsilon_db);
}

TEST(GainLaw, EarlyLibraryPercentIsLinearInDecibel) {
  const GainLaw law;
  for (int percent = 10; percent <= 100; percent += 10) {
    const auto spreading = static_cast<std::uint16_t>(500.0 * std::exp((percent - 100) / 25.0));
    // The library truncates the value to an integer. At 10 percent that is up to one unit of about 13.
    EXPECT_NEAR(spreading_gain_db(spreading, law), 0.4 * (percent - 50), 0.8) << percent;
  }
  EXPECT_NEAR(spreading_gain_db(67, law), 0.0, epsilon_db);
}

TEST(GainLaw, RisesFromEndToEndAndIsFlatBeyond) {
  const GainLaw law;
  for (std::uint16_t s = 9; s < 500; ++s) {
    EXPECT_LT(spreading_gain_db(s, law), spreading_gain_db(static_cast<std::uint16_t>(s + 1), law));
  }
  EXPECT_EQ(spreading_gain_db(0, law), spreading_gain_db(9, law));
  EXPECT_EQ(spreading_gain_db(1023, law), spreading_gain_db(500, law));
}

TEST(GainLaw, ReferenceCanBeMovedToLaterLibraries) {
  GainLaw law;
  EXPECT_NEAR(spreading_gain_db(213, law), 11.566, 0.001);  // 10 ln(213 / 67)
  law.reference_spreading = 213.0;
  EXPECT_NEAR(receive_gain_db(0xC3E8, 213, law), 0.0, epsilon_db);
  EXPECT_NEAR(receive_gain_db(0x83E8, 213, law), -5.5, epsilon_db);
}

}  // namespace
}  // namespace sonard::gemini
