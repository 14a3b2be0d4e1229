// SPDX-License-Identifier: Apache-2.0
// Commands from an address that is not the client (docs/security.md).
#include <vector>

#include "bench.hpp"

namespace sonard::gemini {
namespace {

using namespace std::chrono_literals;

/// Each command that reads and changes nothing, with the type of its answer.
const std::vector<std::pair<Command, MessageType>> readings{
    {to_head<StatusRequest>(), MessageType::acknowledge},
    {to_head<FlashRead>(), MessageType::flash_readback},
    {to_head<InfoBlockRead>(), MessageType::flash_readback},
    {to_head<TestResultRequest>(), MessageType::test_result},
    {to_head<GpioRead>(), MessageType::gpi_data},
    {to_head<DiagnosticRequest>(), MessageType::diagnostic}};

/// The datagrams sent to an address, from index `from` on.
std::vector<Bench::Sent> to_address(const Bench& bench, Ipv4 address, std::size_t from = 0) {
  std::vector<Bench::Sent> found;
  for (std::size_t i = from; i < bench.sent.size(); ++i) {
    if (bench.sent[i].to == Outgoing::To::peer && bench.sent[i].client == address) {
      found.push_back(bench.sent[i]);
    }
  }
  return found;
}

DeviceConfig locked_config() {
  DeviceConfig config = example_config();
  config.lock_to_first = true;
  return config;
}

TEST(OtherClient, DivertsNoPingsByReading) {
  for (const auto& [command, answer] : readings) {
    Bench bench;
    bench.command(ping_of(100, RunMode::continuous, 100ms));
    for (int i = 0; i < 20; ++i) {
      bench.run_for(50ms);
      bench.command(command, other_client);
    }
    const auto heard = to_address(bench, other_client);
    ASSERT_EQ(heard.size(), 20U);
    for (const Bench::Sent& datagram : heard) {
      EXPECT_EQ(datagram.type(), static_cast<std::uint8_t>(answer));
    }
    EXPECT_EQ(bench.device.client(), client_address);
    EXPECT_EQ(bench.count(MessageType::ping_head), 11U);
    EXPECT_EQ(to_address(bench, client_address).size(), bench.ping_datagrams().size());
  }
}

TEST(OtherClient, DoesNotKeepTheClientConnectedByReading) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  for (int i = 0; i < 5; ++i) {
    bench.run_for(1s);
    bench.command(to_head<StatusRequest>(), other_client);
  }
  EXPECT_EQ(bench.device.counters().client_timeouts, 1U);
}

TEST(OtherClient, DoesNotMakeAPausedProgrammeGoOnByReading) {
  for (const auto& [command, answer] : readings) {
    Bench bench;
    bench.command(ping_of(100, RunMode::continuous, 100ms));
    bench.run_until(10s);
    const std::size_t before = bench.sent.size();
    bench.command(command, other_client);
    bench.run_for(2s);
    const auto heard = to_address(bench, other_client, before);
    ASSERT_EQ(heard.size(), 1U);
    EXPECT_EQ(heard[0].type(), static_cast<std::uint8_t>(answer));
    EXPECT_TRUE(bench.ping_datagrams(before).empty());

    bench.command(command);  // from the client that started the programme
    bench.run_for(1s);
    EXPECT_EQ(bench.device.client(), client_address);
    EXPECT_FALSE(bench.ping_datagrams(before).empty());
    EXPECT_EQ(to_address(bench, other_client, before).size(), 1U);
  }
}

TEST(OtherClient, DoesNotMakeAPausedProgrammeGoOnByAnOrder) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(10s);
  const std::size_t before = bench.sent.size();
  bench.command(to_head<NetworkConfig>(), other_client);
  bench.run_for(10s);  // the other client falls silent too
  EXPECT_TRUE(bench.ping_datagrams(before).empty());
  bench.command(to_head<StatusRequest>());
  bench.run_for(1s);
  EXPECT_FALSE(bench.ping_datagrams(before).empty());
  EXPECT_TRUE(to_address(bench, other_client, before).empty());
}

TEST(OtherClient, ReplacesAPausedProgrammeByAConfiguration) {
  Bench bench;
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  bench.run_until(10s);
  const std::size_t before = bench.sent.size();
  bench.command(ping_of(150), other_client);
  bench.run_for(1s);
  const auto heads = bench.all<PingHead>(before);
  ASSERT_EQ(heads.size(), 1U);
  EXPECT_EQ(heads[0].second.end_range, 150);
  EXPECT_EQ(to_address(bench, other_client, before).size(), bench.ping_datagrams(before).size());
}

TEST(OtherClient, GetsNoLinesOfPingsThatWereNotItsOwn) {
  Bench bench;
  bench.command(ping_of(100));
  bench.run_for(1s);
  const std::size_t before = bench.sent.size();
  bench.command(retry_of(RetryKind::lines, 0, 10), other_client);
  bench.run_for(1s);
  EXPECT_TRUE(bench.ping_datagrams(before).empty());
  EXPECT_EQ(bench.device.client(), client_address);
  EXPECT_EQ(bench.device.counters().retries_dropped, 1U);
}

TEST(OtherClient, FindsALockedHeadDumb) {
  Bench bench(locked_config());
  bench.command(ping_of(100, RunMode::continuous, 100ms));
  for (int i = 0; i < 10; ++i) {
    bench.run_for(100ms);
    bench.command(ping_of(200, RunMode::continuous, 50ms), other_client);
    bench.command(to_head<GoingOffline>(), other_client);
    bench.command(to_head<Reboot>(), other_client);
    bench.command(to_head<StatusRequest>(), other_client);
  }
  EXPECT_TRUE(to_address(bench, other_client).empty());
  EXPECT_EQ(bench.count(MessageType::ping_head), 11U);
  EXPECT_EQ(bench.device.counters().locked_out, 40U);
  EXPECT_EQ(bench.device.counters().reboots, 0U);
}

TEST(OtherClient, TakesALockedHeadWhenTheFirstIsSilentForItsTimeout) {
  Bench bench(locked_config());
  bench.command(to_head<StatusRequest>());
  bench.run_until(2999ms);
  bench.command(ping_of(100), other_client);
  EXPECT_EQ(bench.device.client(), client_address);
  bench.run_until(3s);
  bench.command(ping_of(100), other_client);
  EXPECT_EQ(bench.device.client(), other_client);
  bench.command(to_head<StatusRequest>());  // the client is now the other one
  EXPECT_EQ(bench.device.counters().locked_out, 2U);
}

TEST(OtherClient, DoesNotLockAHeadByNoise) {
  Bench bench(locked_config());
  bench.raw(from_hex("20 01 5a 02 00 00 00 00"), other_client);  // for another head
  bench.raw(from_hex("ff ff"), other_client);
  bench.command(to_head<StatusRequest>());
  EXPECT_EQ(bench.device.client(), client_address);
}

}  // namespace
}  // namespace sonard::gemini
