// SPDX-License-Identifier: Apache-2.0
// The shape of an image against the images of a recorded M1200d and the numbers of the protocol page.
#include "protocol/oculus/image_form.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/degree.hpp"

namespace sonard::oculus {
namespace {

constexpr double recorded_speed_mps = 1490.658551265436;

TEST(OculusBearings, AreThoseOfARecordedHead) {
  const auto bearings = bearings_cdeg(256, 30.0);
  ASSERT_EQ(bearings.size(), 256U);
  EXPECT_EQ(bearings.front(), -3000);
  EXPECT_EQ(bearings[127], -11);
  EXPECT_EQ(bearings[128], 11);
  EXPECT_EQ(bearings.back(), 3000);
}

TEST(OculusBearings, HaveExactEndsAndAreSymmetricAndRise) {
  for (const double half : {20.0, 30.0, 35.0, 65.0}) {
    for (const int beams : {256, 512}) {
      const auto bearings = bearings_cdeg(beams, half);
      EXPECT_EQ(bearings.back(), 100 * half);
      for (std::size_t i = 1; i < bearings.size(); ++i) {
        EXPECT_LT(bearings[i - 1], bearings[i]);
        EXPECT_EQ(bearings[i], -bearings[bearings.size() - 1 - i]);
      }
    }
  }
}

// Bearings are truncated towards zero by less than 0.01 degrees.
TEST(OculusBearings, AreEquallySpacedInTheirSine) {
  const auto bearings = bearings_cdeg(512, 65.0);
  for (std::size_t i = 256; i < 511; ++i) {
    const double exact =
        100.0 * std::asin(std::sin(65.0 * degree) * (2.0 * static_cast<double>(i) / 511.0 - 1.0)) / degree;
    EXPECT_LE(bearings[i], exact + 1e-9);
    EXPECT_GT(bearings[i], exact - 1.0);
  }
}

TEST(OculusRanges, AreThoseOfARecordedHead) {
  const RangeGrid grid = range_grid(2.0, recorded_speed_mps);
  EXPECT_EQ(grid.ranges, 703);
  EXPECT_NEAR(grid.resolution_m, 0.00284218897, 1e-11);
}

TEST(OculusRanges, KeepBelowTheMostAndWithinARowOfWhatWasAsked) {
  for (const double range_m : {0.1, 0.5, 3.4, 3.42, 5.0, 10.0, 40.0, 119.9, 120.0}) {
    const RangeGrid grid = range_grid(range_m, 1500.0);
    const double samples = grid.resolution_m / (1500.0 / (2.0 * sample_rate_hz));
    EXPECT_NEAR(samples, std::round(samples), 1e-9);
    EXPECT_LE(grid.ranges, 1200);
    EXPECT_LE(grid.ranges * grid.resolution_m, range_m);
    EXPECT_GT((grid.ranges + 1) * grid.resolution_m, range_m);
    if (samples > 1.5) {  // with one sample less there would be too many rows
      EXPECT_GT(std::floor(range_m / (grid.resolution_m * (samples - 1.0) / samples)), 1200.0);
    }
  }
}

TEST(OculusGamma, TwoPointsAreDocumented) {
  EXPECT_EQ(gamma_exponent(0), 1.0);
  EXPECT_EQ(gamma_exponent(255), 1.0);
  EXPECT_NEAR(gamma_exponent(127), 0.5, 0.002);
}

TEST(OculusGain, IsReportedInAnotherScaleInTheHighFrequencyMode) {
  Fire fire;
  fire.gain_percent = 50.0;
  fire.master_mode = 1;
  EXPECT_EQ(reported_gain_percent(fire), 50.0);
  fire.master_mode = 2;
  EXPECT_EQ(reported_gain_percent(fire), 70.0);
}

TEST(OculusSoundSpeed, OfFreshAndSaltWater) {
  EXPECT_NEAR(sound_speed_of_water_mps(23.0, 0.0), 1490.66, 0.2);
  EXPECT_NEAR(sound_speed_of_water_mps(10.0, 35.0), 1490.0, 0.5);
}

TEST(OculusImageOffset, Is2048UpTo512Beams) {
  for (const bool second : {false, true}) {
    EXPECT_EQ(usual_image_offset(second, 256), 2048U);
    EXPECT_EQ(usual_image_offset(second, 512), 2048U);
  }
  EXPECT_EQ(usual_image_offset(false, 964), 4096U);
}

}  // namespace
}  // namespace sonard::oculus
