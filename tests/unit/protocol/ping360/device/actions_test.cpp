// SPDX-License-Identifier: Apache-2.0
// Results of a head besides frames: jobs, records, names of clients and log lines.
#include <numbers>

#include "bench.hpp"

namespace sonard::ping360 {
namespace {

TEST(Ping360Actions, AJobIsWhatTheCommandSaysInSiUnits) {
  Bench bench;
  bench.run_until(1s);
  bench.command(Transducer{.gain_setting = 2,
                           .angle = 100,
                           .transmit_duration_us = 40,
                           .sample_period = 888,
                           .transmit_frequency_khz = 750,
                           .number_of_samples = 1200});
  bench.run_for(5s);
  ASSERT_EQ(bench.jobs.size(), 1U);
  const PingJob& job = bench.jobs[0];
  EXPECT_EQ(job.native_bins, 1200);
  EXPECT_DOUBLE_EQ(job.native_bin_m, 888 * 25e-9 * 1500.0 / 2);
  EXPECT_NEAR(job.range_m(), 19.98, 1e-9) << "the example of 2.3";
  EXPECT_EQ(job.listening_time, 1200 * 888 * 25ns);
  EXPECT_GT(job.period, job.listening_time);
  EXPECT_DOUBLE_EQ(job.bearing_rad, std::numbers::pi / 2) << "to starboard";
  EXPECT_DOUBLE_EQ(job.pulse_s, 40e-6);
  EXPECT_EQ(job.gain_db, 12.0);
  EXPECT_EQ(job.gain_percent, 100.0);
  EXPECT_TRUE(job.transmit);
  EXPECT_FALSE(job.sixteen_bit);
  EXPECT_EQ(job.sound_speed_mps, 1500.0);
  EXPECT_EQ(job.assumed_sound_speed_mps, 0.0);
  EXPECT_EQ(job.transmit_time, 1s + 610ms);
  EXPECT_EQ(job.transmit_us, 1'610'000U);
}

TEST(Ping360Actions, BearingsAreFromWhereAheadIs) {
  for (const auto& [ahead, angle, right_angles] : {std::tuple{0, 0, 0},
                                                   {0, 100, 1},
                                                   {0, 300, -1},
                                                   {0, 200, 2},
                                                   {200, 200, 0},
                                                   {200, 300, 1},
                                                   {200, 0, 2}}) {
    DeviceConfig config;
    config.bearing_offset = ahead;
    Bench bench(config);
    bench.command(ping_at(angle));
    bench.run_for(5s);
    EXPECT_DOUBLE_EQ(bench.jobs.at(0).bearing_rad, right_angles * std::numbers::pi / 2)
        << ahead << " " << angle;
  }
}

TEST(Ping360Actions, GainsAreThoseOfTheConfig) {
  DeviceConfig config;
  config.gain_db = {1.0, 20.0, 40.0};
  Bench bench(config);
  for (const int gain : {0, 1, 2}) {
    Transducer command = ping_at(0);
    command.gain_setting = static_cast<std::uint8_t>(gain);
    bench.command(command);
    bench.run_for(1s);
    EXPECT_EQ(bench.jobs.back().gain_db, config.gain_db[static_cast<std::size_t>(gain)]);
    EXPECT_EQ(bench.jobs.back().gain_percent, 50.0 * gain);
  }
}

TEST(Ping360Actions, SettingsAreToldInWords) {
  Bench bench;
  bench.command(scan_of(350, 50, 2));
  bench.run_for(3s);
  const PingJob& job = bench.jobs.at(0);
  EXPECT_EQ(setting(job, "range"), "0.30m");
  EXPECT_EQ(setting(job, "samples"), "200");
  EXPECT_EQ(setting(job, "sample"), "1.5mm");
  EXPECT_EQ(setting(job, "sample_period"), "2.00us");
  EXPECT_EQ(setting(job, "pulse"), "32us");
  EXPECT_EQ(setting(job, "frequency"), "740kHz");
  EXPECT_EQ(setting(job, "gain"), "low");
  EXPECT_EQ(setting(job, "scan"), "auto");
  EXPECT_EQ(setting(job, "from"), "350grad");
  EXPECT_EQ(setting(job, "to"), "50grad");
  EXPECT_EQ(setting(job, "step"), "2grad");
  EXPECT_EQ(bench.jobs.at(1).settings, job.settings) << "a log tells them once";
  bench.command(ping_at(4));
  bench.run_for(3s);
  EXPECT_EQ(setting(bench.jobs.back(), "scan"), "");
}

TEST(Ping360Actions, ARecordIsThePingAsItTravelled) {
  Bench bench;
  bench.command(ping_at(100));
  bench.run_for(3s);
  ASSERT_EQ(bench.records.size(), 1U);
  const PingRecord& record = bench.records[0];
  EXPECT_EQ(record.number, bench.jobs[0].number);
  EXPECT_EQ(record.transmit_time, bench.jobs[0].transmit_time);
  EXPECT_EQ(record.settings, (RecordedSettings{.bins = 200,
                                               .beams = 1,
                                               .bin_m = bench.jobs[0].bin_m(),
                                               .sound_speed_mps = 1500.0,
                                               .gain_percent = 0.0,
                                               .frequency_hz = 740e3}));
  EXPECT_EQ(record.bearings_rad, std::vector<double>{bench.jobs[0].bearing_rad});
  EXPECT_EQ(record.bits_per_bin, 8);
  EXPECT_EQ(record.samples, test_samples(0, 200));
  const auto said = decode_report(record.wire);
  ASSERT_TRUE(said);
  DeviceData expected = bench.all<DeviceData>().at(0);
  expected.data = {};
  EXPECT_TRUE(*said == Report{expected});
}

TEST(Ping360Actions, ARecordOfAScanSaysWhich) {
  Bench bench;
  bench.command(scan_of(10, 50, 5));
  bench.run_for(1s);
  ASSERT_FALSE(bench.records.empty());
  const auto said = decode_report(bench.records[0].wire);
  ASSERT_TRUE(said);
  AutoDeviceData expected = bench.all<AutoDeviceData>().at(0);
  expected.data = {};
  EXPECT_TRUE(*said == Report{expected});
}

TEST(Ping360Actions, AJobThatNobodyWantsAnyMoreIsTold) {
  Bench bench;
  bench.renderer_answers = false;
  bench.command(scan_of(0, 399));
  ASSERT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  bench.command(scan_of(50, 60));
  EXPECT_EQ(bench.last.cancelled, 0U);
  bench.run_for(1s);
  EXPECT_EQ(bench.jobs.size(), 1U) << "the next waits until it is answered";
  bench.answer(test_image(bench.jobs[0]));
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  EXPECT_EQ(bench.jobs.size(), 2U);
  EXPECT_TRUE(bench.all<AutoDeviceData>().empty());
  EXPECT_EQ(bench.device.counters().pings_cancelled, 1U);
}

TEST(Ping360Actions, IdsAreSetAndTold) {
  Bench bench;
  EXPECT_TRUE(bench.ask(Command{SetDeviceId{7}}).at(0) == Report{Ack{2000}});
  EXPECT_EQ(bench.device.id(), 7);
  bench.command(GeneralRequest{2000});
  EXPECT_TRUE(bench.heard.back().report == Report{SetDeviceId{7}});
  EXPECT_EQ(frame_header(bench.heard.back().frame).source, 7);
  for (const std::uint8_t id : {0, 255}) {
    EXPECT_TRUE(bench.ask(Command{SetDeviceId{id}}).at(0) == (Report{Nack{2000, "id out of range"}}));
  }
  bench.command(Reset{});
  bench.run_for(2s);
  EXPECT_EQ(bench.device.id(), 7) << "it is kept";
}

TEST(Ping360Actions, TheCommonMessageForTheIdIsRefusedUnlessToldToObey) {
  Bench bench;
  bench.raw(fixture("set_common_device_id"));
  EXPECT_EQ(bench.heard.back().frame, fixture("nack_not_recognised"));
  EXPECT_EQ(bench.device.id(), 2);
  DeviceConfig config;
  config.obeys_set_common_device_id = true;
  Bench obeys(config);
  obeys.raw(fixture("set_common_device_id"));
  EXPECT_TRUE(obeys.heard.back().report == Report{Ack{100}});
  EXPECT_EQ(obeys.device.id(), 3);
  EXPECT_TRUE(obeys.ask(SetCommonDeviceId{0}).at(0) == (Report{Nack{100, "device_id out of range"}}));
}

TEST(Ping360Actions, DestinationsDoNotMatterUnlessToldSo) {
  DeviceConfig config;
  const Bytes question = encode(GeneralRequest{4}, 0, 9);
  Bench hears_all(config);
  hears_all.raw(question);
  EXPECT_EQ(hears_all.heard.size(), 1U);
  config.ignores_other_destinations = true;
  Bench bench(config);
  bench.raw(question);
  EXPECT_TRUE(bench.heard.empty());
  for (const std::uint8_t destination : {0, 2, 255}) {
    bench.raw(encode(GeneralRequest{4}, 0, destination));
  }
  EXPECT_EQ(bench.heard.size(), 3U);
  EXPECT_EQ(bench.device.counters().other_destinations, 1U);
}

TEST(Ping360Actions, FramesAreSplitWhereDatagramsAreShort) {
  DeviceConfig config;
  config.max_datagram = 100;
  Bench bench(config);
  Transducer command = ping_at(0);
  command.number_of_samples = 1200;
  bench.command(command);
  bench.run_for(1s);
  ASSERT_EQ(bench.datagrams.size(), 13U) << "1224 bytes";
  EXPECT_EQ(bench.datagrams.back().bytes.size(), 24U);
  EXPECT_EQ(bench.all<DeviceData>().at(0).data.size(), 1200U);
}

TEST(Ping360Actions, WhatHappensIsToldInWords) {
  Bench bench(with_serial_line());
  bench.raw({}, client_a);
  bench.command(scan_of(0, 399), client_b);
  bench.command(scan_of(0, 399), client_b);  // a client that repeats its command
  bench.command(scan_of(10, 20, 2), client_b);
  bench.command(MotorOff{}, client_a);
  bench.step(ClientGone{client_b});
  bench.step(ClientGone{client_a});
  bench.command(scan_of(5, 6), serial_client);
  EXPECT_EQ(bench.told(),
            (std::vector<std::string>{
                "client 127.0.0.1:4000 connected", "client 127.0.0.1:4001 connected",
                "auto scan by client 127.0.0.1:4001: 0 to 399 gradians, step 1",
                "auto scan by client 127.0.0.1:4001: 10 to 20 gradians, step 2", "auto scan ended: motor_off",
                "client 127.0.0.1:4001 is gone: disconnected", "client 127.0.0.1:4000 is gone: disconnected",
                "client on the serial line connected",
                "auto scan by client on the serial line: 5 to 6 gradians, step 1"}));
}

TEST(Ping360Actions, NobodyIsThereBeforeTheFirstAndAfterTheLastClient) {
  DeviceConfig config;
  config.idle_timeout = 30s;
  Bench bench(config);
  EXPECT_TRUE(bench.last.nobody_there);
  EXPECT_EQ(bench.last.wake_at, std::nullopt);
  bench.raw({}, client_a);
  EXPECT_FALSE(bench.last.nobody_there);
  bench.run_for(20s);
  bench.raw({}, client_b);
  bench.run_for(15s);
  EXPECT_FALSE(bench.last.nobody_there);
  bench.run_for(15s);
  EXPECT_TRUE(bench.last.nobody_there);
}

TEST(Ping360Actions, ProgressAndCountsAddUp) {
  Bench bench;
  bench.command(scan_of(0, 399));
  bench.run_for(1s);
  bench.renderer_fails = true;
  bench.run_for(1s);
  bench.command(MotorOff{});
  const DeviceCounters& count = bench.device.counters();
  const PingProgress progress = bench.device.progress();
  EXPECT_EQ(progress.sent, bench.all<AutoDeviceData>().size());
  EXPECT_EQ(progress.ended, count.pings_sent + count.pings_failed + count.pings_cancelled);
  EXPECT_EQ(progress.messages, progress.sent);
  EXPECT_GT(count.pings_failed, 10U);
  const auto counts = bench.device.counts();
  const auto sent = std::ranges::find(counts, "pings_sent", &Counter::name);
  ASSERT_NE(sent, counts.end());
  EXPECT_EQ(sent->value, progress.sent);
}

TEST(Ping360Actions, RefusalsAreFaultsOfTheClientAndWarnedOfOnceForEachReason) {
  Bench bench;
  for (int i = 0; i < 2; ++i) {
    bench.command(GeneralRequest{9});
    Bytes unknown = encode(Command{MotorOff{}});
    unknown[4] = 0x58;  // 2904
    unknown[8] = static_cast<std::uint8_t>(unknown[8] + 1);
    bench.raw(unknown);
  }
  std::vector<std::string> warnings;
  for (const Notice& notice : bench.notices) {
    if (notice.level == Notice::Level::warning) {
      warnings.push_back(notice.text);
    }
  }
  EXPECT_EQ(warnings,
            (std::vector<std::string>{"the client's message 6 is refused: cannot be requested",
                                      "the client's message 2904 is refused: command not recognised"}));
  const auto counts = bench.device.counts();
  const auto refused = std::ranges::find(counts, "refused", &Counter::name);
  ASSERT_NE(refused, counts.end());
  EXPECT_EQ(refused->value, 4U);
  EXPECT_EQ(refused->fault, Counter::Fault::of_client);
}

}  // namespace
}  // namespace sonard::ping360
