// SPDX-License-Identifier: Apache-2.0
// Pings in simulated time.
#include "bench.hpp"

namespace sonard::ping360 {
namespace {

DeviceConfig waiting() {
  DeviceConfig config;
  config.simulated_time = true;
  return config;
}

struct Ping360SimulatedTime : ::testing::Test {
  Bench bench{waiting()};
};

TEST_F(Ping360SimulatedTime, ThereIsNoNextPingUntilOneIsWanted) {
  EXPECT_FALSE(bench.last.next_ping);
  Transducer command = ping_at(3);
  command.transmit = 0;
  bench.command(command);
  EXPECT_FALSE(bench.last.next_ping);
  bench.run_for(1s);
  EXPECT_EQ(bench.all<DeviceData>().size(), 1U) << "a move needs no event";
  bench.command(ping_at(3));
  EXPECT_TRUE(bench.last.next_ping);
}

TEST_F(Ping360SimulatedTime, NothingIsSentWithoutItAndRequestsAreAnswered) {
  bench.command(scan_of(0, 399));
  bench.run_for(5s);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_EQ(bench.ask(GeneralRequest{4}).size(), 1U);
}

TEST_F(Ping360SimulatedTime, TheNextPingSaysHowPingsFollow) {
  AutoTransmit command = scan_of(0, 399, 10);
  command.delay_ms = 5;
  bench.command(command);
  ASSERT_TRUE(bench.begin_next());
  bench.run_for(1ms);
  ASSERT_TRUE(bench.last.next_ping);
  const auto listening = 200 * 80 * 25ns;
  EXPECT_EQ(bench.last.next_ping->listening, listening);
  EXPECT_EQ(bench.last.next_ping->period, listening + 18ms + 61ms + 5ms);
}

TEST_F(Ping360SimulatedTime, PingsAreTheSameAndInOrderHoweverFast) {
  bench.command(scan_of(0, 399, 3));
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(bench.begin_next());
    bench.run_for(1ms);  // a head that uses its own clock cannot turn as fast
  }
  Bench own;
  own.command(scan_of(0, 399, 3));
  EXPECT_EQ(angles_of(bench.all<AutoDeviceData>()), angles_of(own.wait_for<AutoDeviceData>(20)));
}

TEST_F(Ping360SimulatedTime, ScaledToNothingAPingStillListens) {
  DeviceConfig config = waiting();
  config.time_scale = 0.0;
  Bench fast(config);
  fast.command(scan_of(0, 399));
  ASSERT_TRUE(fast.last.next_ping);
  EXPECT_EQ(fast.last.next_ping->period, fast.last.next_ping->listening);
}

}  // namespace
}  // namespace sonard::ping360
