// SPDX-License-Identifier: Apache-2.0
// The checklist of a head's duties for its clients, item by item (protocol/ping360/README.md 7).
#include "bench.hpp"

namespace sonard::ping360 {
namespace {

std::uint16_t number(MessageId id) {
  return static_cast<std::uint16_t>(id);
}

// ---- 1. Requests

TEST(Ping360Checklist1, RequestsAreAnsweredAtOnce) {
  Bench bench;
  bench.raw(fixture("request_protocol_version"));
  bench.raw(fixture("request_device_information"));
  bench.raw(fixture("request_device_data"));
  ASSERT_EQ(bench.heard.size(), 3U);
  EXPECT_EQ(bench.heard[0].frame, fixture("protocol_version"));
  EXPECT_EQ(bench.heard[1].frame, fixture("device_information"));
  EXPECT_EQ(bench.heard[2].frame, fixture("device_data_at_boot")) << "a payload of exactly 14 bytes";
}

TEST(Ping360Checklist1, RequestsAreAnsweredWhileAPingIsUnderWay) {
  Bench bench;
  bench.render_time = 1s;
  bench.command(ping_at(50));
  for (const auto wait : {100ms, 210ms, 100ms, 500ms}) {
    bench.run_for(wait);
    EXPECT_EQ(bench.ask(GeneralRequest{4}).size(), 1U);
    EXPECT_EQ(bench.ask(GeneralRequest{5}).size(), 1U);
    EXPECT_EQ(bench.ask(GeneralRequest{2300}).size(), 1U);
  }
  bench.run_for(5s);
  EXPECT_EQ(bench.jobs.size(), 1U);
  EXPECT_EQ(bench.all<DeviceData>().size(), 5U) << "the ping itself is there, once";
}

TEST(Ping360Checklist1, RequestsAreAnsweredWhileItScansAndDoNotDisturbTheScan) {
  Bench bench;
  bench.command(scan_of(0, 399));
  std::vector<int> expected;
  for (int i = 0; i < 60; ++i) {
    bench.run_for(10ms);
    EXPECT_EQ(bench.ask(GeneralRequest{4}).size(), 1U);
    EXPECT_EQ(bench.ask(GeneralRequest{2300}).size(), 1U);
  }
  const auto angles = angles_of(bench.all<AutoDeviceData>());
  for (int i = 0; i < static_cast<int>(angles.size()); ++i) {
    expected.push_back(i);
  }
  EXPECT_EQ(angles, expected);
  EXPECT_GE(angles.size(), 20U);
}

TEST(Ping360Checklist1, TheStateIsThatOfTheLastCommandWithTheSamplesOfTheLastPing) {
  Bench bench;
  Transducer command = ping_at(150);
  command.mode = 0;
  command.gain_setting = 2;
  bench.command(command);
  bench.run_for(5s);
  const auto state = std::get<DeviceData>(bench.ask(GeneralRequest{2300}).at(0));
  EXPECT_EQ(state, bench.all<DeviceData>().at(0));
  EXPECT_EQ(bytes_of(state.data), test_samples(0, 200));
}

// By the published definition of device_data, if its data are filled in, all other fields date from the time
// when the data were captured.
TEST(Ping360Checklist1, TheStateGoesWithItsSamplesWhileTheNextPingIsUnderWay) {
  Bench bench;
  bench.command(ping_at(150));
  bench.run_for(5s);
  const auto before = bench.all<DeviceData>().at(0);
  Transducer next = ping_at(300);
  next.number_of_samples = 300;
  next.gain_setting = 2;
  bench.command(next);
  bench.run_for(100ms);  // the head turns for 0.9 s
  EXPECT_EQ(std::get<DeviceData>(bench.ask(GeneralRequest{2300}).at(0)), before);
  bench.run_for(5s);
  next.angle = 310;
  next.transmit = 0;
  bench.command(next);
  bench.run_for(1s);
  const auto moved = std::get<DeviceData>(bench.ask(GeneralRequest{2300}).at(0));
  EXPECT_EQ(moved.angle, 310);
  EXPECT_EQ(moved.number_of_samples, 300);
  EXPECT_TRUE(moved.data.empty()) << "what was heard is of another angle";
}

TEST(Ping360Checklist1, TheStateOfAScanIsItsLastPing) {
  Bench bench;
  bench.command(scan_of(10, 200, 10));
  bench.wait_for<AutoDeviceData>(3);
  bench.run_for(40ms);  // the head turns for 61 ms
  const auto state = std::get<AutoDeviceData>(bench.ask(GeneralRequest{2301}).at(0));
  EXPECT_EQ(state, bench.all<AutoDeviceData>().back());
}

TEST(Ping360Checklist1, TheStateOfAScanCanBeAskedForWhileThereIsOne) {
  Bench bench;
  EXPECT_TRUE(bench.ask(GeneralRequest{2301}).at(0) == (Report{Nack{6, "cannot be requested"}}));
  bench.command(scan_of(10, 20));
  const auto before = std::get<AutoDeviceData>(bench.ask(GeneralRequest{2301}).at(0));
  EXPECT_EQ(before.stop_angle, 20);
  EXPECT_TRUE(before.data.empty());
  bench.run_for(1s);
  EXPECT_EQ(std::get<AutoDeviceData>(bench.ask(GeneralRequest{2301}).at(0)).data.size(), 200U);
}

TEST(Ping360Checklist1, WhatCannotBeRequestedIsRefusedInTheNameOfTheRequest) {
  Bench bench;
  for (const int id : {0, 1, 6, 100, 2600, 2601, 2602, 2903, 9999}) {
    EXPECT_TRUE(bench.ask(GeneralRequest{static_cast<std::uint16_t>(id)}).at(0) ==
                (Report{Nack{6, "cannot be requested"}}))
        << id;
  }
}

TEST(Ping360Checklist1, AnEmptyMessageIsARequestForIt) {
  Bench bench;
  for (const std::uint16_t id : {4, 5, 2300}) {
    bench.raw(make_frame(id, 0, 0, {}));
    ASSERT_FALSE(bench.heard.empty());
    EXPECT_EQ(id_of(bench.heard.back().report), id);
  }
}

// ---- 2. One answer for one command

TEST(Ping360Checklist2, OnePingForOneCommandWithItsSettings) {
  Bench bench;
  const Transducer command{.mode = 1,
                           .gain_setting = 2,
                           .angle = 123,
                           .transmit_duration_us = 77,
                           .sample_period = 222,
                           .transmit_frequency_khz = 690,
                           .number_of_samples = 1200};
  bench.command(command);
  bench.run_for(10s);
  ASSERT_EQ(bench.heard.size(), 1U);
  EXPECT_TRUE(bench.heard[0].report == (Report{DeviceData{.gain_setting = 2,
                                                          .angle = 123,
                                                          .transmit_duration_us = 77,
                                                          .sample_period = 222,
                                                          .transmit_frequency_khz = 690,
                                                          .number_of_samples = 1200,
                                                          .data = test_samples(0, 1200)}}));
  EXPECT_EQ(frame_header(bench.heard[0].frame).source, 2);
  EXPECT_EQ(bench.heard[0].frame.size(), 1200U + 14 + 10);
}

TEST(Ping360Checklist2, WithoutTransmissionTheHeadOnlyMoves) {
  Bench bench;
  Transducer command = ping_at(100);
  command.transmit = 0;
  bench.command(command);
  const auto answer = bench.wait_for<DeviceData>(1);
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_EQ(answer[0].angle, 100);
  EXPECT_TRUE(answer[0].data.empty());
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_EQ(bench.now, 610ms) << "as soon as it is there";
}

TEST(Ping360Checklist2, Mode0AndAngle400AreTaken) {
  Bench bench;
  Transducer command = ping_at(400);
  command.mode = 0;
  bench.command(command);
  const auto answer = bench.wait_for<DeviceData>(1);
  EXPECT_EQ(answer.at(0).angle, 0);
  EXPECT_EQ(answer.at(0).mode, 0);
  command.mode = 255;
  bench.command(command);
  EXPECT_EQ(bench.wait_for<DeviceData>(1).at(0).mode, 255);
  EXPECT_EQ(std::ranges::count(bench.told(), "the client's angle 400 is taken as 0"), 1);
  EXPECT_EQ(std::ranges::count_if(bench.told(), [](const auto& it) { return it.find("mode") != it.npos; }),
            0);
}

TEST(Ping360Checklist2, CommandsQueueAndTheOldestIsDropped) {
  Bench bench;
  for (int angle = 1; angle <= 8; ++angle) {
    bench.command(ping_at(angle));
  }
  bench.run_for(10s);
  std::vector<int> angles;
  for (const DeviceData& data : bench.all<DeviceData>()) {
    angles.push_back(data.angle);
  }
  EXPECT_EQ(angles, (std::vector{1, 5, 6, 7, 8})) << "the first was being done";
  EXPECT_EQ(bench.device.counters().commands_dropped, 3U);
}

// ---- 3. Refusals

TEST(Ping360Checklist3, AValueOutOfRangeIsOneNackAndNothingElse) {
  const Transducer good = ping_at(10);
  const std::pair<void (*)(Transducer&), const char*> bad[] = {
      {[](Transducer& it) { it.gain_setting = 3; }, "gain_setting out of range"},
      {[](Transducer& it) { it.angle = 401; }, "angle out of range"},
      {[](Transducer& it) { it.angle = 65535; }, "angle out of range"},
      {[](Transducer& it) { it.transmit_duration_us = 0; }, "transmit_duration out of range"},
      {[](Transducer& it) { it.transmit_duration_us = 1001; }, "transmit_duration out of range"},
      {[](Transducer& it) { it.sample_period = 79; }, "sample_period out of range"},
      {[](Transducer& it) { it.sample_period = 40001; }, "sample_period out of range"},
      {[](Transducer& it) { it.transmit_frequency_khz = 499; }, "transmit_frequency out of range"},
      {[](Transducer& it) { it.transmit_frequency_khz = 1001; }, "transmit_frequency out of range"},
      {[](Transducer& it) { it.number_of_samples = 0; }, "number_of_samples out of range"},
      {[](Transducer& it) { it.number_of_samples = 1201; }, "number_of_samples out of range"},
  };
  for (const auto& [spoil, text] : bad) {
    Bench bench;
    bench.command(scan_of(0, 399));
    bench.run_for(100ms);
    bench.heard.clear();
    Transducer command = good;
    spoil(command);
    EXPECT_TRUE(bench.ask(command).at(0) == (Report{Nack{2601, text}})) << text;
    bench.run_for(1s);
    EXPECT_EQ(bench.all<Nack>().size(), 1U);
    EXPECT_TRUE(bench.all<DeviceData>().empty());
    EXPECT_FALSE(bench.all<AutoDeviceData>().empty()) << "the scan goes on";
  }
}

TEST(Ping360Checklist3, LimitsThemselvesAreTaken) {
  for (const Transducer& command :
       {Transducer{.transmit_duration_us = 1, .transmit_frequency_khz = 500, .number_of_samples = 1},
        Transducer{.gain_setting = 2,
        .angle = 399,
        .transmit_duration_us = 1000,
        .sample_period = 40000,
        .transmit_frequency_khz = 1000,
        .number_of_samples = 1200}}) {
    Bench bench;
    bench.command(command);
    EXPECT_EQ(bench.wait_for<DeviceData>(1).size(), 1U);
  }
}

TEST(Ping360Checklist3, AScanOutOfRangeIsRefused) {
  const std::pair<void (*)(AutoTransmit&), const char*> bad[] = {
      {[](AutoTransmit& it) { it.start_angle = 400; }, "start_angle out of range"},
      {[](AutoTransmit& it) { it.start_angle = 65336; }, "start_angle out of range"},
      {[](AutoTransmit& it) { it.stop_angle = 400; }, "stop_angle out of range"},
      {[](AutoTransmit& it) { it.num_steps = 0; }, "num_steps out of range"},
      {[](AutoTransmit& it) { it.num_steps = 11; }, "num_steps out of range"},
      {[](AutoTransmit& it) { it.delay_ms = 101; }, "delay out of range"},
      {[](AutoTransmit& it) { it.number_of_samples = 1250; }, "number_of_samples out of range"},
  };
  Bench bench;
  for (const auto& [spoil, text] : bad) {
    AutoTransmit command;
    spoil(command);
    EXPECT_TRUE(bench.ask(command).at(0) == (Report{Nack{2602, text}}));
  }
  bench.run_for(1s);
  EXPECT_TRUE(bench.jobs.empty());
  EXPECT_EQ(
      std::ranges::count(bench.told(), "the client's number_of_samples 1250 is refused: expected 1 to 1200"),
      1);
}

TEST(Ping360Checklist3, LimitsOfAScanBelow0WhereTheHeadIsToldToReadThemSo) {
  DeviceConfig config;
  config.signed_scan_angles = true;
  Bench bench(config);
  bench.command(scan_of(65336, 4, 2));  // -200 gradians
  const auto first = bench.wait_for<AutoDeviceData>(2);
  EXPECT_EQ(angles_of(first), (std::vector{200, 202}));
  EXPECT_EQ(first.at(0).start_angle, 65336) << "as it was commanded";
}

TEST(Ping360Checklist3, Angle400WhereTheHeadIsToldToRefuseIt) {
  DeviceConfig config;
  config.accepts_angle_400 = false;
  Bench bench(config);
  EXPECT_TRUE(bench.ask(ping_at(400)).at(0) == (Report{Nack{2601, "angle out of range"}}));
}

TEST(Ping360Checklist3, JunkAndBadChecksumsGetNoAnswer) {
  Bench bench;
  Bytes broken = fixture("request_device_information");
  broken.back() ^= 1;
  for (const Bytes& bytes :
       {broken, Bytes{0x00, 0xFF}, Bytes{}, Bytes(10, 'U'), Bytes{'U', 0}, Bytes{'B', 'R'}}) {
    bench.raw(bytes);
  }
  EXPECT_TRUE(bench.heard.empty());
  bench.run_for(2s);
  bench.raw(fixture("request_device_information"));
  EXPECT_EQ(bench.heard.size(), 1U);
  EXPECT_EQ(bench.device.counters().bad_checksums, 1U);
}

TEST(Ping360Checklist3, UnknownMessagesAndWrongLengthsAreRefusedByTheirNumber) {
  Bench bench;
  EXPECT_TRUE(bench.ask(Unknown{1234}).at(0) == (Report{Nack{1234, "command not recognised"}}));
  bench.raw(fixture("device_data"));
  EXPECT_TRUE(bench.heard.back().report == (Report{Nack{2300, "command not recognised"}}));
  bench.raw(make_frame(number(MessageId::transducer), 0, 0, Bytes(13)));
  EXPECT_TRUE(bench.heard.back().report == (Report{Nack{2601, "wrong payload length"}}));
  bench.raw(make_frame(number(MessageId::general_request), 0, 0, {}));
  EXPECT_TRUE(bench.heard.back().report == (Report{Nack{6, "wrong payload length"}}));
  const std::size_t before = bench.heard.size();
  for (const char* name : {"ack_motor_off", "nack_not_recognised", "ascii_text"}) {
    bench.raw(fixture(name));
  }
  EXPECT_EQ(bench.heard.size(), before) << "another head may say these on the same line";
}

// ---- 4. Scans

TEST(Ping360Checklist4, TheFirstThingSaidIsThePingAtTheStart) {
  Bench bench;
  bench.command(scan_of(37, 300, 3));
  bench.run_for(2s);
  ASSERT_FALSE(bench.heard.empty());
  ASSERT_TRUE(bench.heard[0].get<AutoDeviceData>()) << "no ack";
  EXPECT_EQ(bench.heard[0].get<AutoDeviceData>()->angle, 37);
}

TEST(Ping360Checklist4, EveryPingEchoesTheCommand) {
  Bench bench;
  const AutoTransmit command{.mode = 0,
                             .gain_setting = 1,
                             .transmit_duration_us = 11,
                             .sample_period = 88,
                             .transmit_frequency_khz = 750,
                             .number_of_samples = 1200,
                             .start_angle = 390,
                             .stop_angle = 10,
                             .num_steps = 5,
                             .delay_ms = 7};
  bench.command(command);
  for (const AutoDeviceData& ping : bench.wait_for<AutoDeviceData>(10)) {
    AutoDeviceData expected{.mode = 0,
                            .gain_setting = 1,
                            .angle = ping.angle,
                            .transmit_duration_us = 11,
                            .sample_period = 88,
                            .transmit_frequency_khz = 750,
                            .start_angle = 390,
                            .stop_angle = 10,
                            .num_steps = 5,
                            .delay_ms = 7,
                            .number_of_samples = 1200,
                            .data = ping.data};
    EXPECT_EQ(ping, expected);
    EXPECT_EQ(ping.data.size(), 1200U);
  }
}

TEST(Ping360Checklist4, AllRoundHasNoGapAndGoesOnAtTheStart) {
  Bench bench;
  bench.command(scan_of(0, 399));
  const auto angles = angles_of(bench.wait_for<AutoDeviceData>(810));
  for (std::size_t i = 0; i < angles.size(); ++i) {
    ASSERT_EQ(angles[i], static_cast<int>(i % 400));
  }
}

TEST(Ping360Checklist4, HalfATurnOrLessGoesBackAndForthAcross0) {
  Bench bench;
  bench.command(scan_of(390, 10, 10));
  EXPECT_EQ(angles_of(bench.wait_for<AutoDeviceData>(7)), (std::vector{390, 0, 10, 0, 390, 0, 10}));
}

TEST(Ping360Checklist4, EqualLimitsStareAndASectorOfMoreThanHalfATurnGoesOneWay) {
  Bench bench;
  bench.command(scan_of(77, 77));
  EXPECT_EQ(angles_of(bench.wait_for<AutoDeviceData>(3)), (std::vector{77, 77, 77}));
  bench.command(scan_of(399, 210, 10));
  auto angles = angles_of(bench.wait_for<AutoDeviceData>(23));
  EXPECT_EQ(angles.at(0), 399);
  EXPECT_EQ(angles.at(1), 9);
  EXPECT_EQ(angles.at(21), 209);
  EXPECT_EQ(angles.at(22), 399);
}

TEST(Ping360Checklist4, AScanWaitsForTheCommandThatIsBeingDone) {
  Bench bench;
  bench.command(ping_at(100), client_b);
  bench.command(scan_of(0, 399), client_a);
  bench.run_for(3s);
  ASSERT_GE(bench.heard.size(), 2U);
  EXPECT_TRUE(bench.heard[0].get<DeviceData>());
  EXPECT_EQ(bench.heard[0].to, client_b);
  ASSERT_TRUE(bench.heard[1].get<AutoDeviceData>());
  EXPECT_EQ(bench.heard[1].get<AutoDeviceData>()->angle, 0);
}

TEST(Ping360Checklist4, ANewScanReplacesTheOldOneAtOnce) {
  Bench bench;
  bench.command(scan_of(0, 399));
  bench.run_for(500ms);
  const std::size_t before = bench.heard.size();
  bench.command(scan_of(100, 200, 2));
  bench.run_for(3s);
  const auto pings = bench.all<AutoDeviceData>(before);
  ASSERT_GE(pings.size(), 2U);
  EXPECT_EQ(pings[0].angle, 100);
  EXPECT_EQ(pings[0].num_steps, 2) << "none of the old one comes after it";
  EXPECT_EQ(pings[1].angle, 102);
}

TEST(Ping360Checklist4, ItNeverEndsWhileItsClientLives) {
  DeviceConfig config;
  config.idle_timeout = 30s;
  Bench bench(config);
  bench.command(scan_of(0, 399, 10));
  for (int i = 0; i < 20; ++i) {
    bench.run_for(29s);
    EXPECT_EQ(bench.ask(GeneralRequest{5}).size(), 1U);
  }
  const std::size_t before = bench.heard.size();
  bench.run_for(1s);
  EXPECT_GT(bench.heard.size(), before + 5);
}

// ---- 5. Ends of a scan

struct Ping360Checklist5 : ::testing::Test {
  Bench bench{with_serial_line()};
  std::size_t before = 0;

