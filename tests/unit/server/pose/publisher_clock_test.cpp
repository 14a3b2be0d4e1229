// SPDX-License-Identifier: Apache-2.0
// The publisher's time, estimated from its messages.
#include "server/pose/publisher_clock.hpp"

#include <gtest/gtest.h>

#include <random>

namespace sonard::server {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

constexpr milliseconds longest_delay{50};
constexpr std::int64_t millisecond_ns = 1'000'000;

TEST(PublisherClock, SeesThroughAConstantOffset) {
  PublisherClock clock{longest_delay};
  clock.observe(1'000'000'000'000, seconds{5});
  EXPECT_EQ(clock.stamp_at(seconds{5}), 1'000'000'000'000);
  EXPECT_EQ(clock.stamp_at(seconds{7}), 1'002'000'000'000);
  EXPECT_EQ(clock.stamp_at(seconds{4}), 999'000'000'000);
}

TEST(PublisherClock, KeepsJitterOut) {
  // 100 messages per second, a true offset of 2 s, and a delay of 1 ms plus up to 30 ms.
  PublisherClock clock{longest_delay};
  std::mt19937 random{1};
  for (int i = 0; i < 1000; ++i) {
    const nanoseconds sent = milliseconds{10 * i};
    const milliseconds jitter{random() % 30};
    clock.observe(sent.count(), sent + seconds{2} + milliseconds{1} + jitter);
    if (i > 100) {
      // The smallest of 100 delays is almost certainly below 3 ms.
      EXPECT_NEAR(static_cast<double>(clock.stamp_at(sent + seconds{2}) - sent.count()), -2e6, 1e6) << i;
    }
  }
}

TEST(PublisherClock, FollowsAFastClock) {
  // A simulation at twice real time.
  PublisherClock clock{longest_delay};
  for (int i = 0; i < 1000; ++i) {
    const nanoseconds now = milliseconds{10 * i};
    clock.observe(2 * now.count(), now);
    EXPECT_EQ(clock.stamp_at(now), 2 * now.count());
  }
}

TEST(PublisherClock, NeverLagsASlowClockByMoreThanTheLongestDelay) {
  // A simulation at a tenth of real time. After ten seconds the first offset is wrong by nine seconds.
  PublisherClock clock{longest_delay};
  for (int i = 0; i < 1000; ++i) {
    const nanoseconds now = milliseconds{10 * i};
    clock.observe(now.count() / 10, now);
    EXPECT_GE(clock.stamp_at(now), now.count() / 10);
    EXPECT_LE(clock.stamp_at(now), now.count() / 10 + nanoseconds{longest_delay}.count());
  }
}

TEST(PublisherClock, StandsWhileThePublisherIsPausedAndGoesOnAtOnce) {
  PublisherClock clock{longest_delay};
  clock.observe(0, seconds{1});
  for (int i = 0; i < 2000; ++i) {  // 20 s with one stamp
    clock.observe(0, seconds{1} + milliseconds{10 * i});
  }
  EXPECT_LE(clock.stamp_at(seconds{21}), 60 * millisecond_ns);
  clock.observe(10 * millisecond_ns, milliseconds{21'010});
  EXPECT_GE(clock.stamp_at(milliseconds{21'010}), 10 * millisecond_ns);
  EXPECT_LE(clock.stamp_at(milliseconds{21'010}), 60 * millisecond_ns);
}

TEST(PublisherClock, ForgetsAnOldMinimumAfterTwoSeconds) {
  // The delay rises by 20 ms and stays there.
  PublisherClock clock{longest_delay};
  clock.observe(0, nanoseconds{0});
  for (int i = 1; i <= 100; ++i) {
    clock.observe(10 * i * millisecond_ns, milliseconds{10 * i + 20});
  }
  EXPECT_EQ(clock.stamp_at(milliseconds{1020}), 1020 * millisecond_ns) << "the old minimum still stands";
  for (int i = 101; i <= 210; ++i) {
    clock.observe(10 * i * millisecond_ns, milliseconds{10 * i + 20});
  }
  EXPECT_EQ(clock.stamp_at(milliseconds{2120}), 2100 * millisecond_ns);
}

TEST(PublisherClock, ALateMessageDoesNotHoldTheClockBack) {
  PublisherClock clock{longest_delay};
  clock.observe(100 * millisecond_ns, milliseconds{100});
  clock.observe(20 * millisecond_ns, milliseconds{200});  // 180 ms late
  EXPECT_EQ(clock.stamp_at(milliseconds{200}), 200 * millisecond_ns);
}

TEST(PublisherClock, StartsAfreshAfterARestart) {
  PublisherClock clock{longest_delay};
  clock.observe(500'000 * millisecond_ns, seconds{1});
  clock.restart();
  clock.observe(0, seconds{2});
  EXPECT_EQ(clock.stamp_at(seconds{3}), 1000 * millisecond_ns);
}

TEST(PublisherClock, BearsTheEndsOfTime) {
  PublisherClock clock{longest_delay};
  const nanoseconds arrival = std::chrono::hours{24 * 365 * 5};
  for (const std::int64_t stamp : {4'000'000'000'000'000'000, -4'000'000'000'000'000'000}) {
    clock.restart();
    clock.observe(stamp, arrival);
    EXPECT_EQ(clock.stamp_at(arrival), stamp);
  }
}

}  // namespace
}  // namespace sonard::server
