// SPDX-License-Identifier: Apache-2.0
// A head that plays back: it sends what it is offered, when that is due, whatever the surface asks for.
#include <algorithm>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

DeviceConfig player() {
  DeviceConfig config = example_config();
  config.plays_back = true;
  return config;
}

/// 40 lines of 4 native ones at 1480.5 m/s.
RecordedPing recorded(std::uint64_t record, std::optional<TimePoint> due = std::nullopt) {
  return {.record = record,
          .lines = 40,
          .compression_log2 = 2,
          .sound_speed_mps = 1480.5,
          .sound_speed_from_config = true,
          .gain_percent = 31.5,
          .due = due};
}

PingImage recorded_image(const PingJob& job) {
  PingImage image;
  image.ping_number = job.ping_number;
  for (int i = 0; i < 40 * beam_count; ++i) {
    image.u8.push_back(static_cast<std::uint8_t>(*job.record + static_cast<std::uint64_t>(i % 251)));
  }
  return image;
}

struct Playback : testing::Test {
  Bench bench{player()};

  Playback() { bench.render = recorded_image; }
};

TEST_F(Playback, NothingIsSentThatIsNotOffered) {
  bench.command(ping_of(64));
  bench.run_connected(2s);
  EXPECT_TRUE(bench.ping_datagrams().empty());
  bench.device.offer(recorded(7));
  bench.command(to_head<StatusRequest>());
  bench.run_for(100ms);
  EXPECT_EQ(bench.count(MessageType::ping_tail), 1U);
}

TEST_F(Playback, ThePingIsTheRecordedOneWhateverIsAskedFor) {
  bench.device.offer(recorded(7));
  PingConfig asked = ping_of(500);
  asked.ext_mode = 0x0200;  // 16 bit
  asked.range_compression = 0;
  asked.rle_threshold = 9;
  asked.sound_speed = 15000;
  asked.velocimeter_mode = 1;
  bench.command(asked);
  bench.run_for(1s);
  const auto heads = bench.all<PingHead>();
  ASSERT_EQ(heads.size(), 1U);
  const PingHead& head = heads[0].second;
  EXPECT_TRUE(head.eight_bit());
  EXPECT_EQ(head.end_range, 160);
  EXPECT_EQ(head.range_compression, 2);
  EXPECT_EQ(head.line_count(), 40);
  EXPECT_EQ(head.rle_threshold, 0);
  EXPECT_EQ(head.sound_speed_used, 0x8000 | 14805);
  const auto datagrams = bench.ping_datagrams();
  ASSERT_EQ(datagrams.size(), 42U);
  const PingImage image = recorded_image(bench.jobs.at(0));
  for (std::size_t line = 0; line < 40; ++line) {
    EXPECT_TRUE(std::ranges::equal(std::span(datagrams[1 + line].bytes).subspan(16),
                                   std::span(image.u8).subspan(256 * line, 256)))
        << "line " << line;
  }
}

TEST_F(Playback, TheJobSaysWhatWasAskedForAndWhichRecordAnswers) {
  bench.device.offer(recorded(7));
  PingConfig asked = ping_of(500);
  asked.rle_threshold = 9;
  bench.command(asked);
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.jobs[0].record, 7U);
  EXPECT_EQ(bench.jobs[0].recorded_gain_percent, 31.5);
  EXPECT_EQ(bench.jobs[0].native_lines, 500);
  EXPECT_EQ(bench.jobs[0].rle_threshold, 9);
}

TEST_F(Playback, APingLeavesWhenItIsDue) {
  bench.device.offer(recorded(0, 700ms));
  bench.command(ping_of(64));
  bench.run_for(699ms);
  EXPECT_EQ(bench.count(MessageType::ping_head), 0U);
  bench.run_for(1ms);
  const auto heads = bench.all<PingHead>();
  ASSERT_EQ(heads.size(), 1U);
  EXPECT_EQ(heads[0].second.transmit_time_us, 700'000U);
}

TEST_F(Playback, OneThatIsLateLeavesAtOnce) {
  bench.run_until(900ms);
  bench.device.offer(recorded(0, 700ms));
  bench.command(ping_of(64));
  bench.run_for(50ms);
  const auto heads = bench.all<PingHead>();
  ASSERT_EQ(heads.size(), 1U);
  EXPECT_EQ(heads[0].second.transmit_time_us, 900'000U);
}

TEST_F(Playback, TimesOfTheRecordingCountNotTheIntervalAskedFor) {
  bench.command(ping_of(64, RunMode::continuous, 500ms));
  for (std::uint64_t k = 0; k < 4; ++k) {
    bench.device.offer(recorded(k, 100ms + 120ms * k));
    bench.command(to_head<StatusRequest>());
    bench.run_until(100ms + 120ms * k + 60ms);
  }
  const auto heads = bench.all<PingHead>();
  ASSERT_EQ(heads.size(), 4U);
  for (std::uint64_t k = 0; k < 4; ++k) {
    EXPECT_EQ(heads[k].second.transmit_time_us, 100'000U + 120'000U * k);
  }
}

TEST_F(Playback, WithoutTimesTheIntervalCounts) {
  bench.device.offer(recorded(0));
  bench.command(ping_of(64, RunMode::continuous, 500ms));
  bench.device.offer(recorded(1));
  bench.run_for(499ms);
  EXPECT_EQ(bench.count(MessageType::ping_head), 1U);
  bench.run_for(1ms);
  EXPECT_EQ(bench.count(MessageType::ping_head), 2U);
}

TEST_F(Playback, LostLinesAreSentAgain) {
  bench.device.offer(recorded(3));
  bench.command(ping_of(64));
  bench.run_for(100ms);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 5, 2));
  bench.run_for(10ms);
  const auto lines = bench.ping_datagrams(before);
  ASSERT_EQ(lines.size(), 2U);
  const PingImage image = recorded_image(bench.jobs.at(0));
  EXPECT_TRUE(
      std::ranges::equal(std::span(lines[0].bytes).subspan(16), std::span(image.u8).subspan(256 * 5, 256)));
}

}  // namespace
}  // namespace sonard::gemini
