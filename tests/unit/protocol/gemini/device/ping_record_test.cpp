// SPDX-License-Identifier: Apache-2.0
// The record of a ping for logs equals the image that a client decodes.
#include <cmath>

#include "bench.hpp"
#include "protocol/gemini/bearings.hpp"
#include "protocol/gemini/gain_law.hpp"

namespace sonard::gemini {
namespace {

/// Sends one ping of `config` and returns its record.
PingRecord record(Bench& bench, const PingConfig& config) {
  bench.command(config);
  bench.run_for(1s);
  EXPECT_EQ(bench.records.size(), 1U);
  return bench.records.empty() ? PingRecord{} : bench.records[0];
}

/// The samples of ping 0 of test_image(), with `change` applied to each sample.
template <class Change>
std::vector<std::uint8_t> samples_of(int lines, const Change& change) {
  std::vector<std::uint8_t> samples;
  for (int line = 0; line < lines; ++line) {
    for (int beam = 0; beam < beam_count; ++beam) {
      samples.push_back(change(test_sample(0, line, beam)));
    }
  }
  return samples;
}

TEST(PingRecord, IsWhatIsSent) {
  Bench bench;
  bench.command(ping_of(40, RunMode::continuous, 40ms));
  bench.run_connected(2s - 1ms);  // the last ping is complete
  const auto datagrams = bench.ping_datagrams();
  ASSERT_GT(bench.records.size(), 10U);
  ASSERT_EQ(datagrams.size(), 42 * bench.records.size());
  for (std::size_t ping = 0; ping < bench.records.size(); ++ping) {
    const PingRecord& record = bench.records[ping];
    EXPECT_EQ(record.number, ping);
    EXPECT_EQ(record.transmit_time, bench.jobs[ping].transmit_time);
    EXPECT_EQ(record.wire, copy(datagrams[42 * ping].bytes)) << "the head of the ping";
    EXPECT_EQ(record.bits_per_bin, 8);
    ASSERT_EQ(record.samples.size(), 40U * 256U);
    for (std::size_t line = 0; line < 40; ++line) {
      ASSERT_EQ(copy(std::span(record.samples).subspan(256 * line, 256)),
                copy(std::span(datagrams[42 * ping + 1 + line].bytes).subspan(16)))
          << "ping " << ping << ", line " << line;
    }
  }
}

TEST(PingRecord, SaysWhatThePingWasMadeWith) {
  Bench bench;
  PingConfig config = ping_of(2411);
  config.range_compression = 1;
  config.sound_speed = 14'805;
  config.spreading = 67;
  const PingRecord record = gemini::record(bench, config);
  EXPECT_EQ(record.settings.bins, 1205);
  EXPECT_EQ(record.settings.beams, 256);
  EXPECT_DOUBLE_EQ(record.settings.bin_m, 2 * 1480.5 / (2 * 90422.0));
  EXPECT_DOUBLE_EQ(record.settings.sound_speed_mps, 1480.5);
  EXPECT_TRUE(record.settings.sound_speed_from_config);
  EXPECT_EQ(record.settings.gain_percent, gain_percent(67));
  EXPECT_EQ(record.settings.frequency_hz, 723'380.0);
  EXPECT_DOUBLE_EQ(record.sector_rad, 2 * std::acos(-1.0) / 3);
  EXPECT_EQ(record.bearings_rad, bearings_rad(256));
  EXPECT_NEAR(record.bearings_rad.front(), -1.0405, 1e-4) << "port first";
}

TEST(PingRecord, KeepsTheSpeedThatTheClientReckonsWithAndSaysWhoseItIs) {
  DeviceConfig device = example_config();
  device.water_sound_speed_mps = 1480.0;
  Bench told(device);
  PingConfig config = ping_of(100);
  const PingRecord from_config = record(told, config);
  EXPECT_DOUBLE_EQ(from_config.settings.sound_speed_mps, 1500.0);
  EXPECT_DOUBLE_EQ(from_config.settings.bin_m, 1500.0 / (2 * 90422.0)) << "wrong, and what a client shows";
  EXPECT_TRUE(from_config.settings.sound_speed_from_config);

  Bench measured(device);
  config.velocimeter_mode = 0;
  const PingRecord own = record(measured, config);
  EXPECT_DOUBLE_EQ(own.settings.sound_speed_mps, 1480.0);
  EXPECT_FALSE(own.settings.sound_speed_from_config);
}

TEST(PingRecord, SamplesBelowTheThresholdOfTheCodingAreZero) {
  for (const auto& [asked, least] : {std::pair{100, 100}, {1, 3}, {2, 3}, {3, 3}, {255, 255}}) {
    Bench bench;
    PingConfig config = ping_of(40);
    config.rle_threshold = static_cast<std::uint16_t>(asked);
    const std::vector<std::uint8_t> expected = samples_of(
        40, [least = least](std::uint8_t sample) { return sample < least ? std::uint8_t{0} : sample; });
    EXPECT_EQ(record(bench, config).samples, expected) << "threshold " << asked;
  }
}

TEST(PingRecord, SamplesWithoutRunLengthsAreAllKept) {
  Bench bench;
  EXPECT_EQ(record(bench, ping_of(40)).samples, samples_of(40, [](std::uint8_t sample) { return sample; }));
}

TEST(PingRecord, OfSixteenBitsTheHighOnesAreKept) {
  Bench bench;
  PingConfig config = ping_of(40);
  config.ext_mode = 0x0200;
  config.rle_threshold = 50;  // does not apply to 16-bit samples
  const PingRecord record = gemini::record(bench, config);
  EXPECT_TRUE(bench.jobs.at(0).sixteen_bit);
  EXPECT_EQ(record.samples, samples_of(40, [](std::uint8_t sample) { return sample; }));
  EXPECT_EQ(record.bits_per_bin, 8);
  EXPECT_EQ(std::get<PingHead>(decode_report(record.wire).value()).ext_mode, 0x0200) << "as it travelled";
}

TEST(PingRecord, ComesWithTheHeadOfThePing) {
  Bench bench;
  bench.renderer_answers = false;
  bench.command(ping_of(100));
  bench.run_for(20ms);
  EXPECT_TRUE(bench.records.empty()) << "nothing has been sent";
  bench.answer(test_image(bench.jobs.at(0)));
  ASSERT_TRUE(bench.last.record);
  EXPECT_EQ(bench.last.record->transmit_time, 0ns) << "not when the head left";
  EXPECT_EQ(bench.last.send.at(0).bytes[0], 0x41);
  bench.run_for(200ms);
  EXPECT_EQ(bench.records.size(), 1U);
}

TEST(PingRecord, APingRenderedAheadIsRecordedWhenItsHeadLeaves) {
  DeviceConfig device = example_config();
  device.render_lead = 20ms;
  Bench bench(device);
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(99'999us);
  EXPECT_EQ(bench.jobs.size(), 2U);
  EXPECT_EQ(bench.records.size(), 1U);
  bench.run_until(100ms);
  EXPECT_EQ(bench.records.size(), 2U);
}

TEST(PingRecord, ThereIsNoneOfARepetition) {
  Bench bench;
  bench.command(ping_of(100));
  bench.run_for(100ms);
  bench.command(retry_of(RetryKind::head));
  bench.command(retry_of(RetryKind::lines, 0, 100));
  bench.run_for(100ms);
  EXPECT_EQ(bench.device.counters().heads_resent, 1U);
  EXPECT_EQ(bench.records.size(), 1U);
}

TEST(PingRecord, ThereIsNoneOfAPingThatCannotBeRendered) {
  Bench bench;
  bench.renderer_fails = true;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_for(1s);
  EXPECT_GT(bench.device.counters().pings_failed, 5U);
  EXPECT_TRUE(bench.records.empty());
}

}  // namespace
}  // namespace sonard::gemini
