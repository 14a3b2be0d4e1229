// SPDX-License-Identifier: Apache-2.0
// Fields and samples of a line, and the job for the renderer (protocol/micron/README.md 4, 6.3).
#include <tuple>

#include "bench.hpp"
#include "protocol/micron/recorded_form.hpp"

namespace sonard::micron {
namespace {

TEST(Line, IsThePublishedFrame) {
  // Section 10: 8 bins, bearing 3232, the second line of a scan to the right.
  Bench bench;
  HeadCommand command;
  command.bins = 8;
  bench.render = [](const PingJob& job) {
    return PingImage{job.number, {176, 64, 10, 18, 20, 230, 64, 10}, {}};
  };
  bench.make_ready(command);
  bench.raw(fixture("send_data"));
  bench.run_for(500ms);
  ASSERT_EQ(bench.sent.size(), 2U);
  EXPECT_EQ(bench.sent[1].bytes, fixture("head_data"));
  ASSERT_EQ(bench.records.size(), 2U);
  EXPECT_EQ(bench.records[1].number, 1U);
  EXPECT_EQ(bench.records[1].bits_per_bin, 8);
  EXPECT_TRUE(recorded_line(bench.records[1].wire)->eight_bit());
  EXPECT_EQ(bench.records[1].samples, (Bytes{176, 64, 10, 18, 20, 230, 64, 10}));
}

TEST(Line, Of4BitsIsThePublishedFrame) {
  // The right limit of a sector; amplitudes that AD low 40 and AD span 77 map to 15 8 1 0 0 10 4 0.
  Bench bench;
  HeadCommand command = sector(2400, 4000, 16);
  command.control = 0x2304;
  command.ad_span = 77;
  command.ad_low = 40;
  command.bins = 8;
  bench.render = [](const PingJob& job) {
    return PingImage{job.number, {200, 79, 45, 40, 0, 89, 60, 44}, {}};
  };
  bench.make_ready(command);
  const auto lines = bench.scan(51);
  EXPECT_EQ(encode(lines.back()), fixture("head_data_4_bit"));
  EXPECT_EQ(bench.records.back().bits_per_bin, 4);
  EXPECT_FALSE(recorded_line(bench.records.back().wire)->eight_bit());
  EXPECT_EQ(bench.records.back().samples, (Bytes{15, 8, 1, 0, 0, 10, 4, 0}));
}

TEST(Line, OfTheRockDriverBeginsAsRecorded) {
  Bench bench;
  bench.run_until(10s);
  bench.raw(fixture("head_command_rock"));
  bench.run_for(1s);
  bench.sent.clear();
  const auto lines = bench.scan(84);
  const Bytes bytes = encode(lines.back());
  // Section 10, first 40 of 245 bytes, before the bearing: 200 bins.
  const Bytes expected{0x40, 0x30, 0x30, 0x45, 0x46, 0xEF, 0x00, 0x02, 0xFF, 0x00, 0x02, 0x80, 0x02, 0xE7,
                       0x00, 0x11, 0x10, 0x00, 0x83, 0x23, 0x64, 0x00, 0x00, 0x00, 0x00, 0x00, 0x54, 0x00,
                       0x00, 0x51, 0x08, 0x00, 0x00, 0x68, 0x00, 0x00, 0x00, 0x00, 0x00, 0x58};
  ASSERT_EQ(bytes.size(), 245U);
  EXPECT_EQ(Bytes(bytes.begin(), bytes.begin() + 40), expected);
  EXPECT_EQ(bytes[42], 0xC8);
}

TEST(Line, EchoesWhateverTheClientSaid) {
  HeadCommand command = sector(2500, 3900);
  command.control = 0x2381;
  command.head_type = 2;
  command.tx_word = {0x05666666, 1};
  command.range_scale = 0x4123;
  command.ad_span = 81;
  command.ad_low = 8;
  command.gain = {84, 1};
  command.slope = {125, 1};
  command.ad_interval = 104;
  command.step = 88;
  command.gain_block = GainBlock{.ad_span = {9, 9}, .ad_low = {9, 9}, .gain = {9, 9}, .slope = {9, 9}};
  Bench bench;
  bench.make_ready(command);
  const HeadData line = bench.scan(1)[0];
  EXPECT_EQ(line.device_type, 0x11);
  EXPECT_EQ(line.status, 0x10);
  EXPECT_EQ(line.control, 0x2381);
  EXPECT_EQ(line.range_scale, 0x4123);
  EXPECT_EQ(line.tx_word, 0x05666666U);
  EXPECT_EQ(line.gain, 84);
  EXPECT_EQ(line.slope, 125);
  EXPECT_EQ(line.ad_span, 81) << "not that of the gain block";
  EXPECT_EQ(line.ad_low, 8);
  EXPECT_EQ(line.heading_offset, 0);
  EXPECT_EQ(line.ad_interval, 104);
  EXPECT_EQ(line.left_limit, 2500);
  EXPECT_EQ(line.right_limit, 3900);
  EXPECT_EQ(line.step, 88);
}

TEST(Line, HoldsTheSamplesAsRenderedEvenWhereTheClientSentALongLockout) {
  Bench bench;
  bench.run_until(10s);
  bench.raw(fixture("head_command_rock"));  // lockout 13333 us, which would blank 10 m
  bench.run_for(1s);
  bench.sent.clear();
  const HeadData line = bench.scan(1)[0];
  ASSERT_EQ(line.data.size(), 200U);
  for (std::size_t bin = 0; bin < 200; ++bin) {
    ASSERT_EQ(line.data[bin], test_sample(0, bin));
  }
}

TEST(Line, Of4BitsWithAnOddNumberOfBinsInEitherOrder) {
  for (const NibbleOrder order : {NibbleOrder::high_first, NibbleOrder::low_first}) {
    DeviceConfig config;
    config.nibble_order = order;
    Bench bench(config);
    HeadCommand command = all_round();
    command.control = 0x2306;
    command.bins = 3;
    command.ad_low = 0;
    command.ad_span = 255;
    bench.render = [](const PingJob& job) { return PingImage{job.number, {16, 128, 255}, {}}; };
    bench.make_ready(command);
    const HeadData line = bench.scan(1)[0];
    EXPECT_EQ(line.status, 0);
    EXPECT_EQ(Bytes(line.data.begin(), line.data.end()),
              order == NibbleOrder::high_first ? (Bytes{0x18, 0xF0}) : (Bytes{0x81, 0x0F}));
  }
}

TEST(Line, GainCommandShowsInTheNextOneAndStopsNothing) {
  Bench bench;
  bench.make_ready(all_round());
  const int before = bench.scan(2).back().bearing;
  bench.run_for(1s);
  const int last = bench.all<HeadData>().back().second.bearing;
  EXPECT_GT(last, before);
  bench.raw(fixture("gain"));
  const TimePoint asked = bench.now;
  const HeadData line = bench.scan(1)[0];
  EXPECT_LT(bench.now - asked, 100ms);
  EXPECT_EQ(line.ad_span, 63);
  EXPECT_EQ(line.ad_low, 15);
  EXPECT_EQ(line.gain, 84);
  EXPECT_EQ(line.slope, 100);
  EXPECT_EQ(line.bearing, last + 32);
  EXPECT_DOUBLE_EQ(bench.jobs.back().gain_db, 32.0);
}

TEST(Line, TellsALostStepUntilNewParametersCome) {
  Bench bench;
  bench.make_ready(all_round());
  bench.device.lose_step();
  EXPECT_EQ(bench.scan(1)[0].status, 0x12);
  bench.run_for(1s);
  bench.command(all_round());
  bench.run_for(1s);
  EXPECT_EQ(bench.scan(1)[0].status, 0x10);
}

TEST(Job, IsTheParametersInSiUnits) {
  Bench bench;
  bench.run_until(10s);
  bench.raw(fixture("head_command_rock"));
  bench.command(SendData{});
  bench.run_for(1s);
  const PingJob& job = bench.jobs.at(0);
  EXPECT_EQ(job.number, 0U);
  EXPECT_DOUBLE_EQ(job.bearing_rad, 0.0);
  EXPECT_EQ(job.bins(), 200);
  EXPECT_EQ(job.native_bins, 200);
  EXPECT_EQ(job.compression_log2, 0);
  EXPECT_EQ(job.listening_time, 200 * 66'560ns);
  EXPECT_GT(job.period, job.listening_time);
  EXPECT_DOUBLE_EQ(job.bin_m(), 104 * 0.48e-3);
  EXPECT_NEAR(job.range_m(), 9.984, 1e-12);
  EXPECT_DOUBLE_EQ(job.gain_db, 32.0);
  EXPECT_DOUBLE_EQ(job.gain_percent, 40.0);
  EXPECT_EQ(setting(job, "window"), "2.5+25.4dB") << "AD low and AD span";
  EXPECT_EQ(setting(job, "bits"), "8");
  EXPECT_FALSE(job.sixteen_bit);
  EXPECT_TRUE(job.transmit);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0].second.bearing, 3200);
  EXPECT_EQ(lines[1].second.bearing, 3112) << "5 degrees to the left";
  EXPECT_NEAR(bench.jobs.at(1).bearing_rad * 180 / std::numbers::pi, -4.95, 1e-9);
}

TEST(Job, UsesTheTrueSpeedOfSound) {
  DeviceConfig config;
  config.water_sound_speed_mps = 1450.0;
  Bench bench(config);
  bench.make_ready(all_round());
  bench.command(SendData{});
  EXPECT_DOUBLE_EQ(bench.jobs.at(0).bin_m(), 53 * 640e-9 * 1450.0 / 2);
}

TEST(Job, AsksForNoiseOnlyWithTheTransmitterOff) {
  Bench bench;
  HeadCommand command = all_round();
  command.control |= control_bits::transmit_off;
  bench.make_ready(command);
  bench.command(SendData{});
  EXPECT_FALSE(bench.jobs.at(0).transmit);
}

TEST(Job, KeepsToWhatAHeadCanDo) {
  for (const auto& [bins, interval, jobs_bins] : {std::tuple{0, 0, 1}, std::tuple{60'000, 1, 1500}}) {
    Bench bench;
    HeadCommand command = all_round();
    command.bins = static_cast<std::uint16_t>(bins);
    command.ad_interval = static_cast<std::uint16_t>(interval);
    bench.make_ready(command);
    const HeadData line = bench.scan(1)[0];
    EXPECT_EQ(line.data.size(), static_cast<std::size_t>(jobs_bins));
    EXPECT_EQ(line.ad_interval, interval) << "echoed as it came";
    EXPECT_EQ(bench.jobs[0].listening_time, jobs_bins * 640ns);
    EXPECT_DOUBLE_EQ(bench.jobs[0].bin_m(), 640e-9 * 1500.0 / 2);
  }
}

}  // namespace
}  // namespace sonard::micron
