// SPDX-License-Identifier: Apache-2.0
// Bearings against the values printed in protocol/gemini/README.md 6.5.
#include "protocol/gemini/bearings.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace sonard::gemini {
namespace {

/// The printed radians come from a single-precision table. Half a unit in the last place at 1.04 rad.
constexpr double single_precision = 6e-8;

double degrees(double radians) {
  return radians * 180.0 / std::numbers::pi;
}

TEST(Bearings, PrintedDegrees) {
  constexpr double half_of_last_digit = 0.0005;
  EXPECT_NEAR(degrees(bearing_rad(0)), -59.615, half_of_last_digit);
  EXPECT_NEAR(degrees(bearing_rad(1)), -58.857, half_of_last_digit);
  EXPECT_NEAR(degrees(bearing_rad(2)), -58.115, half_of_last_digit);
  EXPECT_NEAR(degrees(bearing_rad(127)), -0.194, half_of_last_digit);
  EXPECT_NEAR(degrees(bearing_rad(128)), +0.194, half_of_last_digit);
  EXPECT_NEAR(degrees(bearing_rad(255)), +59.615, half_of_last_digit);
}

TEST(Bearings, PrintedRadians) {
  EXPECT_NEAR(bearing_rad(0), -1.040470839, single_precision);
  EXPECT_NEAR(bearing_rad(127), -0.003382918, 5e-10);
  EXPECT_NEAR(bearing_rad(128), +0.003382918, 5e-10);
}

TEST(Bearings, TableRisesFromPortToStarboardAndMirrors) {
  const auto bearings = bearings_rad();
  ASSERT_EQ(bearings.size(), 256U);
  EXPECT_NEAR(bearings.front(), -1.040470839, single_precision);
  for (std::size_t beam = 1; beam < bearings.size(); ++beam) {
    EXPECT_GT(bearings[beam], bearings[beam - 1]);
    EXPECT_NEAR(bearings[beam], -bearings[255 - beam], 1e-15);
  }
}

TEST(Bearings, EdgesSpanTheSectorInEqualStepsOfTheSine) {
  const auto edges = beam_edges_sin();
  ASSERT_EQ(edges.size(), 257U);
  EXPECT_NEAR(degrees(std::asin(edges.front())), -60.0, 1e-12);
  EXPECT_NEAR(edges[128], 0.0, 1e-15);
  EXPECT_NEAR(degrees(std::asin(edges.back())), +60.0, 1e-12);
  for (std::size_t beam = 0; beam + 1 < edges.size(); ++beam) {
    EXPECT_NEAR(edges[beam + 1] - edges[beam], 2 * 0.8660254037844386 / 256, 1e-15);
    EXPECT_NEAR((edges[beam] + edges[beam + 1]) / 2, std::sin(bearing_rad(static_cast<int>(beam))), 1e-12);
  }
}

}  // namespace
}  // namespace sonard::gemini
