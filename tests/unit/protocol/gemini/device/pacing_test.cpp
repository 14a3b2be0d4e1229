// SPDX-License-Identifier: Apache-2.0
// Times at which the datagrams of a ping are sent (protocol/gemini/README.md 8.5, 3.6).
#include <algorithm>
#include <random>

#include "bench.hpp"
#include "protocol/gemini/pacer.hpp"

namespace sonard::gemini {
namespace {

constexpr std::chrono::nanoseconds wire_period = 27us;

std::vector<Bench::Sent> one_ping(Bench& bench, const PingConfig& config) {
  const std::size_t before = bench.sent.size();
  bench.command(config);
  bench.run_connected(15s);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 1U);
  return bench.ping_datagrams(before);
}

/// In any span of time at most one burst, plus the datagrams that the link carries in that span, are sent.
void expect_paced(const std::vector<Bench::Sent>& sent, int burst, std::chrono::nanoseconds period) {
  for (std::size_t first = 0; first < sent.size(); ++first) {
    for (std::size_t last = first; last < sent.size(); ++last) {
      const auto allowed = burst + (sent[last].at - sent[first].at) / period;
      ASSERT_LE(static_cast<std::int64_t>(last - first + 1), allowed)
          << "datagrams " << first << " to " << last;
    }
  }
}

/// Line i of a ping sent at time 0 is not sent before its sound arrives: (i + 1) 2^k native lines of 1 /
/// 90422 s.
void expect_acoustic(const std::vector<Bench::Sent>& sent, int compression_log2) {
  for (std::size_t i = 0; i + 2 < sent.size(); ++i) {
    const auto native = static_cast<double>((i + 1) << compression_log2);
    ASSERT_GE(std::chrono::duration<double>(sent[i + 1].at).count(), native / 90422.0) << "line " << i;
  }
}

/// Time from the first of the last 36 lines to the tail.
std::chrono::nanoseconds final_span(const std::vector<Bench::Sent>& sent) {
  return sent.back().at - sent[sent.size() - 37].at;
}

TEST(Pacing, LinesFollowTheSoundAndTheLink) {
  for (const int k : {0, 1, 2, 3, 4}) {
    Bench bench;
    PingConfig config = ping_of(7234);  // 60 m
    config.range_compression = static_cast<std::uint16_t>(k);
    const auto sent = one_ping(bench, config);
    ASSERT_EQ(sent.size(), static_cast<std::size_t>((7234 >> k) + 2));
    expect_acoustic(sent, k);
    expect_paced(sent, 32, wire_period);
    EXPECT_LE(final_span(sent), 5ms) << k;
  }
}

TEST(Pacing, PingLastsAsLongAsOnALinkOf100Megabit) {
  // From the document: 4 m takes 13 ms; 60 m uncompressed takes 195 ms; 60 m with x4 takes 80 ms, limited by
  // the sound.
  struct Case {
    int lines;
    int k;
    std::chrono::nanoseconds expected;
  };
  for (const Case& c : {Case{483, 0, 13ms}, {7234, 0, 195ms}, {7234, 2, 80ms}}) {
    Bench bench;
    PingConfig config = ping_of(c.lines);
    config.range_compression = static_cast<std::uint16_t>(c.k);
    const auto sent = one_ping(bench, config);
    EXPECT_NEAR(static_cast<double>(sent.back().at.count()), static_cast<double>(c.expected.count()), 1e6);
  }
}

TEST(Pacing, HeadLeavesAtTransmitAndTailRightAfterTheLastLine) {
  Bench bench;
  const auto sent = one_ping(bench, ping_of(1000));
  EXPECT_EQ(sent.front().at, 0ms);
  EXPECT_LE(sent.back().at - sent[sent.size() - 2].at, 1ms);
}

TEST(Pacing, LateImageLeavesOnlyTheLinkToWaitFor) {
  Bench bench;
  bench.render_time = 100ms;
  const auto sent = one_ping(bench, ping_of(1205));
  EXPECT_EQ(sent.front().at, 100ms);
  expect_paced(sent, 32, wire_period);
  EXPECT_NEAR(static_cast<double>((sent.back().at - sent.front().at).count()), 1207 * 27e3, 1e6);
}

TEST(Pacing, CallerIsNotWokenForEveryLine) {
  Bench bench;
  int timers = 0;
  bench.lateness = [&] {
    ++timers;
    return 0ns;
  };
  bench.command(ping_of(1205));
  bench.run_for(500ms);
  EXPECT_LT(timers, 1205 / 16 + 10);
}

TEST(Pacing, TimersLateByAFewHundredMicrosecondsCostNoTime) {
  std::mt19937 random(1);
  Bench bench;
  bench.lateness = [&] { return std::chrono::nanoseconds(random() % 400'000); };
  const auto sent = one_ping(bench, ping_of(1205));
  expect_paced(sent, 32, wire_period);
  expect_acoustic(sent, 0);
  EXPECT_LE(final_span(sent), 5ms);
  EXPECT_LT(sent.back().at, 1207 * wire_period + 500us);
}

TEST(Pacing, AStallDelaysTheRestByItsLengthWithoutABurst) {
  for (const int stalled_timer : {2, 10, 40}) {
    int timer = 0;
    Bench bench;
    bench.lateness = [&] { return timer++ == stalled_timer ? 20ms : 0ms; };
    const auto sent = one_ping(bench, ping_of(1205));
    expect_paced(sent, 32, wire_period);
    EXPECT_LT(sent.back().at, 1207 * wire_period + 21ms);
  }
}

TEST(Pacing, AStallWhileTheSoundIsSlowerThanTheLinkIsMadeUpFor) {
  int timer = 0;
  Bench bench;
  bench.lateness = [&] { return timer++ == 10 ? 20ms : 0ms; };
  PingConfig config = ping_of(9640);  // x8: one line in 88 us, 106.6 ms in all
  config.range_compression = 3;
  const auto sent = one_ping(bench, config);
  expect_paced(sent, 32, wire_period);
  EXPECT_LT(sent.back().at, 108ms);
}

TEST(Pacing, LastLinesStayTogetherWhenTheSoundIsSlow) {
  std::mt19937 random(2);
  for (const int lines : {320, 576, 592, 20000}) {  // x16: 20, 36, 37, 1250 lines of 177 us
    Bench bench;
    bench.lateness = [&] { return std::chrono::nanoseconds(random() % 500'000); };
    PingConfig config = ping_of(lines);
    config.range_compression = 4;
    const auto sent = one_ping(bench, config);
    expect_acoustic(sent, 4);
    const std::size_t last_36 = std::min<std::size_t>(37, sent.size() - 1);
    EXPECT_LE(sent.back().at - sent[sent.size() - last_36].at, 5ms) << lines;
  }
}

TEST(Pacing, InterPacketGapIsALeastDistance) {
  struct Case {
    std::uint16_t gap;  // units of 8 ns
    std::chrono::nanoseconds distance;
  };
  // Gaps that later clients request on a bad link, a gap shorter than a line anyway, and the greatest gap.
  for (const Case& c : {Case{8000, 64us}, {10000, 80us}, {1000, 27us}, {65535, 524'280ns}}) {
    std::mt19937 random(3);
    Bench bench;
    bench.lateness = [&] { return std::chrono::nanoseconds(random() % 60'000); };
    auto network = to_head<NetworkConfig>();
    network.inter_packet_gap = c.gap;
    bench.command(network);
    const auto sent = one_ping(bench, ping_of(300));
    for (std::size_t i = 1; i < sent.size(); ++i) {
      ASSERT_GE(sent[i].at - sent[i - 1].at, c.distance) << c.gap << ", datagram " << i;
    }
  }
}

TEST(Pacing, GapOfAFewMicrosecondsIsMetWithinABurst) {
  Bench bench;
  auto network = to_head<NetworkConfig>();
  network.inter_packet_gap = 563;  // 4.5 us
  bench.command(network);
  const auto sent = one_ping(bench, ping_of(1205));
  expect_paced(sent, 32, wire_period);
  EXPECT_LT(sent.back().at, 1207 * wire_period + 500us);
}

TEST(Pacing, GapIsForgottenAtReboot) {
  Bench bench;
  auto network = to_head<NetworkConfig>();
  network.inter_packet_gap = 65535;
  bench.command(network);
  bench.command(to_head<Reboot>());
  bench.run_for(6s);
  const std::size_t before = bench.sent.size();
  bench.command(ping_of(1205));
  bench.run_for(1s);
  const auto sent = bench.ping_datagrams(before);
  EXPECT_LT(sent.back().at - sent.front().at, 40ms);
}

TEST(Pacing, ResentLinesArePacedToo) {
  Bench bench;
  bench.command(ping_of(2000));
  bench.run_for(100ms);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 0, 2000));
  bench.run_for(100ms);
  const auto sent = bench.ping_datagrams(before);
  ASSERT_EQ(sent.size(), 2000U);
  expect_paced(sent, 32, wire_period);
}

TEST(Pacing, OtherLinksAndBurstsAreConfigured) {
  DeviceConfig device = example_config();
  device.line_period = 11us;
  device.burst_lines = 4;
  Bench bench(device);
  const auto sent = one_ping(bench, ping_of(1205));
  expect_paced(sent, 4, 11us);
  EXPECT_LT(sent.back().at, 15ms);
}

TEST(Pacer, BurstThenOnePerPeriod) {
  Pacer pacer(27us, 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(pacer.ready(1ms));
    pacer.sent(1ms);
  }
  EXPECT_FALSE(pacer.ready(1ms));
  EXPECT_FALSE(pacer.ready(1ms + 26us));
  EXPECT_TRUE(pacer.ready(1ms + 27us));
  EXPECT_EQ(pacer.earliest(1), 1ms + 27us);
  EXPECT_EQ(pacer.earliest(3), 1ms + 81us);
  pacer.sent(1ms + 27us);
  EXPECT_FALSE(pacer.ready(1ms + 27us));
  EXPECT_TRUE(pacer.ready(2ms));
}

TEST(Pacer, LongGapMeansOneByOne) {
  Pacer pacer(27us, 32);
  pacer.set_gap(64us);
  pacer.sent(1ms);
  EXPECT_FALSE(pacer.ready(1ms + 63us));
  EXPECT_TRUE(pacer.ready(1ms + 64us));
  pacer.sent(5ms);
  EXPECT_FALSE(pacer.ready(5ms));
  pacer.set_gap(0us);
  EXPECT_TRUE(pacer.ready(5ms));
}

}  // namespace
}  // namespace sonard::gemini
