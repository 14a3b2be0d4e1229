// SPDX-License-Identifier: Apache-2.0
// A head in playback sends the pings that it is fed when they are due, whatever the client requests.
#include "bench.hpp"
#include "protocol/ping360/recorded_form.hpp"

namespace sonard::ping360 {
namespace {

/// A ping at 100 gradians with 30 samples, from a scan that no test requests.
PingForm recorded_form_of_scan() {
  AutoTransmit scan = scan_of(90, 110, 5);
  scan.gain_setting = 1;
  scan.sample_period = 400;  // 10 us: 300 us of listening
  scan.transmit_frequency_khz = 690;
  scan.number_of_samples = 30;
  return form_of(scan, 100);
}

ReplayedPing recorded(std::uint64_t record, std::optional<TimePoint> due = std::nullopt) {
  ReplayedPing ping;
  ping.record = record;
  ping.settings = {.bins = 30, .beams = 1, .bin_m = 10e-6 * 1480.0 / 2.0, .sound_speed_mps = 1480.0};
  ping.bearing_rad = 1.25;
  ping.wire = recorded_wire(recorded_form_of_scan(), 2);
  ping.due = due;
  return ping;
}

struct Ping360Playback : ::testing::Test {
  static DeviceConfig player() {
    DeviceConfig config;
    config.plays_back = true;
    return config;
  }
  Bench bench{player()};
};

// The answer has the recorded settings, but commands are compared by the settings that the client requested.
TEST_F(Ping360Playback, ARepeatedCommandSharesTheRecordedAnswer) {
  bench.render_time = 500ms;
  bench.command(ping_at(7));
  bench.command(ping_at(7));
  bench.step(PingFed{recorded(5)});
  bench.run_for(100ms);
  bench.command(ping_at(7));
  bench.step(PingFed{recorded(6)});
  bench.run_for(3s);
  EXPECT_EQ(bench.all<DeviceData>().size(), 1U);
  EXPECT_EQ(bench.device.counters().commands_joined, 2U);
}

TEST_F(Ping360Playback, ACommandBringsTheRecordedPingAsItsAnswer) {
  bench.step(PingFed{recorded(5)});
  Transducer command = ping_at(7);
  command.mode = 0;
  bench.command(command);
  bench.run_for(1s);
  ASSERT_EQ(bench.heard.size(), 1U);
  EXPECT_TRUE(bench.heard[0].report == (Report{DeviceData{.mode = 0,
                                                          .gain_setting = 1,
                                                          .angle = 100,
                                                          .sample_period = 400,
                                                          .transmit_frequency_khz = 690,
                                                          .number_of_samples = 30,
                                                          .data = test_samples(0, 30)}}));
}

TEST_F(Ping360Playback, AScanBringsItWithTheLimitsThatItsClientCompares) {
  bench.step(PingFed{recorded(5)});
  bench.command(scan_of(0, 399));
  bench.run_for(1s);
  const auto pings = bench.all<AutoDeviceData>();
  ASSERT_EQ(pings.size(), 1U);
  EXPECT_EQ(pings[0].angle, 100);
  EXPECT_EQ(pings[0].sample_period, 400);
  EXPECT_EQ(pings[0].start_angle, 0);
  EXPECT_EQ(pings[0].stop_angle, 399);
  EXPECT_EQ(pings[0].num_steps, 1);
}

TEST_F(Ping360Playback, TheJobIsWhatThePingWasMadeWithAndSaysHowItDiffers) {
  bench.step(PingFed{recorded(5)});
  bench.command(ping_at(7));
  ASSERT_EQ(bench.jobs.size(), 1U);
  const PingJob& job = bench.jobs[0];
  EXPECT_EQ(job.record, 5U);
  EXPECT_EQ(job.bins(), 30);
  EXPECT_EQ(job.bearing_rad, 1.25);
  EXPECT_EQ(job.sound_speed_mps, 1480.0);
  EXPECT_DOUBLE_EQ(job.bin_m(), 10e-6 * 1480.0 / 2.0);
  EXPECT_EQ(job.listening_time, 300us);
  EXPECT_EQ(job.gain_db, 6.0);
  std::vector<std::string> kinds;
  std::ranges::transform(job.differences, std::back_inserter(kinds), &Difference::kind);
  EXPECT_EQ(kinds, (std::vector<std::string>{"range", "samples", "gain", "frequency", "angle"}));
}

TEST_F(Ping360Playback, WhatIsRecordedAgainIsWhatWasSent) {
  bench.step(PingFed{recorded(5)});
  bench.command(scan_of(90, 110, 5));
  bench.run_for(1s);
  ASSERT_EQ(bench.records.size(), 1U);
  EXPECT_EQ(bench.records[0].wire, recorded(5).wire);
  EXPECT_EQ(bench.records[0].samples, test_samples(0, 30));
  EXPECT_EQ(bench.records[0].bearings_rad, std::vector<double>{1.25});
  EXPECT_EQ(bench.records[0].settings.frequency_hz, 690e3);
}

TEST_F(Ping360Playback, APingIsMadeWhenItIsDueAndLeavesWhenItsEchoesAreIn) {
  bench.step(PingFed{recorded(0, 700ms)});
  bench.command(ping_at(7));
  bench.run_for(2s);
  EXPECT_EQ(bench.jobs.at(0).transmit_time, 700ms);
  EXPECT_EQ(bench.heard.at(0).at, 700ms + 300us);
}

TEST_F(Ping360Playback, PingsOfAScanComeAsCloseAsTheyAreFed) {
  bench.command(scan_of(0, 399));
  for (std::uint64_t record = 0; record < 10; ++record) {
    bench.step(PingFed{recorded(record)});
    bench.wait_for<AutoDeviceData>(1);
  }
  EXPECT_EQ(bench.now, 10 * 300us) << "turning takes no time";
}

TEST_F(Ping360Playback, APingThatHasBegunIsNotLostToAClientThatOrdersAgain) {
  bench.renderer_answers = false;
  bench.step(PingFed{recorded(3)});
  bench.command(scan_of(0, 399));
  bench.raw({});
  bench.command(scan_of(0, 399));
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  bench.answer(test_image(bench.jobs.at(0)));
  bench.run_for(1s);
  EXPECT_EQ(bench.all<AutoDeviceData>().size(), 1U);
  bench.step(PingFed{recorded(4)});
  bench.command(MotorOff{});
  EXPECT_EQ(bench.last.cancelled, 1U) << "but this ends all";
}

TEST_F(Ping360Playback, AMoveIsAnsweredWithoutAPing) {
  Transducer command = ping_at(10);
  command.transmit = 0;
  bench.command(command);
  bench.run_for(1s);
  EXPECT_EQ(bench.all<DeviceData>().at(0).angle, 10);
}

}  // namespace
}  // namespace sonard::ping360
