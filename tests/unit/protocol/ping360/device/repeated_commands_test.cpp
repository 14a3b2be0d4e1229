// SPDX-License-Identifier: Apache-2.0
// Commands that repeat an unanswered command, and repeated orders to scan
// (protocol/ping360/README.md 3.2, 3.3).
#include "bench.hpp"

namespace sonard::ping360 {
namespace {

std::vector<int> answered_angles(const Bench& bench) {
  std::vector<int> angles;
  for (const DeviceData& data : bench.all<DeviceData>()) {
    angles.push_back(data.angle);
  }
  return angles;
}

// ---- transducer

TEST(Ping360RepeatedCommand, SharesTheAnswerOfTheOneUnderWayWhereverThatIs) {
  // The head turns for 0.61 s and listens for 0.4 ms. Rendering takes 1 s, and the answer leaves 18 ms later
  // at the earliest.
  for (const auto later : {0ms, 200ms, 609ms, 611ms, 1600ms}) {
    Bench bench;
    bench.render_time = 1s;
    bench.command(ping_at(100));
    bench.run_for(later);
    bench.command(ping_at(100));
    bench.run_for(5s);
    EXPECT_EQ(answered_angles(bench), std::vector{100}) << later.count();
    EXPECT_EQ(bench.jobs.size(), 1U);
    EXPECT_EQ(bench.device.counters().commands_joined, 1U);
  }
}

TEST(Ping360RepeatedCommand, IsANewPingOnceItsAnswerHasLeft) {
  Bench bench;
  for (int i = 0; i < 3; ++i) {
    bench.command(ping_at(100));
    ASSERT_EQ(bench.wait_for<DeviceData>(1).size(), 1U);
  }
  EXPECT_EQ(bench.jobs.size(), 3U);
  EXPECT_EQ(bench.device.counters().commands_joined, 0U);
}

TEST(Ping360RepeatedCommand, SharesTheAnswerOfTheLastThatWaits) {
  Bench bench;
  for (const int angle : {1, 2, 3, 3, 3}) {
    bench.command(ping_at(angle));
  }
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), (std::vector{1, 2, 3}));
}

TEST(Ping360RepeatedCommand, IsDoneAgainWhenAnotherWasOrderedInBetween) {
  Bench bench;
  for (const int angle : {1, 2, 1, 2}) {
    bench.command(ping_at(angle));
  }
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), (std::vector{1, 2, 1, 2}));
}

TEST(Ping360RepeatedCommand, IsEqualInEverySetting) {
  void (*const changes[])(Transducer&) = {
      [](Transducer& it) { it.mode = 0; },
      [](Transducer& it) { it.gain_setting = 1; },
      [](Transducer& it) { it.angle = 51; },
      [](Transducer& it) { it.transmit_duration_us = 33; },
      [](Transducer& it) { it.sample_period = 81; },
      [](Transducer& it) { it.transmit_frequency_khz = 741; },
      [](Transducer& it) { it.number_of_samples = 201; },
      [](Transducer& it) { it.transmit = 0; },
  };
  for (const auto& change : changes) {
    Bench bench;
    bench.command(ping_at(50));
    Transducer other = ping_at(50);
    change(other);
    bench.command(other);
    bench.run_for(5s);
    EXPECT_EQ(bench.all<DeviceData>().size(), 2U);
  }
}

TEST(Ping360RepeatedCommand, MayCallTheAngle0Or400) {
  Bench bench;
  bench.command(ping_at(200));
  bench.command(ping_at(400));
  bench.command(ping_at(0));
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), (std::vector{200, 0}));
}

TEST(Ping360RepeatedCommand, MayBeOneThatOnlyMoves) {
  Bench bench;
  Transducer command = ping_at(100);
  command.transmit = 0;
  bench.command(command);
  bench.run_for(200ms);
  bench.command(command);
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), std::vector{100});
}

TEST(Ping360RepeatedCommand, OfAnotherClientIsDoneForThatClient) {
  Bench bench;
  bench.command(ping_at(50), client_a);
  bench.command(ping_at(50), client_b);
  bench.command(ping_at(50), client_a);  // joins the first command, although another has arrived since
  bench.command(ping_at(50), client_b);
  bench.run_for(5s);
  ASSERT_EQ(bench.heard.size(), 2U);
  EXPECT_EQ(bench.heard[0].to, client_a);
  EXPECT_EQ(bench.heard[1].to, client_b);
}

TEST(Ping360RepeatedCommand, IsDoneAgainAfterAStopAResetOrAnOrderToScan) {
  const Command between[] = {MotorOff{}, Reset{}, scan_of(0, 399)};
  for (const Command& stop : between) {
    Bench bench;
    bench.command(ping_at(100));
    bench.run_for(200ms);
    bench.command(stop);
    bench.run_for(std::holds_alternative<Reset>(stop) ? 1s : 0s);
    bench.command(ping_at(100));
    bench.run_for(5s);
    const std::size_t answers = std::holds_alternative<AutoTransmit>(stop) ? 2 : 1;
    EXPECT_EQ(bench.all<DeviceData>().size(), answers);
    EXPECT_EQ(bench.device.counters().commands_joined, 0U);
    EXPECT_TRUE(bench.all<AutoDeviceData>().empty());
  }
}

