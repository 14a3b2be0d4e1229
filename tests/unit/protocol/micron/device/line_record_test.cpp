// SPDX-License-Identifier: Apache-2.0
// The record of a line for logs, and the line that is made from a record.

#include "bench.hpp"
#include "protocol/micron/recorded_form.hpp"
#include "tests/support/degree.hpp"

namespace sonard::micron {
namespace {

HeadData without_data(HeadData line) {
  line.data = {};
  return line;
}

TEST(LineRecord, IsTheLineThatWasSent) {
  DeviceConfig config;
  config.node = 7;
  Bench bench(config);
  bench.make_ready(all_round());
  const std::vector<HeadData> lines = bench.scan(50);
  ASSERT_GE(bench.records.size(), 50U);
  for (std::size_t i = 0; i < 50; ++i) {
    const PingRecord& record = bench.records[i];
    EXPECT_EQ(record.number, i);
    EXPECT_EQ(record.transmit_time, bench.jobs[i].transmit_time);
    EXPECT_EQ(record.samples, Bytes(lines[i].data.begin(), lines[i].data.end()));
    EXPECT_EQ(record.bits_per_bin, 8);
    EXPECT_EQ(record.bearings_rad, std::vector<double>{bench.jobs[i].bearing_rad});
    EXPECT_EQ(recorded_line(record.wire), without_data(lines[i]));
    EXPECT_EQ(record.wire, recorded_wire(lines[i], 7));
  }
}

TEST(LineRecord, ItsWireIsAWholeFrameOfTheHeadWithoutData) {
  DeviceConfig config;
  config.node = 7;
  Bench bench(config);
  bench.make_ready(all_round());
  bench.scan(1);
  const Bytes& wire = bench.records.at(0).wire;
  EXPECT_EQ(next_frame(wire, max_report_frame_size), static_cast<std::ptrdiff_t>(wire.size()));
  EXPECT_EQ(frame_header(wire).tx_node, 7);
  EXPECT_EQ(frame_header(wire).node, 7);
  EXPECT_EQ(frame_header(wire).type, 2);
  const Bytes& sent = bench.sent.at(0).bytes;
  EXPECT_EQ(wire.size(), sent.size() - 20) << "20 bins of 8 bits";
}

TEST(LineRecord, SaysWhatTheLineWasMadeWith) {
  DeviceConfig config;
  config.water_sound_speed_mps = 1450.0;
  Bench bench(config);
  HeadCommand command = all_round();
  command.gain[0] = 84;
  bench.make_ready(command);
  bench.scan(2);
  const RecordedSettings& settings = bench.records.at(1).settings;
  EXPECT_EQ(settings.bins, 20);
  EXPECT_EQ(settings.beams, 1);
  EXPECT_DOUBLE_EQ(settings.bin_m, 53 * 640e-9 * 1450.0 / 2);
  EXPECT_EQ(settings.sound_speed_mps, 1450.0);
  EXPECT_TRUE(settings.sound_speed_from_config);
  EXPECT_DOUBLE_EQ(settings.gain_percent, 40.0);
  EXPECT_EQ(settings.frequency_hz, 700'000.0);
  EXPECT_EQ(bench.records.at(1).sector_rad, 0.0) << "a scanning head";
  ASSERT_EQ(bench.records.at(1).bearings_rad.size(), 1U);
  EXPECT_NEAR(bench.records.at(1).bearings_rad[0], 1.8 * degree, 1e-12) << "to starboard";
}

TEST(LineRecord, LooksWhereTheBeamLookedAndSaysWhatTheHeadSaid) {
  DeviceConfig config;
  config.mounted_inverted = true;  // the client ignores the mounting
  Bench bench(config);
  bench.make_ready(sector(3520, 4800));
  const HeadData line = bench.scan(1)[0];
  EXPECT_EQ(line.bearing, 3520);
  EXPECT_NEAR(bench.records.at(0).bearings_rad.at(0), -18 * degree, 1e-12);
  EXPECT_EQ(recorded_line(bench.records.at(0).wire)->bearing, 3520);
}

TEST(LineRecord, Of4BitsHasValuesUpTo15) {
  Bench bench;
  HeadCommand command = all_round();
  command.control = 0x2306;
  command.bins = 5;
  bench.render = [](const PingJob& job) { return PingImage{job.number, {0, 16, 32, 255, 128}, {}}; };
  bench.make_ready(command);
  bench.scan(1);
  EXPECT_EQ(bench.records.at(0).bits_per_bin, 4);
  EXPECT_EQ(bench.records.at(0).samples, (Bytes{0, 1, 2, 15, 8})) << "not packed";
  EXPECT_EQ(bench.records.at(0).settings.bins, 5);
}

TEST(LineRecord, HasTheStatusThatTheLineHad) {
  Bench bench;
  bench.make_ready(all_round());
  bench.device.lose_step();
  bench.scan(1);
  EXPECT_EQ(recorded_line(bench.records.at(0).wire)->status, 0x12);
}

TEST(LineRecord, HasTheSettingsThatThePingWasMadeWith) {
  Bench bench;
  bench.make_ready(all_round());
  bench.command(SendData{});
  bench.raw(fixture("gain"));  // arrives while the head listens, so the next line shows it
  bench.run_for(1s);
  ASSERT_EQ(bench.records.size(), 2U);
  EXPECT_DOUBLE_EQ(bench.records[0].settings.gain_percent, 50.0);
  EXPECT_EQ(recorded_line(bench.records[0].wire)->gain, 105);
  EXPECT_DOUBLE_EQ(bench.records[1].settings.gain_percent, 40.0);
  EXPECT_EQ(recorded_line(bench.records[1].wire)->gain, 84);
}

TEST(LineRecord, ComesWithTheLine) {
  Bench bench;
  bench.make_ready(all_round());
  bench.command(SendData{});
  bench.run_for(1us);  // rendered, but the head still listens
  EXPECT_TRUE(bench.records.empty());
  std::size_t lines = 0;
  while (lines < 2) {
    bench.run_once();
    const bool line_left =
        std::ranges::any_of(bench.last.send, [](const Outgoing& frame) { return frame.bytes[10] == 2; });
    lines += line_left ? 1 : 0;
    EXPECT_EQ(bench.last.record.has_value(), line_left);
  }
}

TEST(LineRecord, ThereIsNoneOfAPingThatFailsOrIsCancelled) {
  Bench bench;
  bench.make_ready(all_round());
  bench.renderer_fails = true;
  bench.command(SendData{});
  bench.run_for(1s);
  EXPECT_EQ(bench.device.counters().pings_failed, 2U);
  bench.renderer_answers = false;
  bench.command(SendData{});
  bench.command(Reboot{});
  bench.run_for(10s);
  EXPECT_EQ(bench.device.counters().pings_cancelled, 1U);
  EXPECT_TRUE(bench.records.empty());
}

}  // namespace
}  // namespace sonard::micron
