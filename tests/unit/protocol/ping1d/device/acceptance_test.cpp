// SPDX-License-Identifier: Apache-2.0
// The list of protocol/ping1d/README.md 7, a test for each line or part of it. Line 1 is in the tests of the
// codec and of protocol/ping, line 3 in clients_test.cpp.
#include <cmath>

#include "tests/unit/protocol/ping1d/device/bench.hpp"

namespace sonard::ping1d {
namespace {

const std::vector<std::uint16_t> requestable{4,    5,    1200, 1201, 1202, 1203, 1204, 1205, 1206,
                                             1207, 1208, 1210, 1211, 1212, 1213, 1214, 1215, 1300};

Bytes legacy_request(std::uint16_t id) {
  return make_frame(id, client_id, 0, {});
}

// ---- 1: frames in a stream

TEST(Ping1dAcceptance, Line1JunkCutsAndWrongSums) {
  Bench bench;
  const Bytes request = encode(GeneralRequest{5});
  Bytes broken = request;
  broken[8] ^= 1;
  Bytes stream{0x00, 0xFF, 'U', 'U', 'B'};
  for (const Bytes& part : {request, broken, request}) {
    stream.insert(stream.end(), part.begin(), part.end());
  }
  for (const std::uint8_t byte : stream) {
    bench.raw({byte});
  }
  bench.raw({});  // an empty datagram ends nothing
  EXPECT_EQ(bench.all<ProtocolVersion>().size(), 2U);
  EXPECT_EQ(bench.heard.size(), 2U);
  EXPECT_EQ(bench.device.counters().bad_checksums, 1U);
}

// ---- 2: requests

TEST(Ping1dAcceptance, Line2AllRequestsInBothFormsWithin50MsAlsoWhileStreaming) {
  Bench bench;
  bench.render_time = 30ms;
  for (const bool streaming : {false, true}) {
    if (streaming) {
      bench.command(ContinuousStart{1300}, client_b);
      bench.run_for(1s);
    }
    for (const std::uint16_t id : requestable) {
      for (const Bytes& request : {encode(GeneralRequest{id}), legacy_request(id)}) {
        const std::size_t before = bench.heard.size();
        bench.raw(request);
        bench.run_for(50ms);
        const auto answers = bench.answers(before, client_a);
        ASSERT_EQ(answers.size(), 1U) << id;
        EXPECT_EQ(id_of(answers[0]), id);
      }
    }
  }
}

TEST(Ping1dAcceptance, Line2AFirstRequestWaitsForAPingButNotForLong) {
  Bench bench;
  EXPECT_EQ(bench.get<DistanceSimple>().distance_mm, 2000U);
  Bench slow;
  slow.renderer_answers = false;
  EXPECT_EQ(slow.get<DistanceSimple>(), DistanceSimple{});
}

TEST(Ping1dAcceptance, Line2UnknownIdsAreRefused) {
  Bench bench;
  EXPECT_EQ(nack_text(bench.ask(GeneralRequest{1301}), 6), "cannot be requested");
  for (const std::uint16_t id : {1007, 1209, 1301, 2000}) {
    const std::size_t before = bench.heard.size();
    bench.raw(legacy_request(id));
    EXPECT_EQ(nack_text(bench.answers(before, client_a), id), "bad id");
  }
  const std::size_t before = bench.heard.size();
  bench.raw(encode(Nack{6, "no"}));
  EXPECT_EQ(bench.heard.size(), before) << "two heads on a line must not answer each other for ever";
}

// ---- 4: settings

TEST(Ping1dAcceptance, Line4SetThenReadBackInManualMode) {
  Bench bench;
  EXPECT_TRUE(is_ack(bench.ask(SetModeAuto{0}), 1003));
  EXPECT_TRUE(is_ack(bench.ask(SetRange{1000, 2000}), 1001));
  EXPECT_TRUE(is_ack(bench.ask(SetGainSetting{3}), 1005));
  EXPECT_TRUE(is_ack(bench.ask(SetSpeedOfSound{1'444'000}), 1002));
  EXPECT_TRUE(is_ack(bench.ask(SetPingInterval{36}), 1004));
  EXPECT_TRUE(is_ack(bench.ask(SetPingEnable{1}), 1006));
  bench.run_for(1s);
  EXPECT_EQ(bench.get<Range>(), (Range{1000, 2000}));
  EXPECT_EQ(bench.get<GainSetting>(), GainSetting{3});
  EXPECT_EQ(bench.get<SpeedOfSound>(), SpeedOfSound{1'444'000});
  EXPECT_EQ(bench.get<PingInterval>(), PingInterval{36});
  EXPECT_EQ(bench.get<ModeAuto>(), ModeAuto{0});
  EXPECT_EQ(bench.get<Profile>().scan_start_mm, 1000U);
  EXPECT_EQ(bench.get<GeneralInfo>(), (GeneralInfo{3, 29, 5021, 36, 3, 0}));
}

TEST(Ping1dAcceptance, Line4RangeAndGainAreUntouchedInAutoMode) {
  for (const bool silent : {false, true}) {
    DeviceConfig config;
    config.refuses_silently_in_auto = silent;
    Bench bench(config);
    bench.command(SetPingEnable{0});
    const auto range = bench.get<Range>();
    const auto answers = bench.ask(SetRange{100, 2000});
    EXPECT_EQ(answers.empty(), silent);
    EXPECT_EQ(bench.ask(SetGainSetting{5}).empty(), silent);
    EXPECT_EQ(bench.get<Range>(), range);
    EXPECT_EQ(bench.get<GainSetting>(), GainSetting{1});
    EXPECT_EQ(bench.device.counters().refused_in_auto, 2U);
  }
}

TEST(Ping1dAcceptance, Line4WrongLengthsAndBadValuesAreRefused) {
  Bench bench;
  bench.command(SetModeAuto{0});
  for (std::uint16_t id = 1000; id <= 1006; ++id) {
    const std::size_t before = bench.heard.size();
    bench.raw(legacy_request(id));
    EXPECT_EQ(nack_text(bench.answers(before, client_a), id), "wrong payload length");
  }
  EXPECT_EQ(nack_text(bench.ask(SetRange{0, 999}), 1001), "scan_length out of range");
  EXPECT_EQ(nack_text(bench.ask(SetRange{0xFFFFFFFF, 1000}), 1001), "range out of range");
  EXPECT_EQ(nack_text(bench.ask(SetGainSetting{7}), 1005), "gain_setting out of range");
  EXPECT_EQ(nack_text(bench.ask(SetSpeedOfSound{0}), 1002), "speed_of_sound out of range");
  EXPECT_EQ(nack_text(bench.ask(SetDeviceId{255}), 1000), "device_id out of range");
  EXPECT_EQ(bench.get<Range>(), (Range{0, 5000}));
}

TEST(Ping1dAcceptance, Line4TheDeviceIdIsTheSourceOfLaterFrames) {
  Bench bench;
  EXPECT_TRUE(is_ack(bench.ask(SetDeviceId{43}), 1000));
  EXPECT_EQ(bench.get<DeviceId>(), DeviceId{43});
  EXPECT_EQ(frame_header(bench.heard.back().frame).source, 43);
  for (const int to : {0, 43, 255, 7}) {
    const std::size_t before = bench.heard.size();
    bench.raw(encode(GeneralRequest{5}, client_id, static_cast<std::uint8_t>(to)));
    EXPECT_EQ(bench.heard.size() - before, to == 7 ? 0U : 1U) << to;
  }
}

// ---- 5: streams

/// Mean period of the messages of a stream.
template <class Message>
double period_ms(const Bench& bench, std::size_t from = 0) {
  const auto found = bench.all<Message>(from);
  EXPECT_GT(found.size(), 5U);
  return found.size() < 2
             ? 0.0
             : std::chrono::duration<double, std::milli>(found.back().first - found.front().first).count() /
                   static_cast<double>(found.size() - 1);
}

TEST(Ping1dAcceptance, Line5StreamsKeepTheInterval) {
  Bench bench;
  const auto answers = bench.ask(ContinuousStart{1300});
  ASSERT_FALSE(answers.empty());
  EXPECT_TRUE(answers[0] == Report{Ack{1400}}) << "the ack comes first";
  bench.run_for(5s);
  EXPECT_NEAR(period_ms<Profile>(bench), 250.0, 1.0);
  const std::size_t before = bench.heard.size();
  bench.command(ContinuousStart{1211});
  bench.command(SetPingInterval{50});
  bench.run_for(2s);
  EXPECT_TRUE(bench.all<Profile>(before).empty()) << "another id replaces the first";
  EXPECT_NEAR(period_ms<DistanceSimple>(bench, before), 50.0, 1.0) << "20 Hz at 5 m";
}

TEST(Ping1dAcceptance, Line5ARestartOfTheSameStreamChangesNothingAndStopEndsIt) {
  Bench bench;
  bench.command(SetPingInterval{50});
  bench.command(ContinuousStart{1300});
  for (int i = 0; i < 20; ++i) {
    bench.run_for(130ms);
    bench.command(ContinuousStart{1300});
  }
  EXPECT_NEAR(period_ms<Profile>(bench), 50.0, 1.0);
  EXPECT_TRUE(is_ack(bench.ask(ContinuousStop{1211}), 1401));
  std::size_t before = bench.heard.size();
  bench.run_for(1s);
  EXPECT_GT(bench.all<Profile>(before).size(), 15U) << "the stop was for another stream";
  bench.command(ContinuousStop{1300});
  before = bench.heard.size();
  bench.run_for(1s);
  EXPECT_EQ(bench.heard.size(), before);
  EXPECT_EQ(nack_text(bench.ask(ContinuousStart{1205}), 1400), "bad continuous request id");
}

TEST(Ping1dAcceptance, Line5TheIntervalGrowsTo77MsAt50M) {
  Bench bench;
  bench.command(SetModeAuto{0});
  bench.command(SetPingInterval{50});
  bench.command(SetRange{0, 50'000});
  bench.command(ContinuousStart{1212});
  bench.run_for(5s);
  EXPECT_NEAR(period_ms<Distance>(bench), 77.0, 1.0);
}

TEST(Ping1dAcceptance, Line5AStreamEndsWithItsSilentClientOnUdpButNotOnASerialLine) {
  Bench bench(with_serial_line());
  bench.command(ContinuousStart{1211}, client_a);
  bench.command(ContinuousStart{1211}, serial_client);
  bench.run_for(29s);
  std::size_t before = bench.heard.size();
  bench.run_for(500ms);
  EXPECT_EQ(bench.all<DistanceSimple>(before, client_a).size(), 2U);
  bench.run_for(1s);
  bench.raw({'U', 'U'}, serial_client);
  before = bench.heard.size();
  bench.run_for(100s);
  EXPECT_TRUE(bench.all<DistanceSimple>(before, client_a).empty());
  EXPECT_GT(bench.all<DistanceSimple>(before, serial_client).size(), 390U);
}

TEST(Ping1dAcceptance, Line5DisabledPingsProduceNothingAndKeepTheLastValues) {
  Bench bench;
  bench.command(ContinuousStart{1211});
  bench.run_for(1s);
  const auto last = bench.get<Distance>();
  bench.command(SetPingEnable{0});
  const std::size_t before = bench.heard.size();
  bench.run_for(2s);
  EXPECT_TRUE(bench.all<DistanceSimple>(before).empty());
  EXPECT_EQ(bench.get<Distance>(), last);
  bench.command(SetPingEnable{1});
  bench.run_for(1s);
  EXPECT_GE(bench.all<DistanceSimple>(before).size(), 4U);
}

// ---- 6 and 7: the distance

TEST(Ping1dAcceptance, Line6ATargetAt2MIsInPoint80Of200) {
  Bench bench;
  bench.command(SetModeAuto{0});
  bench.run_for(2s);
  const auto profile = bench.get<Profile>();
  EXPECT_NEAR(profile.distance_mm, 2000, 1);
  const auto all = bench.all<Profile>();
  const auto& data = all.back().second.data;
  ASSERT_EQ(data.size(), 200U);
  EXPECT_EQ(std::max_element(data.begin(), data.end()) - data.begin(), 80);
  EXPECT_GT(profile.confidence_percent, 90);
  EXPECT_EQ(bench.get<TransmitDuration>(), TransmitDuration{130});
  EXPECT_EQ(bench.get<DistanceSimple>().distance_mm, profile.distance_mm);
  EXPECT_EQ(bench.get<Distance>().scan_length_mm, 5000U);
}

TEST(Ping1dAcceptance, Line7AWrongSpeedOfSoundScalesTheDistance) {
  Bench bench;
  bench.command(SetModeAuto{0});
  for (const std::uint32_t speed_mmps : {1'400'000U, 1'500'000U, 1'600'000U}) {
    bench.command(SetSpeedOfSound{speed_mmps});
    bench.run_for(5s);
    EXPECT_NEAR(bench.get<Distance>().distance_mm, 2000.0 * speed_mmps / 1.5e6, 1.0);
  }
}

// ---- 8: auto mode

TEST(Ping1dAcceptance, Line8AutoRangeFollowsABottomFrom1To40MAndBack) {
  DeviceConfig config;
  config.idle_timeout = 0ns;  // the client only listens
  Bench bench(config);
  bench.command(SetPingInterval{50});
  bench.command(ContinuousStart{1212});
  const auto follow = [&](double from_m, double to_m) {
    constexpr int steps = 400;
    for (int i = 0; i <= steps; ++i) {
      bench.bed.range_m = from_m + (to_m - from_m) * i / steps;
      bench.run_for(100ms);
      const auto measured = bench.all<Distance>().back().second;
      const double true_mm = 1e3 * bench.bed.range_m;
      ASSERT_NEAR(measured.distance_mm, true_mm, 10.0 + 0.01 * true_mm) << i;
      ASSERT_GT(measured.confidence_percent, 50);
      ASSERT_LT(measured.distance_mm, measured.scan_length_mm);
    }
  };
  const auto length_mm = [&] { return bench.all<Distance>().back().second.scan_length_mm; };
  bench.bed.range_m = 1.0;
  bench.run_for(3s);
  follow(1.0, 40.0);
  EXPECT_EQ(length_mm(), 50'000U);
  follow(40.0, 1.0);
  EXPECT_EQ(length_mm(), 2000U);
  bench.run_for(3s);
  EXPECT_EQ(bench.all<Distance>().back().second.distance_mm, 1000U);
}

TEST(Ping1dAcceptance, Line8AutoGainFindsAPeakBelowSaturation) {
  for (const double amplitude : {0.004, 0.01, 0.05}) {
    Bench bench;
    bench.render = [&](const PingJob& job) {
      return image_of(job, {2.0, amplitude * std::pow(10.0, job.gain_db / 20.0)});
    };
    bench.command(ContinuousStart{1300});
    bench.run_for(5s);
    const auto profile = bench.all<Profile>().back().second;
    EXPECT_GE(*std::max_element(profile.data.begin(), profile.data.end()), 100) << amplitude;
    EXPECT_NEAR(profile.distance_mm, 2000, 1);
  }
}

TEST(Ping1dAcceptance, Line8WithoutAnEchoTheScanGrowsAndTheDistanceStays) {
  Bench bench;
  bench.command(ContinuousStart{1212});
  bench.run_for(3s);
  bench.bed.amplitude = 0.0;
  bench.run_for(10s);
  const auto measured = bench.all<Distance>().back().second;
  EXPECT_EQ(measured.distance_mm, 2000U);
  EXPECT_EQ(measured.confidence_percent, 0);
  EXPECT_EQ(measured.scan_length_mm, 100'000U);
  EXPECT_EQ(measured.gain_setting, 6U);
}

// ---- 9: two clients

TEST(Ping1dAcceptance, Line9TwoClientsOnOnePortHaveTheirOwnAnswersAndStreams) {
  Bench bench;
  bench.command(ContinuousStart{1300}, client_a);
  bench.command(ContinuousStart{1211}, client_b);
  bench.run_for(5s);
  EXPECT_EQ(bench.all<Profile>(0, client_a).size(), bench.all<DistanceSimple>(0, client_b).size());
  EXPECT_GE(bench.all<Profile>(0, client_a).size(), 19U);
  EXPECT_TRUE(bench.all<Profile>(0, client_b).empty());
  bench.command(ContinuousStop{1300}, client_a);
  const std::size_t before = bench.heard.size();
  bench.run_for(1s);
  EXPECT_TRUE(bench.all<Profile>(before, client_a).empty());
  EXPECT_GE(bench.all<DistanceSimple>(before, client_b).size(), 3U);
}

TEST(Ping1dAcceptance, Line9ABridgeSendsEverythingToAll) {
  DeviceConfig config;
  config.fan_out = FanOut::all;
  Bench bench(config);
  bench.command(GeneralRequest{5}, client_b);
  bench.command(ContinuousStart{1211}, client_a);
  bench.run_for(2s);
  EXPECT_EQ(bench.all<DistanceSimple>(0, client_a).size(), bench.all<DistanceSimple>(0, client_b).size());
  EXPECT_GE(bench.all<DistanceSimple>(0, client_b).size(), 7U);
}

// ---- 10: ArduPilot

TEST(Ping1dAcceptance, Line10ArduPilotsLoopForMinutes) {
  Bench bench(with_serial_line());
  for (int second = 0; second < 180; ++second) {
    bench.raw(encode(SetPingInterval{50}, client_id, 1), serial_client);
    bench.raw(encode(ContinuousStart{1211}, client_id, 1), serial_client);
    bench.run_for(1s);
  }
  const auto distances = bench.all<DistanceSimple>(0, serial_client);
  EXPECT_EQ(distances.size(), bench.records.size()) << "one per ping";
  EXPECT_NEAR(static_cast<double>(distances.size()), 180 * 20, 20);
  EXPECT_EQ(bench.heard.size(), distances.size() + 360) << "and acks, but nothing else";
  for (const Heard& it : bench.heard) {
    EXPECT_LE(it.frame.size(), 20 + frame_overhead) << "its parser keeps 20 bytes";
    EXPECT_GT(it.frame.size(), frame_overhead) << "and takes no empty frame";
  }
}

// ---- 3.6

TEST(Ping1dAcceptance, TheBootloaderIsSilentAndRestartsWithBootValues) {
  Bench bench;
  bench.command(SetModeAuto{0});
  bench.command(SetRange{0, 9000});
  bench.command(ContinuousStart{1211});
  bench.run_for(1s);
  EXPECT_TRUE(is_ack(bench.ask(GotoBootloader{}), 1100));
  const std::size_t before = bench.heard.size();
  bench.run_for(4900ms);
  bench.command(GeneralRequest{5});
  EXPECT_EQ(bench.heard.size(), before);
  bench.run_for(200ms);
  bench.command(SetPingEnable{0});
  EXPECT_EQ(bench.get<Range>(), (Range{0, 5000}));
  EXPECT_EQ(bench.get<ModeAuto>(), ModeAuto{1});
  EXPECT_EQ(bench.get<Distance>().ping_number, 0U);
}

TEST(Ping1dAcceptance, AHeadWithoutClientsDoesNotPing) {
  Bench bench;
  bench.run_for(10s);
  EXPECT_TRUE(bench.jobs.empty());
  bench.command(GeneralRequest{5});
  bench.run_for(10s);
  EXPECT_GT(bench.jobs.size(), 35U);
  bench.run_for(21s);
  const std::size_t before = bench.jobs.size();
  bench.run_for(100s);
  EXPECT_EQ(bench.jobs.size(), before);
  EXPECT_TRUE(bench.last.nobody_there);
}

}  // namespace
}  // namespace sonard::ping1d
