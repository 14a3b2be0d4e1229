// SPDX-License-Identifier: Apache-2.0
// Pings in simulated time.
#include "bench.hpp"
#include "protocol/micron/line_timing.hpp"

namespace sonard::micron {
namespace {

DeviceConfig waiting() {
  DeviceConfig config;
  config.simulated_time = true;
  return config;
}

struct SimulatedTime : ::testing::Test {
  Bench bench{waiting()};
};

TEST_F(SimulatedTime, NothingIsSentWithoutIt) {
  bench.make_ready(all_round());
  bench.command(SendData{});
  bench.run_for(5s);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_TRUE(bench.all<HeadData>().empty());
  EXPECT_GE(bench.all<Alive>().size(), 4U) << "the head lives on in its own time";
}

TEST_F(SimulatedTime, TheNextPingSaysHowLinesFollow) {
  bench.make_ready(all_round());
  bench.command(SendData{});
  ASSERT_TRUE(bench.last.next_ping);
  const LineTiming timing = line_timing(all_round(), waiting(), 32);
  EXPECT_EQ(bench.last.next_ping->period, timing.period(waiting()));
  EXPECT_EQ(bench.last.next_ping->listening, timing.listen);
}

TEST_F(SimulatedTime, LinesAreTheSameAndInOrderHoweverFast) {
  bench.make_ready(all_round());
  std::vector<HeadData> lines;
  for (int line = 0; line < 20; ++line) {
    if (line % 2 == 0) {
      bench.command(SendData{});  // requests two lines
    }
    ASSERT_TRUE(bench.begin_next());
    bench.run_for(1ms);  // a head that uses its own clock cannot turn as fast
  }
  ASSERT_EQ(bench.all<HeadData>().size(), 20U);

  Bench own;
  own.make_ready(all_round());
  const std::vector<HeadData> expected = own.scan(20);
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(bench.all<HeadData>()[i].second.bearing, expected[i].bearing);
  }
}

TEST_F(SimulatedTime, ALinePeriodOfNothingStillListens) {
  DeviceConfig config = waiting();
  config.line_period = 0ns;
  Bench as_fast_as_rendered(config);
  as_fast_as_rendered.make_ready(all_round());
  as_fast_as_rendered.command(SendData{});
  const auto next = as_fast_as_rendered.last.next_ping;
  ASSERT_TRUE(next);
  EXPECT_EQ(next->period, next->listening);
}

}  // namespace
}  // namespace sonard::micron
