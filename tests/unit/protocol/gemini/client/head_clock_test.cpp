// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/head_clock.hpp"

#include <gtest/gtest.h>

#include "protocol/gemini/response_time.hpp"

namespace sonard::gemini {
namespace {

using namespace std::chrono_literals;

TEST(HeadClock, KnowsNothingWithoutAStamp) {
  EXPECT_EQ(HeadClock{}.at_least_us(10s), 0U);
}

TEST(HeadClock, NeverClaimsMoreThanTheHeadShows) {
  // The head was started when the client's clock showed 100 s; stamps arrive up to 30 ms late.
  constexpr std::chrono::nanoseconds start = 100s;
  HeadClock clock;
  for (int i = 0; i < 20; ++i) {
    const auto sent = start + i * 500ms;
    clock.observe(sent + (i % 4) * 10ms, static_cast<std::uint64_t>((sent - start) / 1us));
  }
  const auto now = start + 10s;
  const auto estimate = std::chrono::microseconds{clock.at_least_us(now)};
  EXPECT_LE(estimate, 10s);
  EXPECT_GE(estimate, 10s - 2ms);  // 2 ms of slack; some of the newest stamps arrived without delay
}

TEST(HeadClock, ForgetsWhenTheHeadIsStartedAgain) {
  HeadClock clock;
  clock.observe(10s, 500'000'000);
  clock.forget();
  EXPECT_EQ(clock.at_least_us(11s), 0U);
  clock.observe(12s, 0);
  EXPECT_EQ(clock.at_least_us(13s), 998'000U);
}

TEST(ResponseTime, StaysWithinItsLimits) {
  ResponseTime time({100ms, 10ms, 200ms});
  EXPECT_EQ(time.patience(), 100ms);
  for (int i = 0; i < 50; ++i) {
    time.sample(1ms);
  }
  EXPECT_EQ(time.patience(), 10ms);
  for (int i = 0; i < 50; ++i) {
    time.sample(1s);
  }
  EXPECT_EQ(time.patience(), 200ms);
}

TEST(ResponseTime, LeavesRoomForScatter) {
  ResponseTime time({1s, 1ms, 1s});
  time.sample(40ms);
  EXPECT_EQ(time.patience(), 120ms);  // RFC 6298 (2.2): mean + 4 * mean / 2
}

}  // namespace
}  // namespace sonard::gemini
