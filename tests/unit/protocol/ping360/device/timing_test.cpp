// SPDX-License-Identifier: Apache-2.0
// Times of turns, pings and answers (protocol/ping360/README.md 3.7).
#include "bench.hpp"

namespace sonard::ping360 {
namespace {

double seconds(TimePoint time) {
  return std::chrono::duration<double>(time).count();
}

/// Duration in seconds of a full turn of pings with 1200 samples, as a scan.
double turn_s(int sample_period, int step, double time_scale = 1.0) {
  DeviceConfig config;
  config.time_scale = time_scale;
  config.idle_timeout = 0s;  // a turn may take longer, and this client sends nothing
  Bench bench(config);
  AutoTransmit command = scan_of(0, 399, step);
  command.number_of_samples = 1200;
  command.sample_period = static_cast<std::uint16_t>(sample_period);
  bench.command(command);
  const std::size_t pings = static_cast<std::size_t>(400 / step);
  bench.wait_for<AutoDeviceData>(pings + 1);
  return seconds(bench.jobs.at(pings).transmit_time - bench.jobs.at(0).transmit_time);
}

// Measured on real hardware over Ethernet, with the two ranges and periods of 2.3.
TEST(Ping360Timing, ATurnTakesAsLongAsMeasuredWithin5Percent) {
  EXPECT_NEAR(turn_s(88, 1), 10.74, 0.05 * 10.74);
  EXPECT_NEAR(turn_s(888, 1), 20.57, 0.05 * 20.57);
  EXPECT_NEAR(turn_s(2222, 1), 37.6, 0.05 * 37.6);
  EXPECT_NEAR(turn_s(88, 10), 3.29, 0.05 * 3.29);
  EXPECT_NEAR(turn_s(888, 10), 4.19, 0.05 * 4.19);
  EXPECT_NEAR(turn_s(2222, 10), 5.89, 0.05 * 5.89);
}

TEST(Ping360Timing, ALoopOfCommandsTakesAsLongAsAScan) {
  Bench bench;
  for (int angle = 0; angle < 400; ++angle) {
    Transducer command = ping_at(angle);
    command.sample_period = 88;
    command.number_of_samples = 1200;
    bench.command(command);
    bench.wait_for<DeviceData>(1);
  }
  EXPECT_NEAR(seconds(bench.now), 10.74, 0.05 * 10.74);
}

TEST(Ping360Timing, AnAnswerComesWhenItHasTurnedListenedAndWorked) {
  Bench bench;
  Transducer command = ping_at(390);  // the short way is 10 gradians
  command.number_of_samples = 1000;
  command.sample_period = 400;  // 10 us: 10 ms in all
  bench.command(command);
  bench.wait_for<DeviceData>(1);
  EXPECT_EQ(bench.jobs.at(0).transmit_time, 61ms);
  EXPECT_EQ(bench.now, 61ms + 10ms + 18ms);
}

TEST(Ping360Timing, TheLongestWayAndRangeComeInTimeForEveryClient) {
  Bench bench;
  Transducer command = ping_at(200);
  command.number_of_samples = 1200;
  command.sample_period = 40000;  // 1.2 s
  bench.command(command);
  bench.wait_for<DeviceData>(1);
  EXPECT_LT(bench.now, 4s);
}

TEST(Ping360Timing, TheDelayOfAScanComesBetweenItsPings) {
  Bench bench;
  AutoTransmit command = scan_of(0, 399, 2);
  command.delay_ms = 100;
  bench.command(command);
  bench.wait_for<AutoDeviceData>(3);
  const auto listening = 200 * 80 * 25ns;
  EXPECT_EQ(bench.jobs[0].transmit_time, 0ns) << "not before the first";
  EXPECT_EQ(bench.jobs[2].transmit_time - bench.jobs[1].transmit_time, listening + 18ms + 12'200us + 100ms);
}

TEST(Ping360Timing, ASlowRendererDelaysWhatFollowsAndAQuickOneKeepsThePace) {
  Bench bench;
  bench.render_time = 10ms;
  bench.command(scan_of(0, 399));
  bench.wait_for<AutoDeviceData>(101);
  EXPECT_EQ(bench.jobs[100].transmit_time, 100 * (200 * 80 * 25ns + 18ms + 6'100us)) << "no drift";
  bench.render_time = 500ms;
  bench.wait_for<AutoDeviceData>(1);
  const TimePoint begin = bench.now;
  bench.wait_for<AutoDeviceData>(10);
  EXPECT_GE(bench.now - begin, 5s);
}

TEST(Ping360Timing, ALateCallerKeepsThePaceFor50Ms) {
  Bench bench;
  bench.command(scan_of(0, 399));
  bench.wait_for<AutoDeviceData>(5);
  bench.now += 30ms;
  bench.run_once();
  EXPECT_LT(bench.jobs.back().transmit_time, bench.now);
  bench.wait_for<AutoDeviceData>(1);
  bench.now += 10s;
  bench.run_once();
  EXPECT_EQ(bench.jobs.back().transmit_time, bench.now - 50ms);
}

TEST(Ping360Timing, TwiceAsSlow) {
  EXPECT_NEAR(turn_s(88, 10, 2.0), 2 * turn_s(88, 10), 1e-3);
}

TEST(Ping360Timing, ScaledToNothingItIsAsFastAsPingsAreRendered) {
  DeviceConfig config;
  config.time_scale = 0.0;
  Bench bench(config);
  bench.render_time = 1ms;
  bench.command(scan_of(0, 399, 3));
  bench.wait_for<AutoDeviceData>(100);
  EXPECT_EQ(bench.now, 100ms);
  bench.command(MotorOff{});
  Transducer command = ping_at(200);
  command.transmit = 0;
  EXPECT_EQ(bench.ask(command).size(), 1U) << "at once";
}

TEST(Ping360Timing, TheHeadIsSeenOnItsWay) {
  Bench bench;
  Transducer command = ping_at(100);
  command.transmit = 0;
  bench.command(command);
  bench.run_until(305ms);
  EXPECT_EQ(std::get<DeviceData>(bench.ask(GeneralRequest{2300}).at(0)).angle, 50);
  bench.command(MotorOff{});
  bench.run_for(5s);
  EXPECT_EQ(std::get<DeviceData>(bench.ask(GeneralRequest{2300}).at(0)).angle, 50) << "it stops there";
  EXPECT_TRUE(bench.all<DeviceData>().size() == 2) << "what was dropped is not answered";
}

TEST(Ping360Timing, SilentForASecondAfterAResetAndAsAtBootThen) {
  Bench bench;
  bench.command(ping_at(77));
  bench.run_for(3s);
  bench.heard.clear();
  bench.raw(fixture("reset"));
  const TimePoint reset = bench.now;
  EXPECT_TRUE(bench.last.nobody_there) << "clients have to come anew";
  bench.run_until(reset + 999ms);
  bench.raw(fixture("request_device_data"));
  EXPECT_TRUE(bench.heard.empty());
  bench.run_until(reset + 1s);
  bench.raw(fixture("request_device_data"));
  ASSERT_EQ(bench.heard.size(), 1U);
  EXPECT_EQ(bench.heard[0].frame, fixture("device_data_at_boot"));
}

TEST(Ping360Timing, SilentFor5SInTheBootloader) {
  Bench bench;
  bench.command(Reset{1});
  bench.run_until(4999ms);
  EXPECT_TRUE(bench.ask(GeneralRequest{4}).empty());
  bench.run_until(5s);
  EXPECT_EQ(bench.ask(GeneralRequest{4}).size(), 1U);
}

TEST(Ping360Timing, WhatComesBehindAnOrderToResetIsNotHeard) {
  Bench bench;
  Bytes bytes = fixture("reset");
  const Bytes question = fixture("request_device_information");
  bytes.insert(bytes.end(), question.begin(), question.end());
  bench.raw(bytes);
  bench.run_for(2s);
  EXPECT_TRUE(bench.heard.empty());
}

}  // namespace
}  // namespace sonard::ping360
