// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/quick_table.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/bench/demo_ping.hpp"

namespace sonard::bench {
namespace {

TEST(SamplesNeeded, FollowsThePowerLaw) {
  // error = 100 / samples: 1e-3 needs 1e5.
  const std::vector<SamplesAndError> first_order{{1e4, 1e-2}, {1e3, 1e-1}, {1e2, 1}};
  EXPECT_NEAR(*samples_needed(first_order, 1e-3), 1e5, 1);                        // beyond the last
  EXPECT_NEAR(*samples_needed(first_order, std::sqrt(1e-3)), std::sqrt(1e7), 1);  // between two
  EXPECT_NEAR(*samples_needed(first_order, 10), 10, 1e-6);                        // before the first
}

TEST(SamplesNeeded, UsesTheSlopeWhereTheErrorLies) {
  // First order down to .01, then half order: from 1e4 on, a hundredth of the error needs ten thousand times
  // the samples.
  const std::vector<SamplesAndError> curve{{1e3, 1e-1}, {1e4, 1e-2}, {1e6, 1e-3}};
  EXPECT_NEAR(*samples_needed(curve, 1e-4), 1e8, 1e3);
  EXPECT_NEAR(*samples_needed(curve, 0.05), 2e3, 1);
}

TEST(SamplesNeeded, IsUnknownWithoutACurveThatFalls) {
  EXPECT_FALSE(samples_needed({}, 0.01));
  EXPECT_FALSE(samples_needed({{1e3, 0.1}}, 0.01));
  EXPECT_FALSE(samples_needed({{1e3, 0.1}, {1e4, 0.2}}, 0.01));
}

const QuickRow& row_named(const std::vector<QuickRow>& rows, std::string_view what) {
  return *std::find_if(rows.begin(), rows.end(), [&](const QuickRow& row) { return row.what == what; });
}

TEST(QuickTable, IsEmptyIfNothingWasMeasured) {
  EXPECT_EQ(format_quick(quick_rows(Measurements{}, "cpu")), "");
}

TEST(QuickTable, ReadsTheMeasurementsOfItsEngine) {
  Measurements m;
  m.add({"swell1m", "cpu", "default"}, "ping_ms", 9, "ms");
  m.add({"swell100k", "cpu", "default"}, "ping_ms", 6, "ms");
  m.add({"swell100k", "cpu", "point_8x1024"}, "ping_ms", 60, "ms");
  m.add({"swell100k", "gpu", "default"}, "ping_ms", 30, "ms");
  m.add({"swell100k", "cpu", "default"}, "bin_rms", 0.009, "1");
  m.add({"swell100k", "cpu", "default"}, "samples", 1e5, "count");
  m.add({"swell100k", "cpu", "point_1x1"}, "bin_rms", 0.09, "1");
  m.add({"swell100k", "cpu", "point_1x1"}, "samples", 1e6, "count");
  m.add({"swell100k", "cpu", "point_2x1"}, "bin_rms", 0.045, "1");
  m.add({"swell100k", "cpu", "point_2x1"}, "samples", 2e6, "count");
  m.add(demo_ping, "ping_ms", 12, "ms");
  const std::vector<QuickRow> rows = quick_rows(m, "cpu");
  EXPECT_NEAR(*row_named(rows, "swell1m / swell100k, default").ratio, 1.5, 1e-12);
  EXPECT_EQ(row_named(rows, "swell100k, default").ms, 6);
  EXPECT_NEAR(*row_named(rows, "swell100k, default").percent_of_points, 10, 1e-12);
  EXPECT_NEAR(*row_named(rows, "demo ping, all stages, as served").percent_of_points, 20, 1e-12);
  // First order: .009 needs 1e7 points, a hundred times as many.
  EXPECT_NEAR(*row_named(rows, "samples at equal error, points / default, swell100k").ratio, 100, 1e-6);
  EXPECT_NEAR(*row_named(quick_rows(m, "gpu"), "swell100k, default").percent_of_points, 50, 1e-12);
}

TEST(QuickTable, CountsPointsThatDifferWhenRepeated) {
  Measurements m;
  m.add({"plane", "cpu", "default"}, "repeatable", 1, "1");
  EXPECT_EQ(row_named(quick_rows(m, "cpu"), "points that differ when repeated").ratio, 0);
  m.add({"plane", "cpu", "fast"}, "repeatable", 0, "1");
  EXPECT_EQ(row_named(quick_rows(m, "cpu"), "points that differ when repeated").ratio, 1);
}

TEST(QuickTable, PrintsThePromiseBesideTheError) {
  Measurements m;
  m.add({"flat100k", "cpu", "default"}, "ping_ms", 2, "ms");
  m.add({"flat100k", "cpu", "default"}, "bin_rms", 0.02, "1");
  m.add({"flat100k", "cpu", "fast"}, "ping_ms", 1, "ms");
  m.add({"flat100k", "cpu", "fast"}, "bin_rms", 0.05, "1");
  const std::string text = format_quick(quick_rows(m, "cpu"));
  EXPECT_NE(text.find("1 %: BROKEN"), std::string::npos) << text;
  EXPECT_NE(text.find("5 %: kept"), std::string::npos) << text;
}

}  // namespace
}  // namespace sonard::bench
