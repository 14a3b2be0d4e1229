// SPDX-License-Identifier: Apache-2.0
// A head in playback sends the pings that it is fed when they are due, whatever the client requests.
#include <algorithm>

#include "bench.hpp"
#include "protocol/gemini/gain_law.hpp"

namespace sonard::gemini {
namespace {

DeviceConfig player() {
  DeviceConfig config = example_config();
  config.plays_back = true;
  return config;
}

/// A recorded ping of 40 lines, each 4 native lines long, at 1480.5 m/s.
ReplayedPing recorded(std::uint64_t record, std::optional<TimePoint> due = std::nullopt) {
  ReplayedPing ping;
  ping.record = record;
  ping.settings = {.bins = 40,
                   .beams = beam_count,
                   .bin_m = 4 * 1480.5 / (2 * line_rate_hz),
                   .sound_speed_mps = 1480.5,
                   .sound_speed_from_config = true,
                   .gain_percent = 31.5,
                   .frequency_hz = carrier_hz};
  ping.due = due;
  return ping;
}

PingImage recorded_image(const PingJob& job) {
  PingImage image;
  image.number = job.number;
  for (int i = 0; i < 40 * beam_count; ++i) {
    image.u8.push_back(static_cast<std::uint8_t>(*job.record + static_cast<std::uint64_t>(i % 251)));
  }
  return image;
}

struct Playback : testing::Test {
  Bench bench{player()};

  Playback() { bench.render = recorded_image; }
};

TEST_F(Playback, ThePingIsTheRecordedOneWhateverIsAskedFor) {
  bench.step(PingFed{recorded(7)});
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
  bench.step(PingFed{recorded(7)});
  PingConfig asked = ping_of(500);
  asked.rle_threshold = 9;
  bench.command(asked);
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.jobs[0].record, 7U);
  EXPECT_EQ(bench.jobs[0].native_bins, 500);
  EXPECT_EQ(bench.jobs[0].gain_percent, gain_percent(asked.spreading));
  std::vector<std::string> kinds;
  for (const Difference& difference : bench.jobs[0].differences) {
    kinds.push_back(difference.kind);
  }
  EXPECT_EQ(kinds, (std::vector<std::string>{"range", "compression", "gain", "sound_speed", "run_lengths"}));
  bench.run_for(100ms);
  ASSERT_EQ(bench.records.size(), 1U);
  EXPECT_EQ(bench.records[0].settings, recorded(7).settings) << "what is recorded again is what was sent";
}

TEST_F(Playback, TimesOfTheRecordingCountNotTheIntervalAskedFor) {
  bench.command(ping_of(64, RunMode::continuous, 500ms));
  for (std::uint64_t k = 0; k < 4; ++k) {
    bench.step(PingFed{recorded(k, 100ms + 120ms * k)});
    bench.run_until(100ms + 120ms * k + 60ms);
  }
  const auto heads = bench.all<PingHead>();
  ASSERT_EQ(heads.size(), 4U);
  for (std::uint64_t k = 0; k < 4; ++k) {
    EXPECT_EQ(heads[k].second.transmit_time_us, 100'000U + 120'000U * k);
  }
}

TEST_F(Playback, WithoutTimesTheIntervalCounts) {
  bench.step(PingFed{recorded(0)});
  bench.command(ping_of(64, RunMode::continuous, 500ms));
  bench.step(PingFed{recorded(1)});
  bench.run_for(499ms);
  EXPECT_EQ(bench.count(MessageType::ping_head), 1U);
  bench.run_for(1ms);
  EXPECT_EQ(bench.count(MessageType::ping_head), 2U);
}

TEST_F(Playback, OutOfTheWaterAPingIsKept) {
  bench.step(PingFed{recorded(7)});
  bench.set_out_of_water(true);
  PingConfig obedient = ping_of(64, RunMode::continuous, 100ms);
  obedient.ext_mode = 0x0004;
  bench.command(obedient);
  bench.run_for(1s);
  EXPECT_TRUE(bench.jobs.empty());
  bench.set_out_of_water(false);
  bench.run_for(200ms);
  ASSERT_EQ(bench.jobs.size(), 1U) << "its job has not been out";
  EXPECT_EQ(bench.jobs[0].record, 7U);
}

TEST_F(Playback, ARecordingWithoutAGainLeavesThatOfTheClient) {
  ReplayedPing ping = recorded(7);
  ping.settings.gain_percent = -1.0;
  bench.step(PingFed{ping});
  PingConfig asked = ping_of(64);
  bench.command(asked);
  bench.run_for(100ms);
  ASSERT_EQ(bench.records.size(), 1U);
  EXPECT_EQ(bench.records[0].settings.gain_percent, gain_percent(asked.spreading));
}

TEST_F(Playback, LostLinesAreSentAgain) {
  bench.step(PingFed{recorded(3)});
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
