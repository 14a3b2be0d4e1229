// SPDX-License-Identifier: Apache-2.0
// The clock of logs against dates from `date -u -d @...` (protocol/glf/README.md 1.6).
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "protocol/glf/log_time.hpp"

namespace sonard::glf {
namespace {

constexpr std::int64_t epoch_ns = 315'532'800'000'000'000;       // 1980-01-01 00:00:00 UTC
constexpr std::int64_t november_ns = 1'795'184'553'250'000'000;  // 2026-11-20 14:22:33.25 UTC

TEST(LogTime, CountsFrom1980InLocalTime) {
  EXPECT_EQ(glf_time_s(epoch_ns, 0), 0.0);
  EXPECT_EQ(glf_time_s(epoch_ns, 3600), 3600.0);
  EXPECT_EQ(glf_time_s(epoch_ns, -5 * 3600), -18000.0);
  EXPECT_EQ(glf_time_s(november_ns, 0), 1'479'651'753.25);
  EXPECT_EQ(glf_time_s(november_ns, 7200), 1'479'658'953.25);
}

TEST(LogTime, ComesBackToAQuarterOfAMicrosecond) {
  for (const std::int32_t offset_s : {0, 3600, -12'600, 50'400}) {
    for (std::int64_t ns = november_ns; ns < november_ns + 1'000'000'000; ns += 12'345'677) {
      const auto back = unix_ns(glf_time_s(ns, offset_s), offset_s);
      ASSERT_TRUE(back);
      EXPECT_LE(std::abs(*back - ns), 250);
    }
  }
  EXPECT_EQ(unix_ns(0.0, 3600), epoch_ns - 3'600'000'000'000);
  EXPECT_EQ(unix_ns(-0.5, 0), epoch_ns - 500'000'000);
}

TEST(LogTime, WhatIsNoTimeIsNone) {
  EXPECT_FALSE(unix_ns(std::numeric_limits<double>::quiet_NaN(), 0));
  EXPECT_FALSE(unix_ns(std::numeric_limits<double>::infinity(), 0));
  EXPECT_FALSE(unix_ns(-1e300, 0));
  EXPECT_FALSE(unix_ns(9e9, 0));
}

TEST(LogTime, NamesSayWhen) {
  const double time_s = glf_time_s(november_ns, 0);
  EXPECT_EQ(log_stamp(time_s), "2026-11-20-142233");
  EXPECT_EQ(log_stamp(glf_time_s(november_ns, 10 * 3600)), "2026-11-21-002233");
  EXPECT_EQ(log_name(log_stamp(time_s)), "log_2026-11-20-142233.glf");
  EXPECT_EQ(dat_name(log_stamp(time_s)), "data_2026-11-20-142233.dat");
  EXPECT_EQ(config_name(log_stamp(time_s)), "log_2026-11-20-142233.cfg");
}

TEST(LogTime, DatesStayWithinWhatAZipCanSay) {
  EXPECT_EQ(civil_time(-5.0), CivilTime{});
  EXPECT_EQ(civil_time(std::numeric_limits<double>::quiet_NaN()), CivilTime{});
  EXPECT_EQ(civil_time(1e300), (CivilTime{2107, 12, 31, 23, 59, 59}));
  EXPECT_EQ(civil_time(5'097'599.9), (CivilTime{1980, 2, 28, 23, 59, 59})) << "of a leap year";
  EXPECT_EQ(civil_time(5'097'600.0), (CivilTime{1980, 2, 29, 0, 0, 0}));
}

}  // namespace
}  // namespace sonard::glf
