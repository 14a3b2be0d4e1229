// SPDX-License-Identifier: Apache-2.0
// Status packets: discovery, content, period (protocol/gemini/README.md 1.3, 3.3, 8.3).
#include "bench.hpp"

namespace sonard::gemini {
namespace {

TEST(Status, IsTheWorkedExampleByteForByte) {
  Device device(example_config(), 0ns);
  const TimePoint now = std::chrono::microseconds{0x12345678};
  const BytesReceived command{{0, {client_address, client_port}, head_address},
                              SharedBytes(encode(Command{to_head<NetworkConfig>()}))};
  const auto sent = device.step(now, command).send;
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent[0].to, Outgoing::To::everybody);
  EXPECT_EQ(copy(sent[0].bytes), from_hex("40 01 59 02 00 00 00 00 19 01 59 02 c8 13 3d 0a"
                                          "c9 02 a8 c0 05 02 a8 c0 00 00 55 01 55 03 60 09"
                                          "86 02 00 00 55 80 56 80 58 80 57 80 00 00 78 80"
                                          "78 56 34 12 00 00 00 00 01 00 00 ff ff ff 60 80"
                                          "61 80 62 80 05 01 00 00 00 00 d8 02 f0 80 f0 80"
                                          "f0 80 f0 80 00 00 18 81 f0 80 f0 80 f0 80 04 00"
                                          "00 00 00 00 59 02 00 34 12 00 00 00 00 00"));
}

TEST(Status, ComesEverySecondFromBootWithNobodyThere) {
  Bench bench;
  bench.run_until(3500ms);
  const auto statuses = bench.all<Status>();
  ASSERT_EQ(statuses.size(), 4U);
  for (std::size_t i = 0; i < statuses.size(); ++i) {
    EXPECT_EQ(statuses[i].first, 1s * i);
    EXPECT_EQ(statuses[i].second.clock_us, 1'000'000 * i);
    EXPECT_EQ(statuses[i].second.surface_ip, 0U);
    EXPECT_EQ(statuses[i].second.alternate_ip, head_address);
    EXPECT_EQ(statuses[i].second.subnet_mask, 0xFFFFFF00U);
  }
  EXPECT_EQ(bench.sent.size(), 4U) << "nothing else leaves a head that nobody has spoken to";
}

TEST(Status, GoesOnWhilePinging) {
  Bench bench;
  bench.command(ping_of(7234, RunMode::continuous, 100ms));  // 195 ms on the wire each: never idle
  bench.run_connected(5s);
  const auto statuses = bench.all<Status>();
  ASSERT_GE(statuses.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(statuses[i].first, 1s * i);
  }
  EXPECT_GT(bench.device.counters().pings_sent, 20U);
}

TEST(Status, KeepsItsPhaseWhenTheCallerWasLate) {
  Device device(example_config(), 10s);
  EXPECT_EQ(device.step(10s, TimePassed{}).send.size(), 1U);
  const Actions late = device.step(13s + 400ms, TimePassed{});
  EXPECT_EQ(late.send.size(), 1U) << "three are overdue: one is sent";
  EXPECT_EQ(late.wake_at, TimePoint{14s});
}

TEST(Status, NamesTheClientWhileItIsConnected) {
  Bench bench;
  bench.run_until(500ms);
  bench.command(to_head<StatusRequest>());
  bench.run_until(5s);
  const auto statuses = bench.all<Status>();
  ASSERT_EQ(statuses.size(), 6U);
  EXPECT_EQ(statuses[0].second.surface_ip, 0U);
  for (const std::size_t connected : {1U, 2U, 3U}) {
    EXPECT_EQ(statuses[connected].second.surface_ip, client_address);
  }
  EXPECT_EQ(statuses[4].second.surface_ip, 0U) << "3 s without a command ended at 3.5 s";
}

TEST(Status, TellsWhenTheHeadIsOutOfTheWater) {
  Bench bench;
  bench.set_out_of_water(true);
  bench.run_until(1s);
  EXPECT_EQ(bench.all<Status>().back().second.shutdown_status, 0b110) << "out of water, and stopped for it";
  bench.command(ping_of(100));  // requests to ping out of water
  bench.run_until(2s);
  EXPECT_EQ(bench.all<Status>().back().second.shutdown_status, 0b100) << "out of water, pinging all the same";
  bench.set_out_of_water(false);
  bench.run_until(3s);
  EXPECT_EQ(bench.all<Status>().back().second.shutdown_status, 0);
}

TEST(Status, HeadClockKeepsCountingBeyond32Bits) {
  Device device(example_config(), 0ns);
  const std::chrono::microseconds beyond{0x1'0000'0005};
  const auto sent = device.step(beyond, TimePassed{}).send;
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(copy(std::span(sent[0].bytes).subspan(48, 8)), from_hex("05 00 00 00 01 00 00 00"));
}

}  // namespace
}  // namespace sonard::gemini
