// SPDX-License-Identifier: Apache-2.0
// No bytes from a peer make the head grow, stall or send without end. No missing peer stops it.
#include "bench.hpp"

namespace sonard::micron {
namespace {

Bytes begin_of(const std::string& name, std::size_t size) {
  Bytes bytes = fixture(name);
  bytes.resize(size);
  return bytes;
}

TEST(Robustness, ClientThatVanishesInTheMiddleOfALineLeavesARunningHead) {
  Bench bench;
  bench.make_ready(all_round());
  bench.scan(5);
  bench.raw(begin_of("head_command_uxv", 30));
  bench.step(ClientGone{});
  bench.run_for(10s);
  EXPECT_EQ(bench.device.state(bench.now), HeadState::ready) << "what was owed is sent to nobody";

  bench.sent.clear();
  bench.raw(fixture("send_version"));
  ASSERT_EQ(bench.sent.size(), 1U) << "the next client is understood from its first byte on";
  EXPECT_EQ(bench.sent[0].bytes, fixture("version_data"));
  EXPECT_EQ(bench.scan(3).size(), 3U) << "with the parameters of the last one";
}

TEST(Robustness, HalfAFrameOnALineWithoutConnectionsCostsOneFrameAtMost) {
  Bench bench;
  bench.run_until(10s);
  bench.raw(begin_of("head_command_uxv", 30));
  bench.run_for(1s);
  bench.raw(fixture("send_version"));
  bench.run_for(100ms);
  EXPECT_EQ(bench.all<VersionData>().size(), 1U) << "found inside after 100 ms of silence";
}

TEST(Robustness, RebootThatSaysItIsLongerThanItIs) {
  Bench bench;
  bench.run_until(10s);
  const TimePoint asked = bench.now;
  bench.raw(Bytes{0x40, 0x30, 0x30, 0x30, 0x43, 0x0C, 0x00, 0xFF, 0x02, 0x07, 0x10, 0x80, 0x02, 0x0A});
  bench.run_for(99ms);
  EXPECT_EQ(bench.device.counters().boots, 0U);
  bench.run_for(1ms);
  EXPECT_EQ(bench.device.counters().boots, 1U);
  EXPECT_EQ(bench.device.counters().cut_frames, 1U);
  bench.sent.clear();
  bench.run_for(2s);
  EXPECT_EQ(bench.sent.at(0).at, asked + 100ms + 700ms);
}

TEST(Robustness, PingThatCannotBeRenderedIsALineThatDoesNotCome) {
  Bench bench;
  bench.make_ready(all_round());
  bench.renderer_fails = true;
  bench.command(SendData{});
  bench.run_for(1s);
  EXPECT_TRUE(bench.all<HeadData>().empty());
  EXPECT_EQ(bench.device.counters().pings_failed, 2U);
  bench.renderer_fails = false;
  EXPECT_EQ(bearings_of(bench.scan(2)), (std::vector<int>{3264, 3296})) << "the head has turned on";
}

TEST(Robustness, FloodOfCommandsIsBoundedInOutput) {
  Bench bench;
  bench.make_ready(all_round());
  for (int i = 0; i < 20'000; ++i) {
    bench.raw(fixture("send_data"));
  }
  bench.run_for(5s);
  EXPECT_EQ(bench.all<HeadData>().size(), 4U);
  for (int i = 0; i < 2000; ++i) {
    bench.raw(fixture("head_command_uxv"));
    bench.command(SendData{});
    bench.run_for(1ms);
  }
  EXPECT_EQ(bench.all<HeadData>().size(), 4U) << "a head that is told anew all the time never gets ready";
  bench.run_for(2s);
  EXPECT_EQ(bench.all<HeadData>().size(), 8U);
}

}  // namespace
}  // namespace sonard::micron
