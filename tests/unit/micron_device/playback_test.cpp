// SPDX-License-Identifier: Apache-2.0
// A head that plays back: it sends what it is offered, when that is due, whatever the host asks for.
#include "bench.hpp"

namespace sonard::micron {
namespace {

DeviceConfig player() {
  DeviceConfig config;
  config.plays_back = true;
  return config;
}

/// 30 bins of 8 bits, at 1000, from a sector that no test asks for; 30 * 100 * 640 ns of listening: 1.92 ms.
RecordedLine recorded(std::uint64_t record, std::optional<TimePoint> due = std::nullopt) {
  RecordedLine line;
  line.record = record;
  line.line.status = head_status_bits::eight_bit;
  line.line.sweep = SweepCode::left_limit;
  line.line.control = 0x2301;
  line.line.range_scale = 0x4123;
  line.line.gain = 77;
  line.line.ad_interval = 100;
  line.line.left_limit = 1000;
  line.line.right_limit = 1200;
  line.line.step = 7;
  line.line.bearing = 1000;
  line.bins = 30;
  line.bearing_rad = 2.16;  // mounted boot down: on the other side
  line.sound_speed_mps = 1480.0;
  line.due = due;
  return line;
}

struct MicronPlayback : ::testing::Test {
  Bench bench{player()};
  MicronPlayback() { bench.make_ready(all_round()); }
};

TEST_F(MicronPlayback, nothing_is_sent_that_is_not_offered_or_not_asked_for) {
  bench.command(SendData{});
  bench.run_for(3s);
  EXPECT_TRUE(bench.all<HeadData>().empty());
  EXPECT_FALSE(bench.all<Alive>().empty()) << "it lives all the same";

  Bench unasked{player()};
  unasked.make_ready(all_round());
  unasked.device.offer(recorded(0));
  unasked.run_for(3s);
  EXPECT_TRUE(unasked.all<HeadData>().empty());
}

TEST_F(MicronPlayback, the_line_is_the_recorded_one_whatever_is_asked_for) {
  bench.device.offer(recorded(5));
  bench.command(SendData{});
  bench.run_for(100ms);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 1U) << "of the two that were asked for one was offered";
  Bytes bins(30);
  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    bins[bin] = test_sample(bench.jobs.at(0).ping_number, bin);
  }
  HeadData expected = recorded(5).line;
  expected.data = bins;
  EXPECT_EQ(lines[0].second, expected);
  ASSERT_EQ(bench.sent_lines.size(), 1U);
  EXPECT_EQ(bench.sent_lines[0].line, recorded(5).line);
  EXPECT_EQ(bench.sent_lines[0].bins, bins);
}

TEST_F(MicronPlayback, the_job_is_what_the_line_was_made_with) {
  bench.device.offer(recorded(5));
  bench.command(SendData{});
  ASSERT_EQ(bench.jobs.size(), 1U);
  const MicronJob& job = bench.jobs[0];
  EXPECT_EQ(job.record, 5U);
  EXPECT_EQ(job.bins, 30);
  EXPECT_EQ(job.bearing, 1000);
  EXPECT_EQ(job.bearing_rad, 2.16);
  EXPECT_EQ(job.sound_speed_mps, 1480.0);
  EXPECT_DOUBLE_EQ(job.bin_length_m, 100 * 640e-9 * 1480.0 / 2.0);
  EXPECT_EQ(bench.device.parameters()->bins, 20) << "what the host asks for";
}

TEST_F(MicronPlayback, bins_of_4_bits_travel_as_they_did) {
  RecordedLine line = recorded(0);
  line.line.control = 0x2300;
  line.line.status = 0;
  line.bins = 5;
  bench.render = [](const MicronJob& job) { return MicronLine{job.ping_number, {15, 0, 7, 8, 1}}; };
  bench.device.offer(line);
  bench.command(SendData{});
  bench.run_for(100ms);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(Bytes(lines[0].second.data.begin(), lines[0].second.data.end()), (Bytes{0xF0, 0x78, 0x10}));
}

TEST_F(MicronPlayback, a_line_is_made_when_it_is_due_and_leaves_when_its_echoes_are_in) {
  const TimePoint due = bench.now + 700ms;
  bench.device.offer(recorded(0, due));
  bench.command(SendData{});
  bench.run_for(2s);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(bench.jobs.at(0).transmit_time, due);
  EXPECT_EQ(lines[0].first, due + 1920us);
}

TEST_F(MicronPlayback, lines_come_as_close_as_the_host_asks_for_them) {
  std::uint64_t record = 0;
  bench.device.offer(recorded(record));
  bench.command(SendData{});
  const TimePoint begin = bench.now;
  while (bench.sent_lines.size() < 10 && bench.now < begin + 1s) {
    const std::size_t before = bench.sent_lines.size();
    bench.run_once();
    if (bench.sent_lines.size() > before) {
      bench.device.offer(recorded(++record));
      bench.command(SendData{});
    }
  }
  ASSERT_EQ(bench.sent_lines.size(), 10U);
  EXPECT_EQ(bench.now - begin, 10 * 1920us) << "neither turning nor a line of 115200 baud takes time";
}

TEST_F(MicronPlayback, new_parameters_do_not_cost_a_line_that_has_begun) {
  bench.renderer_answers = false;
  bench.device.offer(recorded(3));
  bench.command(SendData{});
  bench.command(all_round(64));
  EXPECT_EQ(bench.device.called_off(), std::nullopt);
  bench.answer({bench.jobs.at(0).ping_number, Bytes(30, 9)});
  bench.run_for(1s);
  EXPECT_EQ(bench.all<HeadData>().size(), 1U);
  EXPECT_EQ(bench.device.counters().pings_cancelled, 0U);
}

}  // namespace
}  // namespace sonard::micron
