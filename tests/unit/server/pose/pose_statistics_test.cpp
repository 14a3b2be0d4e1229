// SPDX-License-Identifier: Apache-2.0
// Statistics about received poses, at times set by hand.
#include "server/pose/pose_statistics.hpp"

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr TimePoint start = std::chrono::hours{5};

class PoseStatisticsTest : public testing::Test {
 protected:
  /// Counts a pose with stamp `stamp`, which arrives `later` after the last one.
  void pose(std::chrono::nanoseconds later, std::chrono::nanoseconds stamp, double x_m = 0.0) {
    now_ += later;
    pose::PoseSample sample;
    sample.time_ns = stamp.count();
    sample.T_world_vehicle.position_m.x = x_m;
    statistics_.observe(sample, now_);
  }
  /// Counts one pose every 20 ms, with stamps `step` apart.
  void steady(int count, std::chrono::nanoseconds step) {
    for (int i = 0; i < count; ++i) {
      stamp_ += step;
      pose(milliseconds{20}, stamp_);
    }
  }

  PoseStatistics statistics_{milliseconds{500}};
  TimePoint now_ = start;
  std::chrono::nanoseconds stamp_ = seconds{100};
};

TEST_F(PoseStatisticsTest, KnowsNothingBeforeTheFirstPose) {
  const PoseStatistics::Summary summary = statistics_.take(now_ + seconds{10});
  EXPECT_EQ(summary.poses, 0U);
  EXPECT_EQ(summary.rate_hz, 0.0);
  EXPECT_FALSE(summary.time_rate);
  EXPECT_FALSE(summary.age);
  EXPECT_EQ(summary.gaps, 0U);
  EXPECT_FALSE(statistics_.newest());
  EXPECT_EQ(to_string(summary),
            "poses=0 rate_hz=0.0 time_rate=- age_ms=- longest_gap_ms=0 gaps=0 jumps=0 clock_restarts=0");
}

TEST_F(PoseStatisticsTest, TellsRateAndAge) {
  steady(501, milliseconds{20});
  const PoseStatistics::Summary summary = statistics_.take(now_ + milliseconds{7});
  EXPECT_EQ(summary.poses, 501U);
  EXPECT_NEAR(summary.rate_hz, 50.0, 0.1);
  EXPECT_DOUBLE_EQ(summary.time_rate.value(), 1.0);
  EXPECT_EQ(summary.age, milliseconds{7});
  EXPECT_EQ(summary.longest_gap, milliseconds{20});
  EXPECT_EQ(summary.gaps + summary.jumps + summary.clock_restarts, 0U);
  EXPECT_EQ(
      to_string(summary),
      "poses=501 rate_hz=50.1 time_rate=1.00 age_ms=7 longest_gap_ms=20 gaps=0 jumps=0 clock_restarts=0");
}

TEST_F(PoseStatisticsTest, TellsHowFastSimulatedTimeGoes) {
  steady(50, milliseconds{2});
  EXPECT_DOUBLE_EQ(statistics_.take(now_).time_rate.value(), 0.1);
  steady(50, milliseconds{100});
  EXPECT_DOUBLE_EQ(statistics_.take(now_).time_rate.value(), 5.0);
  steady(50, milliseconds{0});
  EXPECT_DOUBLE_EQ(statistics_.take(now_).time_rate.value(), 0.0);
}

TEST_F(PoseStatisticsTest, CountsGapsOverTheLimit) {
  steady(2, milliseconds{20});
  pose(milliseconds{500}, stamp_ += milliseconds{500});  // equal to the limit, not longer
  pose(milliseconds{501}, stamp_ += milliseconds{501});
  pose(seconds{3}, stamp_ += seconds{3});
  const PoseStatistics::Summary summary = statistics_.take(now_);
  EXPECT_EQ(summary.gaps, 2U);
  EXPECT_EQ(summary.longest_gap, seconds{3});
}

TEST_F(PoseStatisticsTest, CountsTheGapThatIsStillOpen) {
  steady(2, milliseconds{20});
  const PoseStatistics::Summary summary = statistics_.in_all(now_ + seconds{2});
  EXPECT_EQ(summary.gaps, 1U);
  EXPECT_EQ(summary.longest_gap, seconds{2});
  EXPECT_EQ(summary.age, seconds{2});
}

// The limit is 100 m/s, which is 2 m in 20 ms.
TEST_F(PoseStatisticsTest, CountsJumps) {
  pose(milliseconds{20}, seconds{1}, 0.0);
  pose(milliseconds{20}, seconds{1} + milliseconds{20}, 1.9);
  EXPECT_EQ(statistics_.in_all(now_).jumps, 0U);
  pose(milliseconds{20}, seconds{1} + milliseconds{40}, 4.0);
  EXPECT_EQ(statistics_.in_all(now_).jumps, 1U);
  pose(milliseconds{20}, seconds{1} + milliseconds{40}, 4.5);  // another place at the same time
  EXPECT_EQ(statistics_.in_all(now_).jumps, 2U);
}

TEST_F(PoseStatisticsTest, TellsAClockThatBeganAgainFromJumpsAndLateMessages) {
  pose(milliseconds{20}, seconds{60}, 50.0);
  pose(milliseconds{20}, seconds{60} - milliseconds{200}, 50.0);  // late, but no restart
  EXPECT_EQ(statistics_.in_all(now_).clock_restarts, 0U);
  pose(milliseconds{20}, seconds{1}, 0.0);
  const PoseStatistics::Summary summary = statistics_.in_all(now_);
  EXPECT_EQ(summary.clock_restarts, 1U);
  EXPECT_EQ(summary.jumps, 0U);
}

TEST_F(PoseStatisticsTest, BeginsAnewWithEachPeriodAndKeepsTheTotal) {
  steady(100, milliseconds{20});
  pose(seconds{1}, stamp_ += seconds{1}, 500.0);
  EXPECT_EQ(statistics_.take(now_).poses, 101U);
  now_ += seconds{10};
  const PoseStatistics::Summary silent = statistics_.take(now_);
  EXPECT_EQ(silent.poses, 0U);
  EXPECT_EQ(silent.rate_hz, 0.0);
  EXPECT_FALSE(silent.time_rate);
  EXPECT_EQ(silent.age, seconds{10});
  EXPECT_EQ(silent.gaps, 1U);
  EXPECT_EQ(silent.jumps, 0U);
  const PoseStatistics::Summary all = statistics_.in_all(now_);
  EXPECT_EQ(all.poses, 101U);
  EXPECT_EQ(all.jumps, 1U);
  EXPECT_EQ(all.gaps, 2U) << "the one before the last pose, and the one since";
}

}  // namespace
}  // namespace sonard::server
