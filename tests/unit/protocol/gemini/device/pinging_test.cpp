// SPDX-License-Identifier: Apache-2.0
// Times of pings: run modes, rate limits, and events that end or delay a ping (protocol/gemini/README.md 1.5,
// 8).
#include <algorithm>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

/// Transmit times of the jobs so far.
std::vector<TimePoint> transmit_times(const Bench& bench) {
  std::vector<TimePoint> times;
  for (const PingJob& job : bench.jobs) {
    times.push_back(job.transmit_time);
  }
  return times;
}

TEST(Pinging, SingleConfigurationIsOnePingAtOnce) {
  Bench bench;
  bench.run_until(300ms);
  bench.command(ping_of(483));
  EXPECT_EQ(transmit_times(bench), std::vector<TimePoint>{300ms});
  bench.run_for(2s);
  EXPECT_EQ(bench.count(MessageType::ping_head), 1U);
  EXPECT_EQ(bench.count(MessageType::ping_line), 483U);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 1U);
  EXPECT_EQ(bench.device.counters().pings_sent, 1U);
  EXPECT_EQ(bench.device.counters().lines_sent, 483U);
}

TEST(Pinging, ContinuousIsStartToStart) {
  Bench bench;
  bench.render_time = 40ms;
  bench.lateness = [] { return 300us; };
  bench.command(ping_of(1205, RunMode::continuous, 150ms));
  bench.run_for(1s);
  // 40 ms of rendering, 33 ms on the wire and late timers do not add to the interval.
  EXPECT_EQ(transmit_times(bench), (std::vector<TimePoint>{0ms, 150ms, 300ms, 450ms, 600ms, 750ms, 900ms}));
}

TEST(Pinging, ContinuousSurvivesAStallWithoutCatchingUp) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(150ms);
  bench.now = 930ms;  // no step of the head until now
  bench.run_until(1200ms);
  EXPECT_EQ(transmit_times(bench), (std::vector<TimePoint>{0ms, 100ms, 930ms, 1030ms, 1130ms}))
      << "nobody remembers the pose of 200 ms";
}

TEST(Pinging, TriggeredPingsOncePerEdge) {
  Bench bench;
  bench.command(ping_of(100, RunMode::external_trigger));
  bench.run_for(500ms);
  EXPECT_TRUE(bench.jobs.empty()) << "no edge, no ping";
  bench.trigger();
  bench.run_for(5ms);
  bench.trigger();  // too early: less than 33.3 ms
  bench.run_for(95ms);
  bench.trigger();
  bench.run_for(100ms);
  EXPECT_EQ(transmit_times(bench), (std::vector<TimePoint>{500ms, 600ms}));
  EXPECT_EQ(bench.device.counters().pings_suppressed, 1U);
  bench.command(ping_of(100));
  bench.run_for(100ms);
  bench.trigger();  // no longer armed
  bench.run_for(100ms);
  EXPECT_EQ(bench.jobs.size(), 3U);
}

TEST(Pinging, TriggerBeforeAnyConfigurationDoesNothing) {
  Bench bench;
  bench.trigger();
  bench.run_for(100ms);
  EXPECT_TRUE(bench.jobs.empty());
}

