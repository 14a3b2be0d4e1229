// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/targets.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace sonard::bench {
namespace {

constexpr Quality good{0.009, 0.002, 0.1, 0, 5e-4};

TargetRow ping_row(std::optional<double> ms, std::optional<Quality> quality) {
  return {"a ping", 4, 1.5, false, ms, 0.01, quality};
}

TEST(Verdict, NeedsTimeAndImage) {
  EXPECT_EQ(ping_row(std::nullopt, good).verdict(), Verdict::not_measured);
  EXPECT_EQ(ping_row(4.1, good).verdict(), Verdict::missed);
  EXPECT_EQ(ping_row(4.0, good).verdict(), Verdict::must_met);
  EXPECT_EQ(ping_row(1.5, good).verdict(), Verdict::aim_met);
  EXPECT_EQ(ping_row(1.0, std::nullopt).verdict(), Verdict::error_unknown);
  Quality poor = good;
  poor.bin_rms = 0.011;
  EXPECT_EQ(ping_row(1.0, poor).verdict(), Verdict::error_too_high);
}

TEST(Verdict, EveryPartOfTheImageCounts) {
  EXPECT_TRUE(keeps(good, 0.01));
  const auto broken = [](auto change) {
    Quality quality = good;
    change(quality);
    return !keeps(quality, 0.01);
  };
  EXPECT_TRUE(broken([](Quality& q) { q.bin_rms = 0.0101; }));
  EXPECT_TRUE(broken([](Quality& q) { q.first_echo_bins = 0.51; }));
  EXPECT_TRUE(broken([](Quality& q) { q.hole_fraction = 1e-6; }));
  EXPECT_TRUE(broken([](Quality& q) { q.hole_fraction_60db = 1.1e-3; }));
  EXPECT_TRUE(broken([](Quality& q) { q.hole_fraction = NAN; }));
}

TEST(Verdict, MoreCanBeBetter) {
  const TargetRow row{"a ratio", 50, 250, true, 60, std::nullopt, std::nullopt};
  EXPECT_EQ(row.verdict(), Verdict::must_met);
  EXPECT_EQ((TargetRow{"a ratio", 50, 250, true, 250, std::nullopt, std::nullopt}).verdict(),
            Verdict::aim_met);
  EXPECT_EQ((TargetRow{"a ratio", 50, 250, true, 49, std::nullopt, std::nullopt}).verdict(), Verdict::missed);
}

TEST(Verdict, WithoutAnAimTheMustIsAll) {
  EXPECT_EQ((TargetRow{"a count", 0, std::nullopt, false, 0, std::nullopt, std::nullopt}).verdict(),
            Verdict::must_met);
}

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

const TargetRow& row_named(const std::vector<TargetRow>& rows, std::string_view what) {
  return *std::find_if(rows.begin(), rows.end(), [&](const TargetRow& row) { return row.what == what; });
}

TEST(Targets, NothingMeasuredIsNothingMet) {
  for (const TargetRow& row : target_rows(Measurements{}, "cpu")) {
    EXPECT_EQ(row.verdict(), Verdict::not_measured) << row.what;
  }
}

TEST(Targets, AreReadFromTheMeasurementsOfTheirEngine) {
  Measurements m;
  m.add({"swell1m", "cpu", "default"}, "ping_ms", 9, "ms");
  m.add({"swell100k", "cpu", "default"}, "ping_ms", 6, "ms");
  m.add({"swell100k", "cpu", "point_8x1024"}, "ping_ms", 60, "ms");
  m.add({"swell100k", "gpu", "default"}, "ping_ms", 60, "ms");
  m.add({"swell100k", "cpu", "default"}, "bin_rms", 0.009, "1");
  m.add({"swell100k", "cpu", "default"}, "bin_rms_trim", 0.004, "1");
  m.add({"swell100k", "cpu", "default"}, "first_echo_bins", 0.2, "bins");
  m.add({"swell100k", "cpu", "default"}, "hole_fraction", 0, "1");
  m.add({"swell100k", "cpu", "default"}, "hole_fraction_60db", 0, "1");
  m.add({"swell100k", "cpu", "default"}, "samples", 1e5, "count");
  m.add({"swell100k", "cpu", "point_1x1"}, "bin_rms", 0.09, "1");
  m.add({"swell100k", "cpu", "point_1x1"}, "samples", 1e6, "count");
  m.add({"swell100k", "cpu", "point_2x1"}, "bin_rms", 0.045, "1");
  m.add({"swell100k", "cpu", "point_2x1"}, "samples", 2e6, "count");
  const std::vector<TargetRow> rows = target_rows(m, "cpu");
  EXPECT_NEAR(*row_named(rows, "swell1m / swell100k, default").measured, 1.5, 1e-12);
  const TargetRow& ping = row_named(rows, "default swell100k, % of points");
  EXPECT_EQ(ping.ms, 6);
  EXPECT_NEAR(*ping.measured, 10, 1e-12);
  EXPECT_NEAR(ping.must, 20, 1e-12) << "15 of 75 ms";
  EXPECT_EQ(ping.verdict(), Verdict::aim_met);
  // First order: .009 needs 1e7 points, a hundred times as many.
  EXPECT_NEAR(*row_named(rows, "samples at equal error, points / default, swell100k").measured, 100, 1e-6);
  EXPECT_EQ(row_named(target_rows(m, "gpu"), "default swell100k, % of points").verdict(), Verdict::missed);
}

TEST(Targets, ARepetitionThatDiffersIsAMiss) {
  Measurements m;
  m.add({"plane", "cpu", "default"}, "repeatable", 1, "1");
  EXPECT_EQ(row_named(target_rows(m, "cpu"), "points that differ when repeated").verdict(),
            Verdict::must_met);
  m.add({"plane", "cpu", "fast"}, "repeatable", 0, "1");
  EXPECT_EQ(row_named(target_rows(m, "cpu"), "points that differ when repeated").verdict(), Verdict::missed);
}

TEST(Targets, ThePrintedTableNamesVerdictAndError) {
  Measurements m;
  m.add({"flat100k", "cpu", "default"}, "ping_ms", 2, "ms");
  m.add({"flat100k", "cpu", "default"}, "bin_rms", 0.02, "1");
  m.add({"swell100k", "cpu", "point_8x1024"}, "ping_ms", 75, "ms");
  const std::string text = format_targets(target_rows(m, "cpu"));
  EXPECT_NE(text.find("MISSED: error"), std::string::npos) << text;
  EXPECT_NE(text.find("2.00 %"), std::string::npos) << text;
}

}  // namespace
}  // namespace sonard::bench
