// SPDX-License-Identifier: Apache-2.0
// The pace of lines (protocol/micron/README.md 8.4).
#include <cmath>
#include <deque>

#include "bench.hpp"
#include "protocol/micron/line_timing.hpp"

namespace sonard::micron {
namespace {

double ms(std::chrono::nanoseconds time) {
  return std::chrono::duration<double, std::milli>(time).count();
}

/// One row of the table in section 8.4, which was calculated independently of this code.
struct Row {
  int bins, step, ad_interval;
  double listen_ms, turn_ms, send_ms, full_ms, half_ms;
};

const Row rows[] = {
    {200, 32, 52, 6.7, 8.0, 21.3, 24.3, 38.9},     {200, 32, 104, 13.3, 8.0, 21.3, 24.3, 45.6},
    {400, 32, 52, 13.3, 8.0, 38.6, 41.6, 62.9},    {400, 16, 52, 13.3, 4.0, 38.6, 41.6, 58.9},
    {397, 32, 104, 26.4, 8.0, 38.4, 41.4, 75.8},   {200, 8, 208, 26.6, 2.0, 21.3, 31.6, 52.9},
    {300, 32, 208, 39.9, 8.0, 29.9, 50.9, 80.9},   {500, 32, 208, 66.6, 8.0, 47.3, 77.6, 124.9},
    {500, 32, 312, 99.8, 8.0, 47.3, 110.8, 158.1},
};

HeadCommand command_of(const Row& row) {
  HeadCommand command;
  command.bins = static_cast<std::uint16_t>(row.bins);
  command.step = static_cast<std::uint8_t>(row.step);
  command.ad_interval = static_cast<std::uint16_t>(row.ad_interval);
  return command;
}

TEST(Timing, PartsOfALineAreThoseOfTheTable) {
  for (const Row& row : rows) {
    DeviceConfig config;
    const LineTiming timing = line_timing(command_of(row), config, row.step);
    EXPECT_NEAR(ms(timing.listen), row.listen_ms, 0.051);
    EXPECT_NEAR(ms(timing.turn), row.turn_ms, 0.051);
    EXPECT_NEAR(ms(timing.send), row.send_ms, 0.051);
    EXPECT_NEAR(ms(timing.period(config)), row.full_ms, 0.051);
    config.half_duplex = true;
    EXPECT_NEAR(ms(timing.period(config)), row.half_ms, 0.051);
  }
}

TEST(Timing, LinesOfABusyHeadComeAtThatPace) {
  for (const Row& row : rows) {
    for (const bool half_duplex : {false, true}) {
      DeviceConfig config;
      config.half_duplex = half_duplex;
      Bench bench(config);
      bench.render_time = 5ms;
      bench.make_ready(command_of(row));
      bench.scan(21);
      const auto lines = bench.all<HeadData>();
      EXPECT_NEAR(ms(lines[20].first - lines[0].first) / 20, half_duplex ? row.half_ms : row.full_ms, 0.051);
      // The first line is sent when listening has ended. Its time on the link comes after that.
      const TimePoint transmitted = bench.jobs[0].transmit_time;
      EXPECT_NEAR(ms(lines[0].first - transmitted), row.listen_ms + 3.0, 0.051);
    }
  }
}

TEST(Timing, PingsTransmitAtTheTimesThatTheirJobsSay) {
  Bench bench;
  bench.make_ready(command_of(rows[0]));
  bench.scan(10);
  for (std::size_t i = 1; i < 10; ++i) {
    EXPECT_NEAR(ms(bench.jobs[i].transmit_time - bench.jobs[i - 1].transmit_time), 24.3, 0.051);
  }
}

TEST(Timing, OneRequestForTwoLinesWaitsForTheRequest) {
  Bench bench;
  bench.make_ready(command_of(rows[0]));
  for (int i = 0; i < 5; ++i) {
    bench.command(SendData{});
    bench.run_for(200ms);
  }
  const auto lines = bench.all<HeadData>();
  ASSERT_EQ(lines.size(), 10U);
  for (std::size_t i = 0; i + 2 < lines.size(); i += 2) {
    EXPECT_NEAR(ms(lines[i + 1].first - lines[i].first), 24.3, 0.051);
    EXPECT_EQ(lines[i + 2].first - lines[i].first, 200ms);
  }
}

TEST(Timing, SlowRendererSlowsTheScanAndLosesNothing) {
  for (const bool half_duplex : {false, true}) {
    DeviceConfig config;
    config.half_duplex = half_duplex;
    Bench bench(config);
    bench.make_ready(command_of(rows[0]));
    bench.render_time = 60ms;
    const auto lines = bench.scan(20);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      EXPECT_EQ(lines[i].bearing, 3200 + 32 * static_cast<int>(i));
    }
    const auto sent = bench.all<HeadData>();
    for (std::size_t i = 1; i < 20; ++i) {
      // The link still has to carry one line before the next.
      EXPECT_GE(sent[i].first - sent[i - 1].first, half_duplex ? 60ms + 21ms : 60ms);
    }
  }
}

TEST(Timing, SlowerLinkSlowsTheScan) {
  DeviceConfig config;
  config.baud = 9600;
  Bench bench(config);
  bench.make_ready(command_of(rows[0]));
  bench.scan(11);
  const auto lines = bench.all<HeadData>();
  EXPECT_NEAR(ms(lines[10].first - lines[0].first) / 10, 245 * 10 / 9.6 + 3.0, 0.01);
}

TEST(Timing, FixedAndFastPace) {
  DeviceConfig config;
  config.line_period = 100ms;
  Bench fixed(config);
  fixed.make_ready(command_of(rows[0]));
  fixed.scan(11);
  const auto lines = fixed.all<HeadData>();
  EXPECT_EQ(lines[10].first - lines[0].first, 1s);

  config.line_period = 0ms;
  Bench fast(config);
  fast.make_ready(command_of(rows[8]));
  const TimePoint begin = fast.now;
  fast.scan(200);
  EXPECT_EQ(fast.now, begin) << "as fast as it is rendered, which here takes no time";
}

TEST(Timing, StillHeadDoesNotWaitForItsMotor) {
  Bench bench;
  HeadCommand command = command_of(rows[7]);
  command.control |= control_bits::motor_off;
  bench.make_ready(command);
  bench.scan(11);
  const auto lines = bench.all<HeadData>();
  EXPECT_NEAR(ms(lines[10].first - lines[0].first) / 10, 66.56 + 3.0, 0.01);
}

TEST(Timing, MotorTakesTheTimeOfTheWayThatItGoes) {
  Bench bench;
  bench.make_ready(sector(3190, 3210, 255));  // 20 units between the limits
  bench.scan(12);
  const auto lines = bench.all<HeadData>();
  const double listen_and_turn_ms = 20 * 53 * 640e-6 + 20 * 0.25;
  const double send_ms = 65 * 10 / 115.2;
  EXPECT_NEAR(ms(lines[11].first - lines[1].first) / 10, std::max(listen_and_turn_ms, send_ms) + 3.0, 0.01);
}

/// Time from new parameters to the transmission of the first ping, if lines are already requested.
std::chrono::nanoseconds repositioning(const HeadCommand& command, const DeviceConfig& config = {}) {
  Bench bench(config);
  bench.make_ready(all_round());
  const TimePoint asked = bench.now;
  bench.command(command);
  bench.command(SendData{});
  bench.run_for(3s);
  return bench.jobs.at(0).transmit_time - asked;
}

TEST(Timing, NewParametersCostAQuarterOfASecondAndTheWay) {
  EXPECT_EQ(repositioning(all_round()), 250ms);
  EXPECT_EQ(repositioning(sector(3000, 3400)), 250ms) << "inside";
  EXPECT_EQ(repositioning(sector(3600, 4000)), 250ms + 100ms) << "400 units of 250 us";
  EXPECT_EQ(repositioning(sector(6300, 6390)), 800ms) << "never more";
  DeviceConfig config;
  config.reconfiguration_time = 10ms;
  EXPECT_EQ(repositioning(all_round(), config), 10ms);
}

TEST(Timing, MotorIsSeenOnItsWayToASector) {
  DeviceConfig config;
  config.alive_period = 100ms;
  config.alive_after_head_command = false;
  Bench bench(config);
  bench.make_ready(all_round());
  bench.command(sector(5200, 5600));
  bench.run_for(600ms);
  const auto alives = bench.all<Alive>();
  std::vector<int> positions;
  for (const auto& [at, alive] : alives) {
    positions.push_back(alive.position);
    EXPECT_EQ(alive.has(head_info_bits::motoring), alive.position != 5200);
  }
  ASSERT_EQ(positions.size(), 6U);
  EXPECT_EQ(positions[1] - positions[0], 400) << "4000 units a second";
  EXPECT_EQ(positions.back(), 5200);
}

TEST(Timing, FirstLineComesWithinASecondOfItsRequestAlways) {
  for (const int limit : {0, 1600, 3200, 4800, 6399}) {
    HeadCommand command = sector(static_cast<std::uint16_t>(limit), static_cast<std::uint16_t>(limit));
    command.bins = 800;
    command.ad_interval = 195;
    EXPECT_LT(repositioning(command) + 100ms + 3ms + 74ms, 1s);
  }
}

TEST(Timing, CallerThatIsALittleLateKeepsThePace) {
  DeviceConfig config;
  config.line_period = 40ms;
  Device device(config, 0ns);
  const auto hears = [](const Command& command) { return BytesReceived{{}, SharedBytes(encode(command))}; };
  device.step(10s, hears(all_round()));
  TimePoint now = 12s;
  std::deque<Event> events{hears(SendData{})};
  std::vector<TimePoint> transmitted;
  std::optional<TimePoint> wake_at;
  while (transmitted.size() < 50) {
    if (events.empty()) {
      now = wake_at.value() + 3ms;
      events.push_back(TimePassed{});
    }
    const Actions actions = device.step(now, events.front());
    events.pop_front();
    for (const Outgoing& frame : actions.send) {
      if (frame.bytes[10] == 2) {
        events.push_back(hears(SendData{}));
      }
    }
    if (actions.render) {
      transmitted.push_back(actions.render->transmit_time);
      events.push_back(PingRendered{test_line(*actions.render)});
    }
    wake_at = actions.wake_at;
  }
  EXPECT_NEAR(ms(transmitted.back() - transmitted.front()), 49 * 40.0, 10.0);
}

}  // namespace
}  // namespace sonard::micron