TEST(Pinging, ShortestPeriodIsThatOfTheHardware) {
  Bench bench;
  bench.command(ping_of(32, RunMode::continuous, 0us));
  bench.run_for(1s);
  const auto times = transmit_times(bench);
  ASSERT_EQ(times.size(), 31U);  // 0, 33.3, ..., 999 ms
  for (std::size_t i = 1; i < times.size(); ++i) {
    EXPECT_EQ(times[i] - times[i - 1], 33'300us);
  }
}

TEST(Pinging, NoPingBeforeTheLastEchoIsBack) {
  DeviceConfig config = example_config();
  config.line_period = 1us;  // so that the wire does not limit the rate
  config.min_ping_period = 1ms;
  Bench bench(config);
  bench.command(ping_of(9042, RunMode::continuous, 1ms));  // 75 m: 2R/c = 100 ms
  bench.run_for(1s);
  const auto times = transmit_times(bench);
  ASSERT_GT(times.size(), 5U);
  for (std::size_t i = 1; i < times.size(); ++i) {
    EXPECT_GE(times[i] - times[i - 1], 99'997us);  // 9042 / 90422 s
    EXPECT_LE(times[i] - times[i - 1], 100'200us);
  }
}

TEST(Pinging, NoPingBeforeTheLastEchoIsBackAlsoWhenNothingWasSent) {
  Bench bench;
  bench.renderer_fails = true;
  bench.command(ping_of(9042, RunMode::continuous, 1ms));
  bench.run_for(1s);
  const auto times = transmit_times(bench);
  ASSERT_EQ(times.size(), 11U);
  for (std::size_t i = 1; i < times.size(); ++i) {
    EXPECT_GE(times[i] - times[i - 1], 99'997us);
  }
}

TEST(Pinging, NoPingBeforeThePreviousTail) {
  Bench bench;
  bench.command(ping_of(2411, RunMode::continuous, 10ms));  // 27 us a line: 65 ms on the wire
  bench.run_for(1s);
  const auto tails = bench.all<PingTail>();
  ASSERT_GT(bench.jobs.size(), 10U);
  for (std::size_t i = 1; i < bench.jobs.size(); ++i) {
    EXPECT_GE(bench.jobs[i].transmit_time, tails[i - 1].first);
    EXPECT_LE(bench.jobs[i].transmit_time, tails[i - 1].first + 1ms) << "as fast as possible";
  }
}

TEST(Pinging, FifteenPingsPerSecondOfTwentyMetresWithARendererOfThirtyMilliseconds) {
  Bench bench;
  bench.render_time = 30ms;
  bench.lateness = [] { return 100us; };
  PingConfig config = ping_of(2411, RunMode::continuous, 66'000us);
  config.range_compression = 1;
  bench.command(config);
  bench.run_connected(4s);
  EXPECT_GE(bench.count(MessageType::ping_tail), 60U);
  EXPECT_EQ(bench.count(MessageType::ping_line) / 1205, bench.count(MessageType::ping_tail));
}

TEST(Pinging, RenderingAheadHidesTheRenderer) {
  DeviceConfig device = example_config();
  device.render_lead = 30ms;
  Bench bench(device);
  bench.render_time = 30ms;
  PingConfig config = ping_of(2411, RunMode::continuous, 0us);
  config.range_compression = 1;
  bench.command(config);
  bench.run_connected(4s);
  const auto heads = bench.all<PingHead>();
  const auto tails = bench.all<PingTail>();
  ASSERT_GT(heads.size(), 100U);  // 33.3 ms each instead of 63 ms
  for (std::size_t i = 1; i < heads.size(); ++i) {
    const TimePoint transmit = bench.jobs[i].transmit_time;
    EXPECT_GE(transmit, tails[i - 1].first) << "still not before the previous tail";
    EXPECT_GE(heads[i].first, transmit);
    EXPECT_LE(heads[i].first, transmit + 1ms) << "the image was ready in time";
  }
}

TEST(Pinging, RenderLeadIsKept) {
  DeviceConfig device = example_config();
  device.render_lead = 20ms;
  Bench bench(device);
  bench.renderer_answers = false;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  ASSERT_EQ(bench.jobs.size(), 1U);  // the first ping has no lead
  bench.answer(test_image(bench.jobs[0]));
  bench.run_until(79ms);
  EXPECT_EQ(bench.jobs.size(), 1U);
  bench.run_until(81ms);
  ASSERT_EQ(bench.jobs.size(), 2U);
  EXPECT_EQ(bench.jobs[1].transmit_time, 100ms);
  bench.answer(test_image(bench.jobs[1]));
  bench.run_until(99'999us);
  EXPECT_EQ(bench.count(MessageType::ping_head), 1U) << "its head waits for the transmit time";
  bench.run_until(100ms);
  EXPECT_EQ(bench.count(MessageType::ping_head), 2U);
}

TEST(Pinging, NewConfigurationReplacesAPingRenderedAhead) {
  DeviceConfig device = example_config();
  device.render_lead = 50ms;
  Bench bench(device);
  bench.renderer_answers = false;
  bench.command(ping_of(100, RunMode::continuous, 200ms));
  bench.answer(test_image(bench.jobs[0]));
  bench.run_until(160ms);
  ASSERT_EQ(bench.jobs.size(), 2U);
  bench.command(ping_of(300));
  bench.run_for(10ms);
  EXPECT_EQ(bench.jobs.size(), 2U) << "one job at a time: the old one is unanswered";
  bench.answer(test_image(bench.jobs[1]));
  bench.run_for(1ms);
  EXPECT_EQ(bench.device.counters().stale_images, 1U);
  ASSERT_EQ(bench.jobs.size(), 3U);
  EXPECT_EQ(bench.jobs[2].native_bins, 300);
  bench.answer(test_image(bench.jobs[2]));
  bench.run_for(200ms);
  EXPECT_EQ(bench.count(MessageType::ping_head), 2U);
  EXPECT_EQ(bench.all<PingHead>().back().second.end_range, 300);
}

TEST(Pinging, ConfigurationDuringAPingWaitsForItsTailAndTheNewestWins) {
  Bench bench;
  bench.command(ping_of(3000));  // 81 ms on the wire
  bench.run_until(20ms);
  bench.command(ping_of(200));
  bench.run_until(30ms);
  bench.command(ping_of(300));
  bench.run_until(40ms);
  bench.command(ping_of(400));
  bench.run_until(1s);
  const auto heads = bench.all<PingHead>();
  ASSERT_EQ(heads.size(), 2U);
  EXPECT_EQ(heads[0].second.end_range, 3000);
  EXPECT_EQ(heads[1].second.end_range, 400);
  const auto tails = bench.all<PingTail>();
  ASSERT_EQ(tails.size(), 2U);
  EXPECT_EQ(bench.count(MessageType::ping_line), 3400U) << "the first was not cut";
  EXPECT_EQ(bench.jobs[1].transmit_time, tails[0].first) << "right after the tail";
  EXPECT_EQ(bench.device.counters().configs_replaced, 2U);
}

TEST(Pinging, ConfigurationWhileRenderingDoesNotCutThePing) {
  Bench bench;
  bench.render_time = 50ms;
  bench.command(ping_of(100));
  bench.run_until(20ms);
  bench.command(ping_of(200));
  bench.run_until(1s);
  EXPECT_EQ(bench.count(MessageType::ping_head), 2U);
  EXPECT_EQ(bench.count(MessageType::ping_line), 300U);
}

TEST(Pinging, SingleConfigurationEndsAContinuousProgrammeWithOneLastPing) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(250ms);
  bench.command(ping_of(120));
  bench.run_until(2s);
  const auto heads = bench.all<PingHead>();
  ASSERT_EQ(heads.size(), 4U);  // at 0, 100, 200 ms, and the last one at 250 ms
  EXPECT_EQ(heads[3].first, 250ms);
  EXPECT_EQ(heads[3].second.end_range, 120);
}

TEST(Pinging, NewContinuousProgrammeStartsAtOnce) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 500ms));
  bench.run_until(200ms);
  bench.command(ping_of(150, RunMode::continuous, 100ms));
  bench.run_until(450ms);
  EXPECT_EQ(transmit_times(bench), (std::vector<TimePoint>{0ms, 200ms, 300ms, 400ms}));
}

TEST(Pinging, GoingOfflineStopsAfterThePingOnTheWire) {
  Bench bench;
  bench.command(ping_of(2000, RunMode::continuous, 100ms));
  bench.run_until(130ms);  // 30 ms into the second ping
  bench.raw(from_hex("c8 01 59 02 00 00 02 01 00 00"));
  bench.run_until(2s);
  EXPECT_EQ(bench.count(MessageType::ping_head), 2U);
  EXPECT_EQ(bench.count(MessageType::ping_line), 4000U);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 2U);
}

TEST(Pinging, ThreeSecondsOfSilenceSuspendAndAnyCommandResumes) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(10s);
  ASSERT_FALSE(bench.ping_datagrams().empty());
  EXPECT_LT(bench.ping_datagrams().back().at, 3s);
  EXPECT_GT(bench.ping_datagrams().back().at, 2900ms);
  EXPECT_EQ(bench.device.client(), 0U);
  EXPECT_EQ(bench.device.counters().client_timeouts, 1U);
  EXPECT_EQ(bench.count(MessageType::status), 11U) << "status goes on";

  const std::size_t before = bench.sent.size();
  bench.command(to_head<StatusRequest>());
  bench.run_for(350ms);
  const auto heads = bench.all<PingHead>(before);
  ASSERT_EQ(heads.size(), 4U);
  EXPECT_EQ(heads[0].first, 10s);
  EXPECT_EQ(heads[3].first, 10s + 300ms);
}

