// SPDX-License-Identifier: Apache-2.0
// Public clients, with their order of messages and their bytes (protocol/ping360/README.md 6). The models of
// their loops follow the description of the messages that they send and await.
#include "bench.hpp"

namespace sonard::ping360 {
namespace {

using namespace std::chrono_literals;

/// A client's end of the line: it reads the frames sent to its address, with timeouts.
struct PublicClient {
  Bench& bench;
  Peer peer = client_a;
  std::size_t read = 0;

  /// The next frame that `wanted` accepts; earlier frames are skipped. nullopt after `timeout`.
  std::optional<Heard> wait(std::chrono::nanoseconds timeout,
                            const std::function<bool(const Report&)>& wanted) {
    const TimePoint end = bench.now + timeout;
    for (;;) {
      for (; read < bench.heard.size(); ++read) {
        const Heard& it = bench.heard[read];
        if (it.to == peer && wanted(it.report)) {
          Heard found = it;
          found.report = *decode_report(found.frame);
          ++read;
          return found;
        }
      }
      if (bench.next_event() > end) {
        bench.run_until(end);
        return std::nullopt;
      }
      bench.run_once();
    }
  }
  template <class... Messages>
  std::optional<Heard> wait_for(std::chrono::nanoseconds timeout) {
    return wait(timeout,
                [](const Report& report) { return (std::holds_alternative<Messages>(report) || ...); });
  }
};

/// The command as brping sends it. One of its bytes differs from the default.
Transducer as_brping(int angle) {
  Transducer command = std::get<Transducer>(*decode_command(fixture("transducer_brping")));
  command.angle = static_cast<std::uint16_t>(angle);
  return command;
}

// ---- brping

TEST(Ping360Clients, BrpingInitialisesAndTurnsWithMode0) {
  DeviceConfig config;
  config.max_datagram = 100;  // brping joins the pieces
  Bench bench(config);
  PublicClient client{bench};
  bench.raw(fixture("request_protocol_version"));
  ASSERT_TRUE(client.wait_for<ProtocolVersion>(500ms));
  bench.raw(fixture("request_device_data"));
  ASSERT_TRUE(client.wait_for<DeviceData>(500ms));
  for (int angle = 0; angle < 400; angle += 10) {
    bench.command(as_brping(angle));
    const auto answer = client.wait_for<DeviceData, Nack>(4s);
    ASSERT_TRUE(answer);
    const auto* const data = answer->get<DeviceData>();
    ASSERT_TRUE(data);
    EXPECT_EQ(data->angle, angle);
    EXPECT_EQ(data->mode, 0);
    EXPECT_EQ(data->data.size(), 400U);
  }
  bench.raw(fixture("motor_off"));
  EXPECT_TRUE(client.wait_for<Ack>(1s));
}

TEST(Ping360Clients, BrpingGetsANackBackForWhatIsRefused) {
  Bench bench;
  PublicClient client{bench};
  Transducer command = as_brping(0);
  command.number_of_samples = 5000;
  bench.command(command);
  const auto answer = client.wait_for<DeviceData, Nack>(4s);
  ASSERT_TRUE(answer && answer->get<Nack>());
  EXPECT_EQ(answer->get<Nack>()->nacked_id, 2601);
}

TEST(Ping360Clients, BrpingOnASerialLineBeginsWithUAndFindsAQuietHead) {
  Bench bench(with_serial_line());
  bench.command(scan_of(0, 399), serial_client);  // an earlier client left this scan running
  bench.run_for(1s);
  PublicClient client{bench, serial_client, bench.heard.size()};
  bench.raw({'U'}, serial_client);
  bench.raw(fixture("request_protocol_version"), serial_client);
  ASSERT_TRUE(client.wait_for<ProtocolVersion>(500ms));
  bench.run_for(1s);
  EXPECT_EQ(client.read, bench.heard.size());
}

// ---- ping-cpp, its hardware test

struct Ping360PingCpp : ::testing::Test {
  Bench bench;
  PublicClient client{bench};

