// SPDX-License-Identifier: Apache-2.0
// Pings that begin when somebody else says so: a simulated time rules.
#include "bench.hpp"

namespace sonard::gemini {
namespace {

DeviceConfig waiting() {
  DeviceConfig config = example_config();
  config.waits_for_permission = true;
  return config;
}

/// Of a ping of `lines` at the rate at which the head listens.
std::chrono::nanoseconds listening_of(int lines) {
  return std::chrono::nanoseconds{static_cast<std::int64_t>(lines / 90422.0 * 1e9)};
}

struct Permission : testing::Test {
  Bench bench{waiting()};

  /// Permits what is wished for by now, as a server does.
  bool permit() {
    const auto wish = bench.device.ping_wish();
    if (!wish || wish->from > bench.now) {
      return false;
    }
    bench.device.permit_ping();
    bench.command(to_head<StatusRequest>());  // any event, so that the head advances
    return true;
  }
};

TEST_F(Permission, NobodyWishesForAPingAtFirst) {
  EXPECT_FALSE(bench.device.ping_wish());
}

TEST_F(Permission, NothingIsSentWithoutIt) {
  bench.command(ping_of(64, RunMode::continuous));
  bench.run_connected(5s);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_TRUE(bench.ping_datagrams().empty());
  EXPECT_GE(bench.count(MessageType::status), 5U) << "the head lives on in its own time";
  EXPECT_TRUE(bench.device.ping_wish());
}

TEST_F(Permission, TheWishSaysHowPingsFollow) {
  bench.command(ping_of(6028, RunMode::continuous, 200ms));  // 50 m
  ASSERT_TRUE(bench.device.ping_wish());
  EXPECT_EQ(bench.device.ping_wish()->period, 200ms);
  EXPECT_NEAR(static_cast<double>((bench.device.ping_wish()->listening - listening_of(6028)).count()), 0.0,
              2.0);
  bench.command(ping_of(6028, RunMode::continuous, 10ms));
  EXPECT_EQ(bench.device.ping_wish()->period, bench.device.ping_wish()->listening);
  bench.command(ping_of(64));
  EXPECT_EQ(bench.device.ping_wish()->period, waiting().min_ping_period);
}

TEST_F(Permission, APingForEach) {
  bench.command(ping_of(64, RunMode::continuous));
  for (std::size_t pings = 1; pings <= 20; ++pings) {
    ASSERT_TRUE(permit());
    EXPECT_EQ(bench.jobs.size(), pings);
    bench.run_for(6ms);  // the simulated time runs much faster: the rate rules are not those of this clock
  }
  EXPECT_EQ(bench.count(MessageType::ping_tail), 20U);
}

TEST_F(Permission, ASinglePingIsWishedForOnce) {
  bench.command(ping_of(64));
  ASSERT_TRUE(permit());
  bench.run_for(100ms);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 1U);
  EXPECT_FALSE(bench.device.ping_wish());
}

TEST_F(Permission, NoneIsWishedForWhileOneIsOnItsWay) {
  bench.render_time = 40ms;
  bench.command(ping_of(64, RunMode::continuous));
  ASSERT_TRUE(permit());
  EXPECT_FALSE(bench.device.ping_wish());
  bench.run_for(39ms);
  EXPECT_FALSE(bench.device.ping_wish());
  bench.run_for(100ms);
  EXPECT_TRUE(bench.device.ping_wish());
}

TEST_F(Permission, AnEdgeOfTheTriggerIsAWish) {
  bench.command(ping_of(64, RunMode::external_trigger));
  EXPECT_FALSE(bench.device.ping_wish());
  bench.trigger();
  ASSERT_TRUE(permit());
  EXPECT_EQ(bench.jobs.size(), 1U);
}

TEST_F(Permission, ASilentSurfaceWishesForNothing) {
  bench.command(ping_of(64, RunMode::continuous));
  bench.run_for(4s);
  EXPECT_FALSE(bench.device.ping_wish());
  bench.command(to_head<StatusRequest>());
  EXPECT_TRUE(bench.device.ping_wish()) << "it goes on where it was";
}

}  // namespace
}  // namespace sonard::gemini
