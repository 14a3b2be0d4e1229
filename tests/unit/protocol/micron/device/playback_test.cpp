// SPDX-License-Identifier: Apache-2.0
// A head in playback sends the lines that it is fed when they are due, whatever the client requests.
#include "bench.hpp"
#include "protocol/micron/recorded_form.hpp"

namespace sonard::micron {
namespace {

DeviceConfig player() {
  DeviceConfig config;
  config.plays_back = true;
  return config;
}

/// A line of 8 bits at bearing 1000, from a sector that no test requests.
HeadData recorded_head_data() {
  HeadData line;
  line.status = head_status_bits::eight_bit;
  line.sweep = SweepCode::left_limit;
  line.control = 0x2301;
  line.range_scale = 0x4123;
  line.gain = 77;
  line.ad_interval = 100;
  line.left_limit = 1000;
  line.right_limit = 1200;
  line.step = 7;
  line.bearing = 1000;
  return line;
}

/// A recorded line of 30 bins. It listens for 30 * 100 * 640 ns = 1.92 ms.
ReplayedPing recorded(std::uint64_t record, std::optional<TimePoint> due = std::nullopt,
                      const HeadData& line = recorded_head_data()) {
  ReplayedPing ping;
  ping.record = record;
  ping.settings = {.bins = 30, .beams = 1, .bin_m = 100 * 640e-9 * 1480.0 / 2.0, .sound_speed_mps = 1480.0};
  ping.bearing_rad = 2.16;  // mounted boot down, so the bearing is mirrored
  ping.wire = recorded_wire(line, default_head_node);
  ping.due = due;
  return ping;
}

struct MicronPlayback : ::testing::Test {
  Bench bench{player()};
  MicronPlayback() { bench.make_ready(all_round()); }
};

TEST_F(MicronPlayback, AHeadThatIsFedNothingLivesAllTheSame) {
  bench.command(SendData{});
  bench.run_for(3s);
  EXPECT_TRUE(bench.all<HeadData>().empty());
  EXPECT_FALSE(bench.all<Alive>().empty());
}

TEST_F(MicronPlayback, TheLineIsTheRecordedOneWhateverIsAskedFor) {
  bench.step(PingFed{recorded(5)});
  bench.command(SendData{});
  bench.run_for(100ms);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 1U) << "of the two that were asked for one was fed";
  Bytes bins(30);
  for (std::size_t bin = 0; bin < bins.size(); ++bin) {
    bins[bin] = test_sample(bench.jobs.at(0).number, bin);
  }
  HeadData expected = recorded_head_data();
  expected.data = bins;
  EXPECT_EQ(lines[0].second, expected);
  ASSERT_EQ(bench.records.size(), 1U);
  EXPECT_EQ(bench.records[0].wire, recorded(5).wire) << "what is recorded again is what was sent";
  EXPECT_EQ(bench.records[0].samples, bins);
  EXPECT_EQ(bench.records[0].bits_per_bin, 8);
  EXPECT_EQ(bench.records[0].bearings_rad, std::vector<double>{2.16});
}

TEST_F(MicronPlayback, TheJobIsWhatTheLineWasMadeWith) {
  bench.step(PingFed{recorded(5)});
  bench.command(SendData{});
  ASSERT_EQ(bench.jobs.size(), 1U);
  const PingJob& job = bench.jobs[0];
  EXPECT_EQ(job.record, 5U);
  EXPECT_EQ(job.bins(), 30);
  EXPECT_EQ(job.bearing_rad, 2.16);
  EXPECT_EQ(job.sound_speed_mps, 1480.0);
  EXPECT_DOUBLE_EQ(job.bin_m(), 100 * 640e-9 * 1480.0 / 2.0);
  EXPECT_EQ(job.listening_time, 1920us);
  EXPECT_DOUBLE_EQ(job.gain_db, 77 * 80.0 / 210);
  EXPECT_EQ(setting(job, "bits"), "8");
  EXPECT_EQ(setting(job, "scan"), "") << "what the client asks for is not what is sent";
}

TEST_F(MicronPlayback, TheJobSaysHowItDiffersFromWhatIsAskedFor) {
  bench.step(PingFed{recorded(5)});
  bench.command(SendData{});
  ASSERT_EQ(bench.jobs.size(), 1U);
  std::vector<std::string> kinds;
  for (const Difference& difference : bench.jobs[0].differences) {
    kinds.push_back(difference.kind);
  }
  EXPECT_EQ(kinds, (std::vector<std::string>{"range", "bins", "gain", "sector", "step"}));
  EXPECT_EQ(bench.jobs[0].differences.at(1).text, "20 bins requested, 30 sent");
}

TEST_F(MicronPlayback, BinsOf4BitsTravelAsTheyDid) {
  HeadData line = recorded_head_data();
  line.control = 0x2300;
  line.status = 0;
  ReplayedPing ping = recorded(0, std::nullopt, line);
  ping.settings.bins = 5;
  ping.bits_per_bin = 4;
  bench.render = [](const PingJob& job) { return PingImage{job.number, {15, 0, 7, 8, 1}, {}}; };
  bench.step(PingFed{ping});
  bench.command(SendData{});
  bench.run_for(100ms);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(Bytes(lines[0].second.data.begin(), lines[0].second.data.end()), (Bytes{0xF0, 0x78, 0x10}));
  ASSERT_EQ(bench.records.size(), 1U);
  EXPECT_EQ(bench.records[0].samples, (Bytes{15, 0, 7, 8, 1}));
  EXPECT_EQ(bench.records[0].bits_per_bin, 4);
}

TEST_F(MicronPlayback, ALineIsMadeWhenItIsDueAndLeavesWhenItsEchoesAreIn) {
  const TimePoint due = bench.now + 700ms;
  bench.step(PingFed{recorded(0, due)});
  bench.command(SendData{});
  bench.run_for(2s);
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(bench.jobs.at(0).transmit_time, due);
  EXPECT_EQ(lines[0].first, due + 1920us);
}

TEST_F(MicronPlayback, LinesComeAsCloseAsTheClientAsksForThem) {
  std::uint64_t record = 0;
  bench.step(PingFed{recorded(record)});
  bench.command(SendData{});
  const TimePoint begin = bench.now;
  while (bench.records.size() < 10 && bench.now < begin + 1s) {
    const std::size_t before = bench.records.size();
    bench.run_once();
    if (bench.records.size() > before) {
      bench.step(PingFed{recorded(++record)});
      bench.command(SendData{});
    }
  }
  ASSERT_EQ(bench.records.size(), 10U);
  EXPECT_EQ(bench.now - begin, 10 * 1920us) << "neither turning nor a line of 115200 baud takes time";
}

TEST_F(MicronPlayback, NewParametersDoNotCostALineThatHasBegun) {
  bench.renderer_answers = false;
  bench.step(PingFed{recorded(3)});
  bench.command(SendData{});
  bench.command(all_round(64));
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  bench.answer({bench.jobs.at(0).number, Bytes(30, 9), {}});
  bench.run_for(1s);
  EXPECT_EQ(bench.all<HeadData>().size(), 1U);
  EXPECT_EQ(bench.device.counters().pings_cancelled, 0U);
}

}  // namespace
}  // namespace sonard::micron
