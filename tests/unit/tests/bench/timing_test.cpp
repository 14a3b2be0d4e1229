// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/timing.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace sonard::bench {
namespace {

Timing of(std::initializer_list<double> durations) {
  Timing timing;
  for (const double duration : durations) {
    timing.add(duration);
  }
  return timing;
}

TEST(Timing, MedianIsTheMiddleOne) {
  EXPECT_EQ(of({9, 1, 5}).median(), 5);
  EXPECT_EQ(of({9, 1, 5, 6}).median(), 5.5);
  EXPECT_EQ(of({7}).median(), 7);
  EXPECT_TRUE(std::isnan(Timing{}.median()));
}

TEST(Timing, P95LeavesOneInTwentyAbove) {
  Timing timing;
  for (int i = 100; i >= 1; --i) {
    timing.add(i);
  }
  EXPECT_EQ(timing.p95(), 95);
  EXPECT_EQ(timing.min(), 1);
  EXPECT_EQ(of({1, 2, 3}).p95(), 3);
  EXPECT_TRUE(std::isnan(Timing{}.p95()));
}

TEST(Repetition, EndsWithTheBudgetButNotBeforeTheFewest) {
  const Repetition repetition{3, 10, 5};
  const double long_ago = now_s() - 100;
  EXPECT_TRUE(repetition.wants_more(2, long_ago));
  EXPECT_FALSE(repetition.wants_more(3, long_ago));
  EXPECT_TRUE(repetition.wants_more(9, now_s()));
  EXPECT_FALSE(repetition.wants_more(10, now_s()));
}

}  // namespace
}  // namespace sonard::bench