  void connect() {
    bench.raw({0x00, 0xFF});
    bench.raw(fixture("request_protocol_version"));
    const auto version = client.wait_for<ProtocolVersion>(500ms);
    ASSERT_TRUE(version);
    EXPECT_EQ(version->frame, fixture("protocol_version"));
    bench.raw(fixture("request_device_information"));
    const auto information = client.wait_for<DeviceInformation>(500ms);
    ASSERT_TRUE(information);
    EXPECT_EQ(information->get<DeviceInformation>()->device_type, 2);
    EXPECT_GT(information->get<DeviceInformation>()->device_revision, 0);
    EXPECT_EQ(frame_header(information->frame).source, 2);
  }
};

TEST_F(Ping360PingCpp, HardwareTest200PingsAnd200OfAScanWithoutAGap) {
  connect();
  for (int angle = 0; angle < 200; ++angle) {
    bench.command(ping_at(angle));
    const auto answer = client.wait_for<DeviceData>(8s);
    ASSERT_TRUE(answer);
    EXPECT_EQ(answer->get<DeviceData>()->angle, angle);
  }
  bench.raw(fixture("auto_transmit"));
  for (int angle = 0; angle < 200; ++angle) {
    const auto answer = client.wait_for<AutoDeviceData>(8s);
    ASSERT_TRUE(answer);
    ASSERT_EQ(answer->get<AutoDeviceData>()->angle, angle);
  }
  bench.raw(fixture("motor_off"));
  const auto ack = client.wait_for<Ack>(1s);
  ASSERT_TRUE(ack);
  EXPECT_EQ(ack->frame, fixture("ack_motor_off"));
}

TEST_F(Ping360PingCpp, BeginsOnASerialLineWithUAndNul) {
  Bench serial(with_serial_line());
  PublicClient end{serial, serial_client};
  serial.raw(Bytes{'U', 'U', 'U', 'U', 'U', 'U', 'U', 'U', 'U', 'U', 0}, serial_client);
  serial.raw(fixture("request_protocol_version"), serial_client);
  EXPECT_TRUE(end.wait_for<ProtocolVersion>(500ms));
}

TEST_F(Ping360PingCpp, TakesANackOfARequestForItsAnswerOnlyByTheRightNumber) {
  bench.command(GeneralRequest{1211});
  const auto nack = client.wait_for<Nack>(500ms);
  ASSERT_TRUE(nack);
  EXPECT_EQ(nack->get<Nack>()->nacked_id, 6);
}

// ---- ROS nodes

TEST_F(Ping360PingCpp, RosNodeSends400For0AndANackWouldBeStaleData) {
  connect();
  for (int turn = 0; turn < 2; ++turn) {
    for (int angle = 20; angle <= 400; angle += 20) {
      Transducer command = ping_at(angle);
      command.number_of_samples = 1200;
      bench.command(command);
      const auto answer = client.wait_for<DeviceData, Nack>(8s);
      ASSERT_TRUE(answer);
      ASSERT_TRUE(answer->get<DeviceData>());
      EXPECT_EQ(answer->get<DeviceData>()->angle, angle % 400);
      EXPECT_EQ(answer->get<DeviceData>()->data.size(), 1200U);
    }
  }
  bench.raw(fixture("motor_off"));
  EXPECT_TRUE(client.wait_for<Ack>(1s));
}

TEST(Ping360Clients, RosNodeInPythonRepeatsItsBytes) {
  Bench bench;
  PublicClient client{bench};
  for (int i = 0; i < 45; ++i) {
    bench.raw(fixture("transducer_ros_python"));
    const auto answer = client.wait_for<DeviceData, Nack>(4s);
    ASSERT_TRUE(answer && answer->get<DeviceData>());
    EXPECT_EQ(answer->get<DeviceData>()->angle, 10);
    EXPECT_EQ(answer->get<DeviceData>()->gain_setting, 1);
  }
}

// ---- pnarvor/ping360_driver

/// The client reads datagrams into 1024 bytes, and the first one must have 14 bytes.
TEST(Ping360Clients, PnarvorReadsIts512SamplesWhole) {
  Bench bench;
  bench.raw(fixture("request_protocol_version"));
  ASSERT_EQ(bench.datagrams.size(), 1U);
  EXPECT_EQ(bench.datagrams[0].bytes.size(), 14U);
  bench.raw(fixture("transducer_pnarvor"));
  bench.run_for(2s);
  ASSERT_EQ(bench.datagrams.size(), 2U);
  EXPECT_LE(bench.datagrams[1].bytes.size(), 1024U);
  EXPECT_EQ(bench.all<DeviceData>().at(0).data.size(), 512U);
}

TEST(Ping360Clients, PnarvorReads1000SamplesAndOfMoreOnlyWhereDatagramsAreSplit) {
  Transducer command = ping_at(0);
  command.number_of_samples = 1000;
  Bench bench;
  bench.command(command);
  bench.run_for(1s);
  EXPECT_EQ(bench.datagrams.at(0).bytes.size(), 1024U);
  DeviceConfig config;
  config.max_datagram = 1024;
  Bench splits(config);
  command.number_of_samples = 1200;
  splits.command(command);
  splits.run_for(1s);
  ASSERT_EQ(splits.datagrams.size(), 2U);
  EXPECT_EQ(splits.datagrams[1].bytes.size(), 200U);
}

// ---- ping-viewer

struct Ping360PingViewer : ::testing::Test {
  Bench bench;
  PublicClient client{bench};
  AutoTransmit wanted{.transmit_duration_us = 11,
                      .sample_period = 88,
                      .transmit_frequency_khz = 750,
                      .number_of_samples = 1200};

