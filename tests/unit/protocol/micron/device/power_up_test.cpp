// SPDX-License-Identifier: Apache-2.0
// From power-up to a scan, as the alives show it (protocol/micron/README.md 6.2, 7).
#include "bench.hpp"

namespace sonard::micron {
namespace {

using Infos = std::vector<int>;

TEST(PowerUp, HeadIsThereWhenTheDaemonIs) {
  Bench bench;
  EXPECT_EQ(bench.head_infos(), Infos{0x4A}) << "at once";
  EXPECT_EQ(bench.device.state(bench.now), HeadState::without_parameters);
  bench.run_until(2s);
  const auto alives = bench.all<Alive>();
  ASSERT_EQ(alives.size(), 3U);
  for (std::size_t i = 0; i < alives.size(); ++i) {
    EXPECT_EQ(alives[i].first, i * 1s);
    EXPECT_EQ(alives[i].second.time_ms, i * 1000);
    EXPECT_EQ(alives[i].second.needs_parameters, 0x80);
    EXPECT_EQ(alives[i].second.position, 3200);
  }
}

TEST(PowerUp, AlivesTellBootCentringParametersAndScan) {
  DeviceConfig config;
  config.alive_after_head_command = false;
  Bench bench(config);
  const TimePoint reboot = bench.reboot_at(800);  // 135 degrees from the centre: 1.5 s
  bench.run_until(reboot + 699ms);
  EXPECT_TRUE(bench.sent.empty());
  EXPECT_EQ(bench.device.state(bench.now), HeadState::booting);
  bench.run_until(reboot + 3s);
  EXPECT_EQ(bench.head_infos(), (Infos{0x5D, 0x5D, 0x4A}));
  EXPECT_EQ(bench.device.state(bench.now), HeadState::without_parameters);

  bench.sent.clear();
  bench.command(all_round());
  EXPECT_EQ(bench.device.state(bench.now), HeadState::ready);
  bench.run_for(2s);
  EXPECT_EQ(bench.head_infos(), (Infos{0x8A, 0x8A}));
  bench.sent.clear();
  int unanswered = 0;
  bench.on_sent = [&](const Bench::Sent& frame) { unanswered += frame.bytes[10] == 2 ? 1 : 0; };
  bench.command(SendData{});
  EXPECT_EQ(bench.device.state(bench.now), HeadState::scanning);
  for (const TimePoint end = bench.now + 2s; bench.next_event() <= end;) {
    bench.run_once();
    for (; unanswered > 0; --unanswered) {
      bench.raw(fixture("send_data"));
    }
  }
  EXPECT_EQ(bench.head_infos(), (Infos{0xAA, 0xAA}));
}

TEST(PowerUp, AlivesAreThePublishedFrames) {
  // 4A at 6266 ms with position 3200, CA after a request for user blocks, then 8A (section 10).
  DeviceConfig config;
  config.boot_time = 266ms;
  config.alive_after_head_command = false;
  Bench bench(config);
  const TimePoint reboot = bench.reboot_at(bearing_ahead);
  bench.run_until(reboot + 6266ms);
  EXPECT_EQ(bench.sent.back().bytes, fixture("alive_4a"));
  bench.raw(fixture("send_bb_user"));
  bench.run_until(reboot + 7266ms);
  EXPECT_EQ(bench.sent.back().bytes, fixture("alive_ca"));
  bench.command(HeadCommand{});
  bench.run_until(reboot + 8266ms);
  EXPECT_EQ(bench.sent.back().bytes, fixture("alive_8a"));
}

TEST(Reboot, MotorSeeksTheCentreTheShortWayAt90DegreesASecond) {
  DeviceConfig config;
  config.alive_period = 500ms;
  Bench bench(config);
  bench.run_until(bench.reboot_at(6399) + 4s);  // 179.94 degrees to starboard of ahead, through 4800
  std::vector<int> positions;
  for (const auto& [at, alive] : bench.all<Alive>()) {
    positions.push_back(alive.position);
  }
  EXPECT_EQ(positions, (std::vector<int>{6399, 5599, 4799, 3999, 3200, 3200, 3200}));
  EXPECT_EQ(bench.head_infos(), (Infos{0x5D, 0x5D, 0x5D, 0x5D, 0x4A, 0x4A, 0x4A}));
}

TEST(Reboot, SlowMotorCentresForLonger) {
  DeviceConfig config;
  config.seek_speed_rad_s = std::numbers::pi / 5;
  Bench bench(config);
  bench.run_until(bench.reboot_at(0) + 7s);
  EXPECT_EQ(bench.head_infos(), (Infos{0x5D, 0x5D, 0x5D, 0x5D, 0x5D, 0x4A, 0x4A}));
}

TEST(Reboot, AtTheCentreItCentresForTheLeastTime) {
  for (const auto& [least, infos] :
       {std::pair<std::chrono::nanoseconds, Infos>{0ms, {0x4A, 0x4A, 0x4A, 0x4A}},
        {500ms, {0x4D, 0x4A, 0x4A, 0x4A}},
        {3200ms, {0x4D, 0x4D, 0x4D, 0x4D}}}) {
    DeviceConfig config;
    config.least_centring_time = least;
    Bench bench(config);
    bench.run_until(bench.reboot_at(bearing_ahead) + 3700ms);
    EXPECT_EQ(bench.head_infos(), infos);
  }
}

// ROS needs two alives of a centring head. The second is due one period after the boot; a busy machine sends
// it later.
TEST(Reboot, TwoAlivesTellOfCentringEvenIfTheMachineIsLate) {
  for (const auto late : {0ms, 50ms, 150ms}) {
    Device head(DeviceConfig{}, 0ns);
    head.step(0ns, BytesReceived{{}, SharedBytes(fixture("reboot"))});
    for (const auto due : {700ms, 1700ms}) {
      const Actions actions = head.step(due + late, TimePassed{});
      ASSERT_EQ(actions.send.size(), 1U);
      EXPECT_EQ(actions.send[0].bytes.data()[20], 0x4D) << late.count();
    }
  }
}

TEST(Alives, DirectionBitMayStayAfterCentring) {
  DeviceConfig config;
  config.direction_bit_kept = true;
  Bench bench(config);
  bench.make_ready(sector(1600, 2400));
  bench.run_for(1s);
  EXPECT_EQ(bench.head_infos(), (Infos{0x9A}));
  bench.command(SendData{});
  bench.renderer_answers = false;
  bench.run_for(1s);
  EXPECT_EQ(bench.head_infos().back(), 0xBA);
}

TEST(Reboot, ForgetsAllAndCentresAgain) {
  Bench bench;
  bench.make_ready(sector(1600, 1600 + 320));
  bench.scan(5);
  bench.command(SendData{61'891'786});
  bench.run_for(1s);
  EXPECT_GT(bench.all<Alive>().back().second.time_ms, 61'891'786U);
  const int position = bench.all<Alive>().back().second.position;
  bench.sent.clear();

  const TimePoint reboot = bench.now;
  bench.raw(fixture("reboot"));
  bench.run_until(reboot + 699ms);
  EXPECT_TRUE(bench.sent.empty()) << "no answer, and silence";
  bench.run_until(reboot + 5700ms);
  EXPECT_EQ(bench.head_infos(), (Infos{0x5D, 0x4D, 0x4A, 0x4A, 0x4A, 0x4A})) << "parameters are gone";
  const auto alives = bench.all<Alive>();
  EXPECT_EQ(alives[0].first, reboot + 700ms);
  EXPECT_EQ(alives[0].second.time_ms, 700U);
  EXPECT_EQ(alives[0].second.position, position);
  EXPECT_TRUE(bench.all<HeadData>().empty()) << "lines that were owed are not";
  EXPECT_EQ(bench.device.counters().boots, 1U);
}

TEST(Reboot, InTheMiddleOfAPingLeavesItsJobToBeAnswered) {
  Bench bench;
  bench.make_ready(all_round());
  bench.renderer_answers = false;
  bench.command(SendData{});
  ASSERT_EQ(bench.jobs.size(), 1U);
  bench.command(Reboot{});
  EXPECT_EQ(bench.last.cancelled, bench.jobs[0].number);
  bench.answer(test_line(bench.jobs[0]));
  EXPECT_EQ(bench.last.cancelled, std::nullopt);
  EXPECT_EQ(bench.device.counters().pings_cancelled, 1U);
  bench.run_for(10s);
  EXPECT_TRUE(bench.all<HeadData>().empty());
}

TEST(Reboot, BytesThatComeWhileItBootsAreLost) {
  Bench bench;
  bench.run_until(10s);
  bench.command(Reboot{});
  bench.run_for(100ms);
  bench.raw(fixture("send_version"));
  bench.raw(fixture("head_command_ros"));
  bench.run_for(5s);
  EXPECT_TRUE(bench.all<VersionData>().empty());
  EXPECT_EQ(bench.device.state(bench.now), HeadState::without_parameters);
  EXPECT_EQ(bench.device.counters().unheard_bytes, 80U);
}

TEST(Reboot, SpontaneousOneShowsAsAHeadWithoutParameters) {
  Bench bench;
  bench.make_ready(all_round());
  bench.scan(3);
  bench.power_cycle();
  bench.sent.clear();
  bench.run_for(1s);
  ASSERT_EQ(bench.head_infos().size(), 1U);
  EXPECT_EQ(bench.head_infos()[0] & head_info_bits::no_parameters, head_info_bits::no_parameters);
}

TEST(Alives, StopUntilTheNextReboot) {
  Bench bench;
  bench.run_until(3s);
  const std::size_t before = bench.sent.size();
  bench.raw(fixture("stop_alives"));
  bench.command(all_round());
  bench.run_for(20s);
  EXPECT_EQ(bench.sent.size(), before);
  EXPECT_EQ(bench.scan(4).size(), 4U) << "it scans all the same";
  bench.command(Reboot{});
  bench.run_for(3s);
  EXPECT_FALSE(bench.head_infos(before).empty());
}

TEST(Alives, GoOnBetweenLinesOfAScanOrNot) {
  for (const bool on : {true, false}) {
    DeviceConfig config;
    config.alive_while_scanning = on;
    Bench bench(config);
    bench.make_ready(all_round());
    const TimePoint begin = bench.now;
    bench.scan(500);
    const auto seconds = static_cast<std::size_t>((bench.now - begin) / 1s);
    EXPECT_GE(seconds, 4U);
    if (on) {
      EXPECT_GE(bench.all<Alive>().size(), seconds);
    } else {
      EXPECT_TRUE(bench.all<Alive>().empty());
      bench.run_for(2s);
      EXPECT_FALSE(bench.all<Alive>().empty()) << "they come back when nothing is owed";
    }
  }
}

TEST(Alives, OneAnswersParametersAtOnceUnlessToldNotTo) {
  for (const bool answers : {true, false}) {
    DeviceConfig config;
    config.alive_after_head_command = answers;
    Bench bench(config);
    bench.run_until(10s);
    for (int i = 0; i < 3; ++i) {
      bench.sent.clear();
      bench.command(all_round());
      EXPECT_EQ(bench.head_infos(), answers ? Infos{0x8A} : Infos{});
      bench.run_for(1s);
      EXPECT_EQ(bench.head_infos(), answers ? (Infos{0x8A, 0x8A}) : Infos{0x8A});
    }
  }
}

TEST(Alives, ParametersWhileItCentresShowAtOnce) {
  Bench bench;
  const TimePoint reboot = bench.reboot_at(0);
  bench.run_until(reboot + 1s);
  bench.command(all_round());
  bench.run_until(reboot + 3s);
  EXPECT_EQ(bench.head_infos(), (Infos{0x5D, 0x9D, 0x9D, 0x8A}));
}

TEST(Clock, FollowsTheClientUnlessToldNotTo) {
  for (const bool follows : {true, false}) {
    DeviceConfig config;
    config.clock_follows_client = follows;
    Bench bench(config);
    bench.run_until(1500ms);
    bench.raw(fixture("send_data_with_time"));
    bench.raw(fixture("send_data"));  // time 0 does not set the clock
    bench.run_until(2s);
    EXPECT_EQ(bench.all<Alive>().back().second.time_ms, follows ? 61'891'786U + 500U : 2000U);
  }
}

TEST(Clock, Wraps) {
  Bench bench;
  bench.run_until(1500ms);
  bench.command(SendData{0xFFFFFFFF});
  bench.run_until(2s);
  EXPECT_EQ(bench.all<Alive>().back().second.time_ms, 499U);
}

}  // namespace
}  // namespace sonard::micron
