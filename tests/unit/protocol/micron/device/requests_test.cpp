// SPDX-License-Identifier: Apache-2.0
// Number and times of the lines after a request (protocol/micron/README.md 8.1, 8.2).
#include "bench.hpp"

namespace sonard::micron {
namespace {

std::size_t lines_for(bool half_duplex, int requests, int cap = 2) {
  DeviceConfig config;
  config.half_duplex = half_duplex;
  config.request_cap = cap;
  Bench bench(config);
  bench.make_ready(all_round());
  for (int i = 0; i < requests; ++i) {
    bench.raw(fixture("send_data"));
  }
  bench.run_for(10s);
  return bench.all<HeadData>().size();
}

TEST(Requests, BringTwoLinesInFullDuplexAndOneInHalf) {
  EXPECT_EQ(lines_for(false, 1), 2U);
  EXPECT_EQ(lines_for(true, 1), 1U);
}

TEST(Requests, PileUpToTwo) {
  EXPECT_EQ(lines_for(false, 2), 4U);
  EXPECT_EQ(lines_for(false, 50), 4U);
  EXPECT_EQ(lines_for(true, 50), 2U);
  EXPECT_EQ(lines_for(false, 50, 5), 10U);
}

TEST(Requests, BeyondTheCapAreCounted) {
  Bench bench;
  bench.make_ready(all_round());
  for (int i = 0; i < 5; ++i) {
    bench.raw(fixture("send_data"));
  }
  EXPECT_EQ(bench.device.counters().requests_beyond_cap, 6U);
}

TEST(Requests, OneForEveryReplyNeverBuildsABacklog) {
  Bench bench;
  bench.make_ready(all_round());
  bench.scan(300);
  const std::size_t before = bench.all<HeadData>().size();
  bench.run_for(10s);
  EXPECT_LE(bench.all<HeadData>().size() - before, 4U);
}

TEST(Requests, WithoutParametersBringNothing) {
  Bench bench;
  bench.run_until(2s);
  bench.raw(fixture("send_data"));
  bench.run_until(10s);
  bench.raw(fixture("send_data"));
  bench.run_for(5s);
  bench.raw(fixture("gain"));
  bench.raw(fixture("reverse"));
  EXPECT_EQ(bench.device.counters().not_ready, 4U);
  bench.command(all_round());
  bench.run_for(5s);
  EXPECT_TRUE(bench.jobs.empty());
}

TEST(Requests, WaitUntilTheHeadIsCentred) {
  Bench bench;
  const TimePoint reboot = bench.reboot_at(0);  // half a turn from the centre: 2 s
  bench.run_until(reboot + 1s);
  bench.raw(fixture("head_command_ros"));
  bench.raw(fixture("send_data"));
  bench.run_until(reboot + 2699ms);
  EXPECT_TRUE(bench.jobs.empty());
  bench.run_until(reboot + 6s);
  ASSERT_EQ(bench.jobs.size(), 2U);
  EXPECT_EQ(bench.jobs[0].transmit_time, reboot + 2700ms);
  EXPECT_DOUBLE_EQ(bench.jobs[0].bearing_rad, 0.0);
  EXPECT_EQ(bench.all<HeadData>().at(0).second.bearing, 3200);
}

TEST(Requests, SurviveNewParametersAndAreAnsweredWithThemOnly) {
  Bench bench;
  bench.make_ready(all_round());
  bench.renderer_answers = false;
  bench.raw(fixture("send_data"));
  ASSERT_EQ(bench.jobs.size(), 1U);
  HeadCommand next = sector(3000, 3400, 64);
  next.ad_span = 81;
  next.bins = 30;
  bench.command(next);
  EXPECT_EQ(bench.last.cancelled, 0U);
  bench.renderer_answers = true;
  bench.answer(test_line(bench.jobs[0]));
  bench.run_for(2s);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 2U) << "both are still owed";
  for (const auto& [at, line] : lines) {
    EXPECT_EQ(line.ad_span, 81);
    EXPECT_EQ(line.step, 64);
    EXPECT_EQ(line.data.size(), 30U);
  }
}

TEST(Requests, LineThatIsReadyButNotSentIsDoneAgainWithNewParameters) {
  Bench bench;
  bench.make_ready(all_round());
  bench.raw(fixture("send_data"));
  bench.run_for(1us);  // rendered, but the head still listens
  bench.command(sector(3000, 3400));
  bench.run_for(1s);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].second.control, 0x2305);
  EXPECT_EQ(bench.device.counters().pings_cancelled, 1U);
}

TEST(Requests, MayBeForgottenWithNewParameters) {
  DeviceConfig config;
  config.requests_survive_head_command = false;
  Bench bench(config);
  bench.make_ready(all_round());
  bench.raw(fixture("send_data"));
  bench.command(sector(3000, 3400));
  bench.run_for(2s);
  EXPECT_TRUE(bench.all<HeadData>().empty());
}

}  // namespace
}  // namespace sonard::micron