  /// Sends an empty datagram, waits 100 ms and sends the request. The first frame of any type must be the
  /// answer.
  void detect() {
    bench.raw({});
    bench.run_for(100ms);
    bench.raw(fixture("request_device_information"));
    const auto first = client.wait(1s, [](const Report&) { return true; });
    ASSERT_TRUE(first);
    EXPECT_EQ(first->frame, fixture("device_information"));
  }
  void order_scan() {
    bench.raw({});
    bench.run_for(200ms);
    client.read = bench.heard.size();
    bench.command(wanted);
  }
  /// True if all settings are exact. Otherwise the client would send its order again.
  bool is_content_with(const AutoDeviceData& data) const {
    return data.gain_setting == wanted.gain_setting &&
           data.transmit_duration_us == wanted.transmit_duration_us &&
           data.sample_period == wanted.sample_period &&
           data.transmit_frequency_khz == wanted.transmit_frequency_khz &&
           data.data.size() == wanted.number_of_samples && data.start_angle == wanted.start_angle &&
           data.stop_angle == wanted.stop_angle && data.num_steps == wanted.num_steps &&
           data.delay_ms == wanted.delay_ms;
  }
};

TEST_F(Ping360PingViewer, DetectsTheHeadThoughAnotherClientScans) {
  bench.command(scan_of(0, 399), client_b);
  bench.run_for(1s);
  detect();
}

TEST_F(Ping360PingViewer, ScansTurnsChangesSettingsAndLeaves) {
  detect();
  order_scan();
  for (int ping = 0; ping < 450; ++ping) {
    const auto answer = client.wait_for<AutoDeviceData>(4200ms);
    ASSERT_TRUE(answer);
    ASSERT_TRUE(is_content_with(*answer->get<AutoDeviceData>()));
    EXPECT_EQ(answer->get<AutoDeviceData>()->angle, ping % 400);
  }
  // Its sector of 120 degrees: 133 gradians about 200, which is straight ahead.
  wanted.start_angle = 134;
  wanted.stop_angle = 265;
  wanted.num_steps = 4;
  wanted.gain_setting = 2;
  order_scan();
  for (const int expected : {134, 138, 142}) {
    const auto answer = client.wait_for<AutoDeviceData>(4200ms);
    ASSERT_TRUE(answer);
    EXPECT_TRUE(is_content_with(*answer->get<AutoDeviceData>()))
        << "no ping of the old scan comes after the order";
    EXPECT_EQ(answer->get<AutoDeviceData>()->angle, expected);
  }
  bench.raw({});
  for (int i = 0; i < 10; ++i) {
    bench.raw(fixture("motor_off"));
    bench.run_for(100ms);
  }
  EXPECT_EQ(bench.all<Ack>().size(), 10U);
}

TEST_F(Ping360PingViewer, OlderFirmwareIsTurnedWithSingleCommandsQuicklyEnough) {
  PublicClient loop{bench};
  Transducer command = ping_at(0);
  command.number_of_samples = 1200;
  command.sample_period = 88;
  for (int angle = 0; angle < 400; angle += 10) {
    command.angle = static_cast<std::uint16_t>(angle);
    bench.command(command);
    ASSERT_TRUE(loop.wait_for<DeviceData>(10 * 6ms + 200ms)) << "it would send the command again";
  }
}

/// The loop of ping-viewer with firmware up to 3.3.0 and of iPing360Device. After an answer to any command,
/// it sends the command for the angle after the answer's angle. Without an answer in time it repeats its
/// command.
struct StepLoop {
  PublicClient client;
  Transducer command;
  int step;
  std::chrono::nanoseconds patience;

