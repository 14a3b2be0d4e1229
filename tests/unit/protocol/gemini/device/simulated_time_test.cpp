// SPDX-License-Identifier: Apache-2.0
// Pings in simulated time.
#include "bench.hpp"

namespace sonard::gemini {
namespace {

DeviceConfig waiting() {
  DeviceConfig config = example_config();
  config.simulated_time = true;
  return config;
}

/// Listening time of a ping of `lines`, at the head's native line rate.
std::chrono::nanoseconds listening_of(int lines) {
  return std::chrono::nanoseconds{static_cast<std::int64_t>(lines / 90422.0 * 1e9)};
}

struct SimulatedTime : testing::Test {
  Bench bench{waiting()};
};

TEST_F(SimulatedTime, NothingIsSentWithoutIt) {
  bench.command(ping_of(64, RunMode::continuous));
  bench.run_connected(5s);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_TRUE(bench.ping_datagrams().empty());
  EXPECT_GE(bench.count(MessageType::status), 5U) << "the head lives on in its own time";
  EXPECT_TRUE(bench.last.next_ping);
}

TEST_F(SimulatedTime, TheNextPingSaysHowPingsFollow) {
  bench.command(ping_of(6028, RunMode::continuous, 200ms));  // 50 m
  ASSERT_TRUE(bench.last.next_ping);
  EXPECT_EQ(bench.last.next_ping->period, 200ms);
  EXPECT_NEAR(static_cast<double>((bench.last.next_ping->listening - listening_of(6028)).count()), 0.0, 2.0);
  bench.command(ping_of(6028, RunMode::continuous, 10ms));
  EXPECT_EQ(bench.last.next_ping->period, bench.last.next_ping->listening);
  bench.command(ping_of(64));
  EXPECT_EQ(bench.last.next_ping->period, waiting().min_ping_period);
}

TEST_F(SimulatedTime, ASinglePingIsNextOnce) {
  bench.command(ping_of(64));
  ASSERT_TRUE(bench.begin_next());
  bench.run_for(100ms);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 1U);
  EXPECT_FALSE(bench.last.next_ping);
}

TEST_F(SimulatedTime, AnEdgeOfTheTriggerMakesAPingNext) {
  bench.command(ping_of(64, RunMode::external_trigger));
  EXPECT_FALSE(bench.last.next_ping);
  bench.trigger();
  ASSERT_TRUE(bench.begin_next());
  EXPECT_EQ(bench.jobs.size(), 1U);
}

TEST_F(SimulatedTime, ASilentClientHasNoNextPing) {
  bench.command(ping_of(64, RunMode::continuous));
  bench.run_for(4s);
  EXPECT_FALSE(bench.last.next_ping);
  bench.command(to_head<StatusRequest>());
  EXPECT_TRUE(bench.last.next_ping) << "it goes on where it was";
}

}  // namespace
}  // namespace sonard::gemini
