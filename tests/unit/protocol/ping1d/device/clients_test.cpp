// SPDX-License-Identifier: Apache-2.0
// The loops of known clients, with their own waits (protocol/ping1d/README.md 5). ArduPilot's is in
// acceptance_test.cpp.
#include <functional>

#include "tests/unit/protocol/ping1d/device/bench.hpp"

namespace sonard::ping1d {
namespace {

/// Requests as each client forms them.
using Ask = std::function<Bytes(std::uint16_t)>;
Bytes legacy(std::uint16_t id) {
  return make_frame(id, client_id, 0, {});
}
Bytes general(std::uint16_t id) {
  return encode(GeneralRequest{id});
}

/// Sends a request and waits for its answer; acks and nacks are skipped or end the wait.
template <class Message>
std::optional<Message> wait_for(Bench& bench, const Bytes& request, std::chrono::nanoseconds patience,
                                bool nack_ends = false) {
  const std::size_t before = bench.heard.size();
  const TimePoint end = bench.now + patience;
  bench.raw(request);
  while (true) {
    for (std::size_t i = before; i < bench.heard.size(); ++i) {
      if (const auto* const message = bench.heard[i].get<Message>()) {
        return *message;
      }
      if (nack_ends && bench.heard[i].get<Nack>() != nullptr) {
        return std::nullopt;
      }
    }
    if (bench.next_event() > end) {
      return std::nullopt;
    }
    bench.run_once();
  }
}

/// All get functions of a client library answer.
void get_all(Bench& bench, const Ask& ask, std::chrono::nanoseconds patience) {
  EXPECT_TRUE(wait_for<FirmwareVersion>(bench, ask(1200), patience));
  EXPECT_TRUE(wait_for<DeviceId>(bench, ask(1201), patience));
  EXPECT_TRUE(wait_for<Voltage5>(bench, ask(1202), patience));
  EXPECT_TRUE(wait_for<SpeedOfSound>(bench, ask(1203), patience));
  EXPECT_TRUE(wait_for<Range>(bench, ask(1204), patience));
  EXPECT_TRUE(wait_for<ModeAuto>(bench, ask(1205), patience));
  EXPECT_TRUE(wait_for<PingInterval>(bench, ask(1206), patience));
  EXPECT_TRUE(wait_for<GainSetting>(bench, ask(1207), patience));
  EXPECT_TRUE(wait_for<TransmitDuration>(bench, ask(1208), patience));
  EXPECT_TRUE(wait_for<GeneralInfo>(bench, ask(1210), patience));
  EXPECT_TRUE(wait_for<DistanceSimple>(bench, ask(1211), patience));
  EXPECT_TRUE(wait_for<Distance>(bench, ask(1212), patience));
  EXPECT_TRUE(wait_for<ProcessorTemperature>(bench, ask(1213), patience));
  EXPECT_TRUE(wait_for<PcbTemperature>(bench, ask(1214), patience));
  EXPECT_TRUE(wait_for<PingEnable>(bench, ask(1215), patience));
  EXPECT_TRUE(wait_for<Profile>(bench, ask(1300), patience));
}

/// Sends a setting, requests it and compares.
template <class Report, class Setting>
void set_and_compare(Bench& bench, const Ask& ask, const Setting& setting, const Report& expected) {
  bench.command(setting);
  EXPECT_EQ(wait_for<Report>(bench, ask(static_cast<std::uint16_t>(Report::id)), 500ms), expected);
}

TEST(Ping1dClients, BrpingsSelfTestPasses) {
  for (const bool acknowledges : {true, false}) {
    DeviceConfig config;
    config.acknowledges = acknowledges;
    Bench bench(config);
    EXPECT_TRUE(wait_for<ProtocolVersion>(bench, general(5), 500ms));
    EXPECT_TRUE(wait_for<GeneralInfo>(bench, legacy(1210), 500ms));
    get_all(bench, legacy, 500ms);
    set_and_compare(bench, legacy, SetDeviceId{43}, DeviceId{43});
    set_and_compare(bench, legacy, SetModeAuto{0}, ModeAuto{0});
    set_and_compare(bench, legacy, SetRange{1000, 2000}, Range{1000, 2000});
    set_and_compare(bench, legacy, SetSpeedOfSound{1'444'000}, SpeedOfSound{1'444'000});
    set_and_compare(bench, legacy, SetPingInterval{36}, PingInterval{36});
    set_and_compare(bench, legacy, SetGainSetting{3}, GainSetting{3});
    set_and_compare(bench, legacy, SetPingEnable{1}, PingEnable{1});
  }
}

TEST(Ping1dClients, PingCppsHardwareTestPasses) {
  Bench bench;
  bench.raw({0x00, 0xFF});
  const auto version = wait_for<ProtocolVersion>(bench, general(5), 500ms, true);
  EXPECT_EQ(version, (ProtocolVersion{1, 0, 0}));
  const auto information = wait_for<DeviceInformation>(bench, general(4), 500ms, true);
  ASSERT_TRUE(information);
  EXPECT_EQ(information->device_type, 1);
  EXPECT_GT(information->device_revision, 0);
  EXPECT_GE(information->firmware_major, 3);
  EXPECT_GE(information->firmware_minor, 27);
  EXPECT_EQ(frame_header(bench.heard.back().frame).source, 1);
  get_all(bench, general, 1s);
  EXPECT_FALSE(wait_for<Profile>(bench, general(1), 1s, true))
      << "a nack with the id of the request ends the wait";
  // In auto mode a range must not stick, in manual mode it must.
  bench.command(SetModeAuto{1});
  bench.command(SetRange{100, 2000});
  EXPECT_NE(wait_for<Range>(bench, general(1204), 1s), (Range{100, 2000}));
  set_and_compare(bench, general, SetModeAuto{0}, ModeAuto{0});
  set_and_compare(bench, general, SetRange{100, 2000}, Range{100, 2000});
}

TEST(Ping1dClients, PingViewerStartsItsStreamAfterAllSettingsReadBack) {
  Bench bench;
  bench.raw({});
  EXPECT_TRUE(wait_for<DeviceInformation>(bench, general(4), 1s));
  bool streaming = false;
  for (int tick = 0; tick < 10 && !streaming; ++tick) {
    for (const std::uint16_t id : {1215, 1205, 1300, 4, 1201, 1203}) {
      bench.raw(legacy(id));
    }
    bench.run_for(500ms);
    const bool interval = wait_for<PingInterval>(bench, legacy(1206), 100ms) == PingInterval{66};
    const bool speed = wait_for<SpeedOfSound>(bench, legacy(1203), 100ms) == SpeedOfSound{1'500'000};
    const bool automatic = wait_for<ModeAuto>(bench, legacy(1205), 100ms) == ModeAuto{1};
    if (!interval) {
      bench.command(SetPingInterval{66});
    } else if (!speed) {
      bench.command(SetSpeedOfSound{1'500'000});
    } else if (!automatic) {
      bench.command(SetModeAuto{1});
    } else {
      bench.command(ContinuousStart{1300});
      streaming = true;
    }
  }
  ASSERT_TRUE(streaming);
  const std::size_t before = bench.heard.size();
  for (int second = 0; second < 60; ++second) {  // with its slow requests
    for (const std::uint16_t id : {1214, 1213, 1202, 1205}) {
      bench.raw(legacy(id));
    }
    bench.run_for(1s);
  }
  EXPECT_NEAR(static_cast<double>(bench.all<Profile>(before).size()), 60 * 15.15, 5);
  EXPECT_EQ(bench.all<PcbTemperature>(before).size(), 60U);
}

TEST(Ping1dClients, BlueOsProbesAndPollsByOldRequests) {
  Bench bench(with_serial_line());
  bench.raw({'U', 'U', 'U'}, serial_client);
  bench.command(GeneralRequest{5}, serial_client);
  bench.command(GeneralRequest{4}, serial_client);
  EXPECT_EQ(bench.heard.size(), 2U);
  bench.raw(legacy(1004), serial_client);
  EXPECT_EQ(bench.all<Nack>(0, serial_client).size(), 1U);
  bench.run_for(1s);
  const std::size_t before = bench.heard.size();
  for (int i = 0; i < 100; ++i) {
    bench.raw(legacy(1211), serial_client);
    bench.run_for(100ms);
  }
  EXPECT_EQ(bench.all<DistanceSimple>(before, serial_client).size(), 100U);
}

TEST(Ping1dClients, PnarvorsRequestAfterEachMessageIsNeverDropped) {
  Bench bench;
  bench.raw(general(1300));
  std::size_t seen = 0, asked = 1;
  for (int i = 0; i < 1000; ++i) {
    bench.run_for(10ms);
    const std::size_t there = bench.all<Profile>().size();
    for (; seen < there; ++seen, ++asked) {
      bench.raw(general(1300));
    }
  }
  EXPECT_EQ(bench.all<Profile>().size(), asked);
  EXPECT_GT(asked, 900U);
}

TEST(Ping1dClients, RobbalsNodePollsTheDistanceAt10Hz) {
  Bench bench;
  bench.bed.range_m = 3.0;
  std::uint32_t last = 0;
  for (int i = 0; i < 50; ++i) {
    const auto distance = wait_for<Distance>(bench, legacy(1212), 500ms);
    ASSERT_TRUE(distance);
    EXPECT_GE(distance->ping_number, last);
    last = distance->ping_number;
    EXPECT_NEAR(distance->distance_mm, 3000, 1);
    bench.run_for(100ms);
  }
  EXPECT_NEAR(last, 20, 2) << "four pings per second";
}

}  // namespace
}  // namespace sonard::ping1d