TEST(Ping360RepeatedCommand, HasNoAnswerIfThePingFailsAndCanBeSentAgain) {
  Bench bench;
  bench.renderer_fails = true;
  bench.command(ping_at(0));
  bench.command(ping_at(0));
  bench.run_for(1s);
  EXPECT_TRUE(bench.heard.empty());
  bench.renderer_fails = false;
  bench.command(ping_at(0));
  bench.run_for(1s);
  EXPECT_EQ(bench.all<DeviceData>().size(), 1U);
}

TEST(Ping360RepeatedCommand, IsAPingOfItsOwnIfTheHeadIsToldSo) {
  DeviceConfig config;
  config.joins_repeated_commands = false;
  Bench bench(config);
  for (int i = 0; i < 3; ++i) {
    bench.command(ping_at(100));
  }
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), (std::vector{100, 100, 100}));
}

TEST(Ping360Queue, OfLength0DropsWhatComesWhileACommandIsDone) {
  DeviceConfig config;
  config.queue_length = 0;
  Bench bench(config);
  for (const int angle : {100, 1, 2, 100}) {
    bench.command(ping_at(angle));
  }
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), std::vector{100});
  EXPECT_EQ(bench.device.counters().commands_dropped, 2U);
  bench.command(ping_at(3));
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), (std::vector{100, 3})) << "an idle head takes each command";
  bench.command(scan_of(0, 399));
  bench.run_for(1s);
  bench.command(ping_at(4));
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench).back(), 4) << "a scan is no command that is being done";
}

TEST(Ping360Queue, HasRoomForItsLengthBesideTheFirstOfADatagram) {
  Bench bench;
  Bytes all;
  for (int angle = 1; angle <= 5; ++angle) {
    const Bytes one = encode(ping_at(angle));
    all.insert(all.end(), one.begin(), one.end());
  }
  bench.raw(all);
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), (std::vector{1, 2, 3, 4, 5}));
}

// ---- auto_transmit

TEST(Ping360RepeatedScan, GoesOn) {
  Bench bench;
  bench.command(scan_of(10, 300));
  bench.run_for(1s);
  const std::size_t jobs = bench.jobs.size();
  bench.command(scan_of(10, 300));
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  bench.run_for(1s);
  const auto angles = angles_of(bench.all<AutoDeviceData>());
  ASSERT_GT(angles.size(), 40U);
  for (std::size_t i = 0; i < angles.size(); ++i) {
    ASSERT_EQ(angles[i], 10 + static_cast<int>(i));
  }
  EXPECT_GT(bench.jobs.size(), jobs + 20) << "at the same pace";
  EXPECT_EQ(bench.device.counters().pings_cancelled, 0U);
}

TEST(Ping360RepeatedScan, BeginsAnewIfASettingDiffers) {
  void (*const changes[])(AutoTransmit&) = {
      [](AutoTransmit& it) { it.mode = 0; },
      [](AutoTransmit& it) { it.gain_setting = 1; },
      [](AutoTransmit& it) { it.transmit_duration_us = 33; },
      [](AutoTransmit& it) { it.sample_period = 81; },
      [](AutoTransmit& it) { it.transmit_frequency_khz = 741; },
      [](AutoTransmit& it) { it.number_of_samples = 201; },
      [](AutoTransmit& it) { it.stop_angle = 301; },
      [](AutoTransmit& it) { it.num_steps = 2; },
      [](AutoTransmit& it) { it.delay_ms = 1; },
  };
  for (const auto& change : changes) {
    Bench bench;
    bench.command(scan_of(10, 300));
    bench.run_for(1s);
    AutoTransmit other = scan_of(10, 300);
    change(other);
    const std::size_t before = bench.heard.size();
    bench.command(other);
    bench.run_for(1s);
    EXPECT_EQ(angles_of(bench.all<AutoDeviceData>(before)).at(0), 10);
  }
}

TEST(Ping360RepeatedScan, OfAnotherClientBeginsAnewForThatClient) {
  Bench bench;
  bench.command(scan_of(10, 300), client_a);
  bench.run_for(1s);
  const std::size_t before = bench.heard.size();
  bench.command(scan_of(10, 300), client_b);
  bench.run_for(1s);
  ASSERT_GT(bench.heard.size(), before);
  EXPECT_EQ(angles_of(bench.all<AutoDeviceData>(before)).at(0), 10);
  for (std::size_t i = before; i < bench.heard.size(); ++i) {
    EXPECT_EQ(bench.heard[i].to, client_b);
  }
}

TEST(Ping360RepeatedScan, BeginsAnewAfterWhatEndsAScan) {
  const Bytes ends[] = {{}, encode(MotorOff{}), encode(ping_at(10))};
  for (const Bytes& end : ends) {
    Bench bench;
    bench.command(scan_of(10, 300));
    bench.run_for(1s);
    bench.raw(end);
    const std::size_t before = bench.heard.size();
    bench.command(scan_of(10, 300));
    bench.run_for(1s);
    EXPECT_EQ(angles_of(bench.all<AutoDeviceData>(before)).at(0), 10);
  }
}

TEST(Ping360RepeatedScan, StillWaitsForTheCommandBeforeIt) {
  Bench bench;
  bench.command(ping_at(100));
  bench.command(scan_of(0, 399));
  bench.run_for(200ms);
  bench.command(scan_of(0, 399));
  bench.run_for(5s);
  EXPECT_EQ(answered_angles(bench), std::vector{100});
  EXPECT_EQ(angles_of(bench.all<AutoDeviceData>()).at(0), 0);
}

}  // namespace
}  // namespace sonard::ping360
