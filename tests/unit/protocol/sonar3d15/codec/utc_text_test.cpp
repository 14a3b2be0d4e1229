// SPDX-License-Identifier: Apache-2.0
#include "protocol/sonar3d15/utc_text.hpp"

#include <gtest/gtest.h>

namespace sonard::sonar3d15 {
namespace {

using namespace std::chrono_literals;
constexpr std::chrono::nanoseconds new_year = 1'767'225'600s;  // 2026-01-01T00:00:00Z

TEST(UtcText, IsAsInRfc3339) {
  EXPECT_EQ(utc_text(new_year + 250ms), "2026-01-01T00:00:00.250000Z");
  EXPECT_EQ(utc_text(-1us), "1969-12-31T23:59:59.999999Z");
}

TEST(UtcText, IsReadWithAnyFractionAndOffset) {
  EXPECT_EQ(parse_utc("2026-01-01T00:00:00Z"), new_year);
  EXPECT_EQ(parse_utc("2026-01-01t00:00:00.25z"), new_year + 250ms);
  EXPECT_EQ(parse_utc("2026-01-01T00:00:00.123456789Z"), new_year + 123'456'789ns);
  EXPECT_EQ(parse_utc("2026-01-01T01:30:00+01:30"), new_year);
  EXPECT_EQ(parse_utc("2025-12-31T19:00:00.5-05:00"), new_year + 500ms);
  EXPECT_EQ(parse_utc(utc_text(new_year + 1us)), new_year + 1us);
}

TEST(UtcText, OtherTextIsNoTime) {
  for (const char* text :
       {"", "now", "2026-01-01", "2026-01-01T00:00:00", "2026-02-30T00:00:00Z", "2026-13-01T00:00:00Z",
        "2026-01-01T24:00:00Z", "2026-01-01T00:60:00Z", "1969-12-31T23:59:59Z", "2200-01-01T00:00:00Z",
        "2026-01-01T00:00:00.Z", "2026-01-01T00:00:00.1234567890Z", "2026-01-01T00:00:00+1:00",
        " 2026-01-01T00:00:00Z"}) {
    EXPECT_EQ(parse_utc(text), std::nullopt) << text;
  }
  EXPECT_EQ(parse_utc(std::string(100'000, '1')), std::nullopt);
}

}  // namespace
}  // namespace sonard::sonar3d15
