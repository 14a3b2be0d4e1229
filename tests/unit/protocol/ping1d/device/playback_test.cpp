// SPDX-License-Identifier: Apache-2.0
// Recorded pings, in the log and sent again.
#include "protocol/ping1d/recorded_form.hpp"

#include "tests/unit/protocol/ping1d/device/bench.hpp"

namespace sonard::ping1d {
namespace {

const Distance recorded_ping{.distance_mm = 1234,
                             .confidence_percent = 77,
                             .transmit_duration_us = 52,
                             .ping_number = 9,
                             .scan_start_mm = 0,
                             .scan_length_mm = 2000,
                             .gain_setting = 4};

ReplayedPing replayed() {
  ReplayedPing ping;
  ping.record = 5;
  ping.settings = {.bins = 50, .beams = 1, .bin_m = 0.04, .sound_speed_mps = 1480.0};
  ping.wire = record_of(recorded_ping, Bytes(50), 1480.0, 1).wire;
  return ping;
}

TEST(Ping1dPlayback, ARecordHasTheProfileAndTheMeasurement) {
  Bench bench;
  bench.command(ContinuousStart{1300});
  bench.run_for(1s);
  ASSERT_FALSE(bench.records.empty());
  const PingRecord& record = bench.records.back();
  const auto sent = bench.all<Profile>().back().second;
  EXPECT_EQ(record.samples, Bytes(sent.data.begin(), sent.data.end()));
  EXPECT_EQ(recorded_form(record.wire), sent.measured());
  EXPECT_EQ(record.settings.bins, 200);
  EXPECT_DOUBLE_EQ(record.settings.range_m(), 1e-3 * sent.scan_length_mm);
  EXPECT_EQ(recorded_form(encode(recorded_ping)), std::nullopt) << "not a profile";
}

TEST(Ping1dPlayback, ARecordedPingIsSentAsItWas) {
  DeviceConfig config;
  config.plays_back = true;
  Bench bench(config);
  bench.render = [](const PingJob& job) { return test_image(job, job.bins()); };
  bench.command(ContinuousStart{1300});
  bench.step(PingFed{replayed()});
  bench.run_for(1s);
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.jobs[0].record, 5U);
  EXPECT_EQ(bench.jobs[0].bins(), 50);
  const auto sent = bench.all<Profile>();
  ASSERT_EQ(sent.size(), 1U);
  Distance expected = recorded_ping;
  expected.ping_number = 1;
  EXPECT_EQ(sent[0].second.measured(), expected);
  EXPECT_EQ(Bytes(sent[0].second.data.begin(), sent[0].second.data.end()), bench.records[0].samples);
  EXPECT_EQ(bench.get<DistanceSimple>(), (DistanceSimple{1234, 77}));
}

TEST(Ping1dPlayback, SettingsThatTheRecordingDoesNotHaveAreTold) {
  DeviceConfig config;
  config.plays_back = true;
  Bench bench(config);
  bench.render = [](const PingJob& job) { return test_image(job, job.bins()); };
  bench.command(SetModeAuto{0});
  bench.step(PingFed{replayed()});
  bench.run_for(1s);
  ASSERT_EQ(bench.jobs.size(), 1U);
  ASSERT_EQ(bench.jobs[0].differences.size(), 2U);
  EXPECT_EQ(bench.jobs[0].differences[0].text, "range 0 + 5000 mm requested, 0 + 2000 mm sent");
  EXPECT_EQ(bench.jobs[0].differences[1].text, "gain 1 requested, 4 sent");
}

TEST(Ping1dPlayback, AHeadWithoutAFedPingIsSilent) {
  DeviceConfig config;
  config.plays_back = true;
  Bench bench(config);
  bench.command(ContinuousStart{1300});
  ReplayedPing foreign = replayed();
  foreign.wire = encode(recorded_ping);
  bench.step(PingFed{foreign});
  bench.run_for(2s);
  EXPECT_TRUE(bench.jobs.empty());
}

}  // namespace
}  // namespace sonard::ping1d