TEST(Pinging, ConfigurationAfterSilenceReplacesTheProgramme) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(5s);
  const std::size_t before = bench.sent.size();
  bench.command(ping_of(150));
  bench.run_for(1s);
  const auto heads = bench.all<PingHead>(before);
  ASSERT_EQ(heads.size(), 1U);
  EXPECT_EQ(heads[0].second.end_range, 150);
}

TEST(Pinging, AnyValidCommandKeepsTheHeadAwake) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  for (int i = 0; i < 5; ++i) {
    bench.run_for(2s);
    bench.raw(from_hex("36 01 59 02 00 00 00 00 00 00 00 00"));
  }
  EXPECT_EQ(bench.count(MessageType::ping_head), 101U);
  bench.run_for(2s);
  bench.raw(from_hex("20 01 5a 02 00 00 00 00"));  // for another head
  bench.run_for(2s);
  EXPECT_EQ(bench.device.counters().client_timeouts, 1U);
}

TEST(Pinging, SilenceCutsAPingThatIsLongerThanThat) {
  Bench bench;
  auto slow = to_head<NetworkConfig>();
  slow.inter_packet_gap = 65535;
  bench.command(slow);
  bench.command(ping_of(20000));  // 524 us per line: 10.5 s
  bench.run_until(20s);
  EXPECT_LT(bench.ping_datagrams().back().at, 3s);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 0U);
  EXPECT_EQ(bench.device.counters().pings_cancelled, 1U);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 3));
  bench.run_for(1s);
  EXPECT_TRUE(bench.ping_datagrams(before).empty()) << "nothing is left of it";
}