  void send() { client.bench.command(command, client.peer); }
  /// Runs until `count` answers have come and returns their angles. It sends no command after the last
  /// answer.
  std::vector<int> run(std::size_t count) {
    std::vector<int> angles;
    for (int unanswered = 0; angles.size() < count && unanswered < 100;) {
      const auto answer = client.wait_for<DeviceData, Nack>(patience);
      const auto* const data = answer ? answer->get<DeviceData>() : nullptr;
      unanswered = data ? 0 : unanswered + 1;
      if (data) {
        angles.push_back(data->angle);
        command.angle = static_cast<std::uint16_t>((data->angle + step) % 400);
      }
      if (angles.size() < count) {
        send();
      }
    }
    return angles;
  }
};

std::vector<int> turn_of(int first, int step, std::size_t count) {
  std::vector<int> angles;
  for (std::size_t i = 0; i < count; ++i) {
    angles.push_back((first + static_cast<int>(i) * step) % 400);
  }
  return angles;
}

/// Two turns. The head needs longer to the first angle than the loop waits.
void expect_one_ping_an_angle(StepLoop loop, std::chrono::nanoseconds render_time) {
  Bench& bench = loop.client.bench;
  bench.render_time = render_time;
  const auto count = static_cast<std::size_t>(800 / loop.step);
  const int first = loop.command.angle;
  loop.send();
  EXPECT_EQ(loop.run(count), turn_of(first, loop.step, count));
  EXPECT_EQ(bench.jobs.size(), count) << "one ping for each";
  EXPECT_GE(bench.device.counters().commands_joined, 2U) << "it has sent some again";
  EXPECT_EQ(bench.device.counters().commands_dropped, 0U);
}

// The loop begins at 200 gradians, which it draws straight ahead. The head needs 1.2 s to this angle after
// boot. The loop waits 6 ms per gradian plus 200 ms for each answer. With a slower renderer it repeats each
// command.
TEST(Ping360Clients, PingViewerWithFirmware330GetsOnePingAnAngle) {
  for (const int step : {1, 5}) {
    for (const auto render_time : {5ms, 300ms}) {
      Bench bench;
      Transducer command{.angle = 200,
                         .transmit_duration_us = 11,
                         .sample_period = 88,
                         .transmit_frequency_khz = 750,
                         .number_of_samples = 1200};
      expect_one_ping_an_angle({{bench}, command, step, 200ms + step * 6ms}, render_time);
    }
  }
}

TEST(Ping360Clients, Iping360deviceGetsOnePingAnAngleThoughItRepeatsTheFirstCommand) {
  for (const auto render_time : {5ms, 250ms}) {
    Bench bench;
    expect_one_ping_an_angle({{bench}, as_brping(150), 1, 200ms}, render_time);
  }
}

// The head cannot distinguish a command repeated just as its answer leaves from a request for another ping.
// This costs one ping. The two answers cause two commands, which are equal.
TEST(Ping360Clients, ARepeatedCommandThatCrossesItsAnswerCostsOnePing) {
  Bench bench;
  StepLoop loop{{bench}, as_brping(0), 1, 200ms};
  loop.send();
  loop.run(10);
  loop.command.angle = 9;
  loop.send();
  loop.command.angle = 10;
  loop.send();
  const std::size_t before = bench.jobs.size();
  EXPECT_EQ(loop.run(1), std::vector{9});
  loop.send();
  EXPECT_EQ(loop.run(100), turn_of(10, 1, 100));
  EXPECT_EQ(bench.jobs.size(), before + 100);
}

// A client that repeats its order to scan every 5 s. A turn at 20 m takes 20 s.
TEST(Ping360Clients, AutoTransmitSentEvery5SScansWholeTurns) {
  Bench bench;
  const AutoTransmit command{.sample_period = 888, .number_of_samples = 1200};
  for (int i = 0; i < 13; ++i) {
    bench.command(command);
    bench.run_for(5s);
  }
  const auto angles = angles_of(bench.all<AutoDeviceData>());
  EXPECT_GT(angles.size(), 1200U) << "three turns";
  EXPECT_EQ(angles, turn_of(0, 1, angles.size()));
}

TEST(Ping360Clients, AutoTransmitSentEverySecondTurnsAtBothEndsOfASector) {
  Bench bench;
  for (int i = 0; i < 20; ++i) {
    bench.command(scan_of(380, 20, 5));
    bench.run_for(1s);
  }
  const auto angles = angles_of(bench.all<AutoDeviceData>());
  ASSERT_GT(angles.size(), 50U);
  const std::vector<int> sector{380, 385, 390, 395, 0, 5, 10, 15, 20, 15, 10, 5, 0, 395, 390, 385};
  for (std::size_t i = 0; i < angles.size(); ++i) {
    ASSERT_EQ(angles[i], sector[i % sector.size()]) << i;
  }
}

TEST_F(Ping360PingViewer, AsksInTheOldWayToo) {
  bench.raw(make_frame(4, 0, 0, {}));
  EXPECT_TRUE(client.wait_for<DeviceInformation>(1s));
}

// ---- BlueOS, which searches the best speed of a serial line

TEST(Ping360Clients, BlueosAsksTenTimesAtEachSpeedAndHearsNothingAtWrongOnes) {
  Bench bench(with_serial_line());
  PublicClient client{bench, serial_client};
  for (int i = 0; i < 10; ++i) {
    bench.raw({0x11, 0x42, 0x52, 0xE6, 0x0F, 0x98, 0x00}, serial_client);  // as read at a wrong speed
    EXPECT_FALSE(client.wait_for<DeviceInformation>(100ms));
  }
  for (int i = 0; i < 10; ++i) {
    bench.raw(fixture("request_device_information"), serial_client);
    EXPECT_TRUE(client.wait_for<DeviceInformation>(100ms)) << i;
  }
}

// ---- A head that is locked to its first client (docs/security.md)

const Peer other_client{0, {0x7F000003, 4000}, 0};

DeviceConfig locked_config() {
  DeviceConfig config = with_serial_line();
  config.lock_to_first = true;
  config.idle_timeout = 30s;
  return config;
}

TEST(Ping360Lock, DropsWhatOthersSendUntilTheFirstIsSilentForItsTimeout) {
  Bench bench(locked_config());
  bench.command(scan_of(0, 399));
  for (const Peer& other : {other_client, serial_client}) {
    EXPECT_TRUE(bench.ask(GeneralRequest{5}, other).empty());
    EXPECT_TRUE(bench.ask(MotorOff{}, other).empty());
    bench.raw({}, other);  // a break
  }
  EXPECT_EQ(bench.device.counters().locked_out, 6U);
  const std::size_t before = bench.heard.size();
  bench.run_until(29s);
  EXPECT_GT(bench.all<AutoDeviceData>(before).size(), 100U) << "the scan goes on";
  bench.raw(fixture("request_protocol_version"),
            {0, {client_a.remote.address, 4999}, 0});  // its client sends again
  bench.run_until(58s);
  EXPECT_TRUE(bench.ask(GeneralRequest{5}, other_client).empty());
  bench.run_until(59s);
  EXPECT_EQ(bench.ask(GeneralRequest{5}, other_client).size(), 1U);
  EXPECT_TRUE(bench.ask(GeneralRequest{5}).empty()) << "now the other has it";
}

TEST(Ping360Lock, IsNotTakenByNoiseAndEndsWithAReset) {
  Bench bench(locked_config());
  bench.raw({'B', 'R', 0, 1, 2, 3}, other_client);
  EXPECT_EQ(bench.ask(GeneralRequest{5}).size(), 1U);
  bench.command(Reset{});
  bench.run_for(2s);
  EXPECT_EQ(bench.ask(GeneralRequest{5}, other_client).size(), 1U);
}

}  // namespace
}  // namespace sonard::ping360
