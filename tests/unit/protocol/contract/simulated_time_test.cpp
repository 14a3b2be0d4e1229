// SPDX-License-Identifier: Apache-2.0
// In simulated time a head announces its next ping, and begins it when NextPingDue comes.
#include "tests/unit/protocol/contract/contract_test.hpp"

namespace sonard::contract {
namespace {

struct SimulatedTime : Contract {
  HeadBench bench{GetParam(), {.simulated_time = true}};

  SimulatedTime() { bench.connect(); }
};

TEST_P(SimulatedTime, NoPingIsNextUntilOneIsRequested) {
  EXPECT_FALSE(bench.last.next_ping);
  bench.request();
  ASSERT_TRUE(bench.last.next_ping);
  EXPECT_GT(bench.last.next_ping->listening, 0ns);
  EXPECT_GE(bench.last.next_ping->period, bench.last.next_ping->listening);
}

TEST_P(SimulatedTime, NoPingBeginsWithoutTheEvent) {
  bench.request();
  bench.run_for(2s);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_TRUE(bench.last.next_ping);
}

TEST_P(SimulatedTime, OnePingBeginsForEachEventHoweverSoonItComes) {
  for (std::size_t pings = 1; pings <= 20; ++pings) {
    if (!bench.last.next_ping) {
      bench.request();
    }
    ASSERT_TRUE(bench.begin_next());
    EXPECT_EQ(bench.jobs.size(), pings);
    bench.run_for(6ms);  // a head that uses its own clock cannot ping as fast
    EXPECT_EQ(bench.records.size(), pings);
  }
}

TEST_P(SimulatedTime, NoPingIsNextWhileOneIsRendered) {
  bench.render_time = 40ms;
  bench.request();
  ASSERT_TRUE(bench.begin_next());
  EXPECT_FALSE(bench.last.next_ping);
  bench.run_for(39ms);
  bench.request();
  EXPECT_FALSE(bench.last.next_ping);
  bench.run_for(100ms);
  bench.request();
  EXPECT_TRUE(bench.last.next_ping);
}

TEST_P(SimulatedTime, NoPingIsNextWhileACancelledOneIsRendered) {
  bench.renderer_answers = false;
  bench.request();
  ASSERT_TRUE(bench.begin_next());
  bench.cancel();
  bench.request();
  EXPECT_FALSE(bench.last.next_ping);
  bench.fail(0);
  bench.request();
  EXPECT_TRUE(bench.last.next_ping);
}

TEST_P(SimulatedTime, AHeadWhoseClientHasGoneHasNoNextPing) {
  bench.request();
  ASSERT_TRUE(bench.last.next_ping);
  bench.cancel();
  bench.leave();
  EXPECT_FALSE(bench.last.next_ping);
}

TEST_P(SimulatedTime, PlaybackNeedsAFedPingToo) {
  HeadBench player(GetParam(), {.simulated_time = true, .plays_back = true});
  player.connect();
  player.request();
  EXPECT_FALSE(player.last.next_ping);
  player.feed(4);
  ASSERT_TRUE(player.begin_next());
  player.run_for(300ms);
  EXPECT_EQ(player.records.size(), 1U);
  EXPECT_FALSE(player.last.next_ping);
}

INSTANTIATE_TEST_SUITE_P(Devices, SimulatedTime, ::testing::ValuesIn(head_types()), name_of);

}  // namespace
}  // namespace sonard::contract