TEST(Pinging, DataFollowTheNewestClient) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(250ms);
  const std::size_t before = bench.sent.size();
  bench.command(to_head<NetworkConfig>(), other_client);
  bench.run_until(500ms);
  EXPECT_GT(bench.ping_datagrams(before).size(), 100U);
  for (const auto& datagram : bench.ping_datagrams(before)) {
    EXPECT_EQ(datagram.client, other_client);
  }
}

TEST(Pinging, OutOfTheWaterTheHeadPingsOnlyWhenTold) {
  Bench bench;
  bench.set_out_of_water(true);
  PingConfig obedient = ping_of(100);
  obedient.ext_mode = 0x0004;
  bench.command(obedient);
  bench.run_for(500ms);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_EQ(bench.device.counters().pings_suppressed, 1U);
  bench.command(ping_of(100));  // bit 9 set
  bench.run_for(100ms);
  EXPECT_EQ(bench.jobs.size(), 1U);

  obedient.run_mode = 1;
  obedient.interping_us = 100'000;
  bench.command(obedient);
  bench.run_for(1s);
  EXPECT_EQ(bench.jobs.size(), 1U);
  EXPECT_GT(bench.device.counters().pings_suppressed, 9U);
  bench.set_out_of_water(false);
  bench.run_for(1s);
  EXPECT_EQ(bench.jobs.size(), 11U) << "back in the water the programme goes on";
}

TEST(Pinging, UnsupportedDataEndsThePreviousProgramme) {
  struct Case {
    std::uint16_t ext_mode;
    std::uint16_t run_mode;
  };
  for (const Case& c : {Case{0x0205, 0}, {0x0206, 0}, {0x0207, 0}, {0x0204, 3}}) {
    Bench bench;
    bench.command(ping_of(100, RunMode::continuous, 100ms));
    bench.run_for(250ms);
    PingConfig config = ping_of(100);
    config.ext_mode = c.ext_mode;
    config.run_mode = c.run_mode;
    bench.command(config);
    bench.run_for(1s);
    EXPECT_EQ(bench.count(MessageType::ping_head), 3U);
    EXPECT_EQ(bench.device.counters().unsupported_data, 1U);
  }
}

TEST(Pinging, ProfilerBitsOfTheRunModeAreIgnored) {
  Bench bench;
  PingConfig config = ping_of(100);
  config.run_mode = 0x000C;
  bench.command(config);
  bench.run_for(1s);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 1U);
}

TEST(Pinging, FailedRenderingCostsOnlyThatPing) {
  Bench bench;
  bench.render_time = 10ms;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(150ms);
  bench.renderer_fails = true;
  bench.run_until(450ms);
  bench.renderer_fails = false;
  bench.run_until(750ms);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 5U);
  EXPECT_EQ(bench.device.counters().pings_failed, 3U);
  EXPECT_EQ(bench.device.counters().pings_started, 8U);
}

TEST(Pinging, ImageOfTheWrongSizeIsAFailedPing) {
  Bench bench;
  bench.render = [](const PingJob& job) {
    PingImage image = test_image(job);
    image.u8.pop_back();
    return image;
  };
  bench.command(ping_of(100));
  bench.run_for(1s);
  EXPECT_EQ(bench.device.counters().pings_failed, 1U);
  EXPECT_TRUE(bench.ping_datagrams().empty());
}

TEST(Pinging, ImagesNobodyAskedForAreDropped) {
  Bench bench;
  bench.renderer_answers = false;
  bench.answer(PingImage{});
  bench.command(ping_of(100));
  PingImage other = test_image(bench.jobs[0]);
  other.number = 17;
  bench.answer(other);
  bench.step(PingNotRendered{17});
  EXPECT_EQ(bench.device.counters().stale_images, 3U);
  bench.answer(test_image(bench.jobs[0]));
  bench.run_for(100ms);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 1U);
}

TEST(Pinging, AnswersWithinTheTimeThatAVehicleClientWaits) {
  // The tail leaves within 200 ms + 4R/c of the configuration, R/c = lines / (2 * 90422 Hz), uncompressed.
  for (const int lines : {121, 1206, 3617, 6028, 9042, 14468, 18084}) {
    Bench bench;
    bench.render_time = 50ms;
    bench.lateness = [] { return 200us; };
    bench.command(ping_of(lines));
    bench.run_for(2s);
    ASSERT_EQ(bench.count(MessageType::ping_tail), 1U);
    const std::chrono::duration<double> limit{0.2 + 2.0 * lines / 90422.0};
    EXPECT_LT(bench.all<PingTail>()[0].first, limit) << lines;
  }
}

}  // namespace
}  // namespace sonard::gemini
