// SPDX-License-Identifier: Apache-2.0
// A client drives a head: start, scans, and recovery from faults (protocol/micron/README.md 7, 8, 9).
#include "session.hpp"

namespace sonard::micron {
namespace {

TEST(Client, SaysWhatTheDriversSayInTheOrderOfTheDrivers) {
  Session session;
  session.client.start(0ns, HeadCommand{}, 3);
  session.run_to_end();
  ASSERT_GE(session.said.size(), 5U);
  EXPECT_EQ(session.said[0], fixture("send_version"));
  EXPECT_EQ(session.said[1], fixture("send_bb_user"));
  EXPECT_EQ(session.said[2], fixture("head_command_ros"));
  EXPECT_EQ(session.said[3], fixture("send_data"));
  EXPECT_EQ(session.said[4], fixture("send_data"));
  EXPECT_EQ(session.client.statistics().head_commands, 1U);
}

TEST(Client, LearnsWhoTheHeadIs) {
  DeviceConfig config;
  config.version.serial_number = 4711;
  Session session(config);
  session.run_for(5s);
  const HeadIdentity& head = session.client.head();
  ASSERT_TRUE(head.version && head.user_blocks && head.alive);
  EXPECT_EQ(head.version->serial_number, 4711);
  EXPECT_FALSE(head.user_blocks->half_duplex());
  EXPECT_EQ(session.said.size(), 2U) << "and asks for nothing before it is told to";
}

TEST(Client, GetsAWholeTurnInOrderWithItsSamples) {
  for (const bool half : {false, true}) {
    DeviceConfig config;
    config.half_duplex = half;
    Session session(config);
    session.client.start(0ns, all_round(32), 200);
    session.run_to_end();
    ASSERT_EQ(session.lines.size(), 200U);
    for (std::size_t i = 0; i < 200; ++i) {
      EXPECT_EQ(session.lines[i].number, i);
      EXPECT_EQ(session.lines[i].head.bearing, (3200 + 32 * static_cast<int>(i)) % 6400);
      ASSERT_EQ(session.lines[i].bins.size(), 20U);
      EXPECT_EQ(session.lines[i].bins[3], test_sample(i, 3));
    }
    const ClientStatistics& statistics = session.client.statistics();
    EXPECT_EQ(statistics.timeouts, 0U);
    EXPECT_EQ(statistics.head_commands, 1U);
    EXPECT_NEAR(static_cast<double>(statistics.requests), half ? 200 : 100, 2);
    EXPECT_EQ(session.head.device.counters().requests_beyond_cap, 0U);
  }
}

TEST(Client, KeepsAFullDuplexHeadBusyThoughLinesTakeTheirTime) {
  Session session;
  session.byte_time = 86'806ns;  // ten bits at 115200 baud
  session.client.start(0ns, HeadCommand{}, 100);
  session.run_to_end();
  const double per_line_ms =
      std::chrono::duration<double, std::milli>(session.lines[99].received - session.lines[0].received)
          .count() /
      99;
  EXPECT_NEAR(per_line_ms, 41.6, 0.1) << "400 bins at 115200 baud";
}

TEST(Client, Unpacks4BitLines) {
  for (const NibbleOrder order : {NibbleOrder::high_first, NibbleOrder::low_first}) {
    DeviceConfig head_config;
    head_config.nibble_order = order;
    ClientConfig client_config;
    client_config.nibble_order = order;
    Session session(head_config, client_config);
    HeadCommand command = all_round();
    command.control = 0x2306;
    command.bins = 5;
    session.head.render = [](const PingJob& job) { return PingImage{job.number, {0, 16, 32, 255, 128}, {}}; };
    session.client.start(0ns, command, 1);
    session.run_to_end();
    EXPECT_EQ(session.lines.at(0).bins, (Bytes{0, 1, 2, 15, 8}));
  }
}

TEST(Client, StopsWhenToldAndGoesOnWithOtherParameters) {
  Session session;
  session.client.start(0ns, all_round(), 0);
  session.run_for(10s);
  EXPECT_GT(session.lines.size(), 50U);
  session.client.stop();
  EXPECT_TRUE(session.client.finished());
  const std::size_t lines = session.lines.size();
  const std::size_t said = session.said.size();
  session.run_for(5s);
  EXPECT_EQ(session.lines.size(), lines);
  EXPECT_EQ(session.said.size(), said);

  session.lines.clear();
  session.client.start(session.now(), sector(3000, 3400, 100), 8);
  session.run_to_end(5s);
  ASSERT_EQ(session.lines.size(), 8U);
  EXPECT_EQ(session.lines[0].number, 0U);
  for (const ReceivedLine& line : session.lines) {
    EXPECT_EQ(line.head.step, 100);
    EXPECT_GE(line.head.bearing, 3000);
    EXPECT_LE(line.head.bearing, 3400);
  }
}

TEST(Client, ChangesGainAndDirectionOfARunningScan) {
  Session session;
  session.client.start(0ns, all_round(), 0);
  session.run_for(8s);
  session.client.set_gain(
      GainBlock{.ad_span = {63, 63}, .ad_low = {15, 15}, .gain = {84, 84}, .slope = {100, 100}});
  session.client.reverse();
  session.run_for(500ms);
  EXPECT_TRUE(std::ranges::count(session.said, fixture("gain")) == 1);
  EXPECT_TRUE(std::ranges::count(session.said, fixture("reverse")) == 1);
  ASSERT_GE(session.lines.size(), 10U);
  const auto last = session.lines.end() - 2;
  EXPECT_EQ(last[1].head.gain, 84);
  EXPECT_EQ(last[1].head.ad_span, 63);
  EXPECT_EQ(wrapped(last[1].head.bearing - last[0].head.bearing), 6400 - 32);
  EXPECT_EQ(session.client.statistics().timeouts, 0U);
}

TEST(Client, GivesParametersAgainToAHeadThatHasRebooted) {
  Session session;
  session.client.start(0ns, all_round(), 0);
  session.run_for(10s);
  session.head.power_cycle();
  const std::size_t before = session.lines.size();
  session.run_for(10s);
  EXPECT_GT(session.lines.size(), before + 50);
  EXPECT_EQ(session.client.statistics().reboots, 1U);
  EXPECT_EQ(session.client.statistics().head_commands, 2U);
}

TEST(Client, GivesParametersAgainToAHeadThatHasLostItsStep) {
  Session session;
  session.client.start(0ns, all_round(), 0);
  session.run_for(10s);
  session.head.device.lose_step();
  session.run_for(5s);
  EXPECT_EQ(session.client.statistics().motor_errors, 1U);
  EXPECT_EQ(session.client.statistics().head_commands, 2U);
  EXPECT_EQ(session.lines.back().head.status, 0x10);
}

TEST(Client, BeginsWithARebootIfSoSet) {
  ClientConfig config;
  config.reboot_first = true;
  Session session({}, config);
  session.head.make_ready(sector(1600, 1700));
  session.client.start(session.now(), all_round(), 5);
  session.run_to_end();
  EXPECT_EQ(session.said[0], fixture("reboot"));
  EXPECT_EQ(session.head.device.counters().boots, 1U);
  EXPECT_EQ(session.lines[0].head.bearing, 3200);
}

TEST(Client, DrivesAHeadWhoseAlivesWereStopped) {
  Session session;
  session.head.run_until(5s);
  session.head.raw(fixture("stop_alives"));
  session.head.sent.clear();
  session.client.start(session.now(), all_round(), 20);
  session.run_to_end();
  EXPECT_TRUE(session.head.all<Alive>().empty());
  EXPECT_EQ(session.lines.size(), 20U);
}

TEST(Client, DrivesAHeadThatKeepsItsUserBlocksToItself) {
  Session session;
  session.to_client = [](const Bytes& frame) {
    return frame[10] == 6 ? std::vector<Bytes>{} : std::vector<Bytes>{frame};
  };
  session.client.start(0ns, all_round(), 50);
  session.run_to_end();
  EXPECT_EQ(session.lines.size(), 50U);
  EXPECT_FALSE(session.client.head().user_blocks);
}

TEST(Client, WaitsForEverForAHeadThatIsNotThere) {
  Client client(ClientConfig{}, 0ns);
  TimePoint now{};
  std::size_t said = 0;
  for (int i = 0; i < 100; ++i) {
    now = client.next_deadline().value();
    client.advance(now);
    said += client.take_outgoing().size();
  }
  EXPECT_EQ(said, 100U);
  EXPECT_EQ(now, 2s + 99 * 1s);
}

TEST(Client, DeliversOnlyLinesOfItsOwnParameters) {
  Session session;
  session.client.start(0ns, all_round(), 0);
  session.run_for(8s);
  session.head.command(all_round(64));  // parameters of another client
  const std::size_t before = session.lines.size();
  session.run_for(1s);
  EXPECT_LE(session.lines.size(), before + 1);
  EXPECT_GT(session.client.statistics().lines_unmatched, 0U);
  session.run_for(10s);
  EXPECT_EQ(session.lines.back().head.step, 32) << "it insists";
}

TEST(Client, FramesOfOtherNodesArePassedOver) {
  Client client(ClientConfig{}, 0ns);
  Bytes alive = fixture("alive_5d");
  alive[7] = 20;
  client.on_bytes(0ns, alive);
  alive = fixture("alive_5d");
  alive[8] = 2;
  client.on_bytes(0ns, alive);
  EXPECT_EQ(client.statistics().other_nodes, 2U);
  EXPECT_EQ(client.other_heads(), std::set<std::uint8_t>{20}) << "the second frame is for another client";
  EXPECT_EQ(client.statistics().alives, 0U);
  EXPECT_TRUE(client.take_outgoing().empty());
}

TEST(Client, ReadsThePublishedLine) {
  Client client(ClientConfig{}, 0ns);
  HeadCommand command;
  command.bins = 8;
  client.start(0ns, command, 1);
  for (const char* name : {"alive_4a", "version_data", "bb_user_data", "alive_ca", "head_data"}) {
    client.on_bytes(1s, fixture(name));
  }
  const auto lines = client.take_lines();
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_EQ(lines[0].bins, (Bytes{176, 64, 10, 18, 20, 230, 64, 10}));
  EXPECT_EQ(lines[0].head.bearing, 3232);
  EXPECT_TRUE(client.finished());
}

}  // namespace
}  // namespace sonard::micron