  void scan(const Peer& by = client_a) {
    bench.command(scan_of(0, 399), by);
    bench.run_for(500ms);
    EXPECT_FALSE(bench.all<AutoDeviceData>().empty());
    before = bench.heard.size();
  }
  void expect_stopped(const char* why) {
    bench.run_for(3s);
    EXPECT_TRUE(bench.all<AutoDeviceData>(before).empty());
    EXPECT_EQ(std::ranges::count(bench.told(), std::string("auto scan ended: ") + why), 1);
  }
};

TEST_F(Ping360Checklist5, MotorOffIsAcknowledgedEveryTime) {
  scan();
  for (int i = 0; i < 10; ++i) {
    bench.raw(fixture("motor_off"));
    EXPECT_EQ(bench.heard.back().frame, fixture("ack_motor_off"));
    bench.run_for(100ms);
  }
  EXPECT_EQ(bench.all<Ack>(before).size(), 10U);
  expect_stopped("motor_off");
}

TEST_F(Ping360Checklist5, ATransducerCommand) {
  scan();
  bench.command(ping_at(5));
  expect_stopped("transducer command received");
  EXPECT_EQ(bench.all<DeviceData>(before).size(), 1U);
}

TEST_F(Ping360Checklist5, AReset) {
  scan();
  bench.raw(fixture("reset"));
  expect_stopped("reset");
  EXPECT_EQ(bench.heard.size(), before) << "it is not answered";
}

TEST_F(Ping360Checklist5, AnEmptyDatagramAndTheNextIsHeardAtOnce) {
  scan();
  bench.raw({});
  EXPECT_EQ(bench.ask(GeneralRequest{4}).size(), 1U);
  expect_stopped("empty datagram received");
}

TEST_F(Ping360Checklist5, UOnTheSerialLine) {
  scan(serial_client);
  bench.raw({'U', 'U', 'U', 0}, serial_client);
  expect_stopped("break received");
}

TEST_F(Ping360Checklist5, UBeforeAnOrderStopsWhatWasAndNotWhatIsOrdered) {
  scan(serial_client);
  Bytes bytes(10, 'U');
  const Bytes order = encode(scan_of(50, 60));
  bytes.insert(bytes.end(), order.begin(), order.end());
  bench.raw(bytes, serial_client);
  bench.run_for(2s);
  EXPECT_EQ(bench.all<AutoDeviceData>(before).at(0).angle, 50);
}

TEST_F(Ping360Checklist5, UInAFrameOrADatagramMeansNothing) {
  scan(serial_client);
  bench.command(GeneralRequest{0x5555}, serial_client);
  bench.raw({'U', 'U', 'U'}, client_a);
  bench.run_for(1s);
  EXPECT_FALSE(bench.all<AutoDeviceData>(before).empty());
}

TEST_F(Ping360Checklist5, NotSilenceOnASerialLine) {
  scan(serial_client);
  bench.run_for(100s);
  before = bench.heard.size();
  bench.run_for(1s);
  EXPECT_FALSE(bench.all<AutoDeviceData>(before).empty());
}

TEST_F(Ping360Checklist5, ItsClientHasGone) {
  scan();
  bench.step(ClientGone{client_a});
  expect_stopped("disconnected");
}

TEST(Ping360Silence, OfAClientEndsItsScanWhereTheHeadIsToldSo) {
  DeviceConfig config;
  config.idle_timeout = 30s;
  Bench bench(config);
  bench.command(scan_of(0, 399, 10));
  bench.run_for(29s);
  const std::size_t before = bench.heard.size();
  bench.run_for(500ms);
  EXPECT_GT(bench.heard.size(), before);
  bench.run_for(1s);
  const std::size_t after = bench.heard.size();
  bench.run_for(10s);
  EXPECT_EQ(bench.heard.size(), after);
  EXPECT_TRUE(bench.last.nobody_there);
}

TEST(Ping360Silence, OfAClientDoesNotMatterByDefault) {
  Bench bench;
  bench.command(scan_of(0, 399, 10));
  bench.run_for(200s);
  const std::size_t before = bench.heard.size();
  bench.run_for(1s);
  EXPECT_GT(bench.heard.size(), before);
}

// ---- 6. Two clients

TEST(Ping360Checklist6, ClientsHaveAParserEach) {
  Bench bench;
  const Bytes question = fixture("request_device_information");
  for (const std::uint8_t byte : question) {
    bench.raw({byte}, client_a);
    bench.raw({byte}, client_b);
  }
  ASSERT_EQ(bench.heard.size(), 2U);
  EXPECT_EQ(bench.heard[0].to, client_a);
  EXPECT_EQ(bench.heard[1].to, client_b);
}

TEST(Ping360Checklist6, AnswersGoToTheAsker) {
  Bench bench;
  bench.command(scan_of(0, 399), client_a);
  bench.run_for(100ms);
  bench.command(GeneralRequest{4}, client_b);
  bench.run_for(100ms);
  bench.command(ping_at(3), client_b);
  bench.run_for(1s);
  for (const Heard& it : bench.heard) {
    EXPECT_EQ(it.to, it.get<AutoDeviceData>() ? client_a : client_b);
  }
  EXPECT_EQ(bench.all<DeviceInformation>().size(), 1U);
  EXPECT_EQ(bench.all<DeviceData>().size(), 1U);
}

TEST(Ping360Checklist6, TheSameAddressOnTwoPortsOfOursIsTwoClients) {
  Bench bench;
  Peer other_port = client_a;
  other_port.channel = 2;
  bench.raw(fixture("transducer"), client_a);
  bench.raw(fixture("request_protocol_version"), other_port);
  bench.run_for(5s);
  ASSERT_EQ(bench.heard.size(), 2U);
  EXPECT_EQ(bench.heard[0].to, other_port);
  EXPECT_EQ(bench.heard[1].to, client_a);
}

TEST(Ping360Checklist6, AllHearAllBehindABridge) {
  DeviceConfig config;
  config.fan_out = FanOut::all;
  Bench bench(config);
  bench.raw({0}, client_b);
  EXPECT_EQ(bench.ask(GeneralRequest{4}, client_a).size(), 2U);
  bench.command(scan_of(0, 399), client_a);
  bench.run_for(100ms);
  const auto count = [&](const Peer& peer) { return std::ranges::count(bench.heard, peer, &Heard::to); };
  EXPECT_EQ(count(client_a), count(client_b));
  EXPECT_GT(count(client_b), 2);
}

}  // namespace
}  // namespace sonard::ping360
