// SPDX-License-Identifier: Apache-2.0
#include "protocol/dvl_a50/utc.hpp"

#include <gtest/gtest.h>

namespace sonard::dvl_a50 {
namespace {

TEST(DvlUtc, TextsOfTimesReadBack) {
  EXPECT_EQ(rfc3339(1767225600'250000), "2026-01-01T00:00:00.250000Z");
  for (const std::int64_t time_us :
       {std::int64_t{0}, std::int64_t{1709210096'000007}, std::int64_t{4000000000'999999}}) {
    EXPECT_EQ(parse_rfc3339(rfc3339(time_us)), time_us);
  }
}

TEST(DvlUtc, OffsetsAndFractions) {
  EXPECT_EQ(parse_rfc3339("2026-01-01T02:00:00.5+02:00"), 1767225600'500000);
  EXPECT_EQ(parse_rfc3339("2025-12-31t19:30:00-04:30"), 1767225600'000000);
  EXPECT_EQ(parse_rfc3339("2026-01-01T00:00:00.123456789Z"), 1767225600'123456);
}

TEST(DvlUtc, WhatIsNoTime) {
  for (const char* const text : {"", "2026", "2026-01-01", "2026-02-30T00:00:00Z", "2026-01-01T24:00:00Z",
                                 "2026-01-01T00:00:00", "2026-01-01T00:00:00+2:00", "2026-01-01T00:00:00Zx",
                                 "20x6-01-01T00:00:00Z", "2026-13-01T00:00:00Z", "2026-01-01T00:00:00."}) {
    EXPECT_FALSE(parse_rfc3339(text)) << text;
  }
}

}  // namespace
}  // namespace sonard::dvl_a50
