// SPDX-License-Identifier: Apache-2.0
// Every command and its answer (protocol/gemini/README.md 1.4, 1.5, 3).
#include "bench.hpp"

namespace sonard::gemini {
namespace {

/// The answers of the head to one command of the client, one entry per datagram.
std::vector<std::vector<std::uint8_t>> answers(Bench& bench, std::span<const std::uint8_t> command) {
  const std::size_t before = bench.sent.size();
  bench.raw(command);
  std::vector<std::vector<std::uint8_t>> result;
  for (std::size_t i = before; i < bench.sent.size(); ++i) {
    EXPECT_EQ(bench.sent[i].to, Outgoing::To::peer);
    EXPECT_EQ(bench.sent[i].client, client_address);
    EXPECT_EQ(bench.sent[i].reply_from, head_address);
    result.push_back(copy(bench.sent[i].bytes));
  }
  return result;
}

std::vector<std::vector<std::uint8_t>> answers(Bench& bench, std::string_view hex) {
  return answers(bench, from_hex(hex));
}

using Datagrams = std::vector<std::vector<std::uint8_t>>;

TEST(Commands, StatusRequestIsAcknowledgedAtOnceAndDrawsNoStatus) {
  Bench bench;
  bench.run_until(std::chrono::microseconds{0x12345678});
  EXPECT_EQ(answers(bench, "20 01 59 02 00 00 00 00"),
            Datagrams{from_hex("49 01 59 02 00 00 00 00 78 56 34 12 00 00 00 00 78 56 34 12 00 00 00 00")});
}

TEST(Commands, DiagnosticRequestAsLaterClientsSendIt) {
  Bench bench;
  EXPECT_EQ(answers(bench, "36 01 59 02 00 00 02 01 00 00 00 00"),
            Datagrams{from_hex("4d 01 59 02 00 00 00 00 01 00 02 00 03 00 04 00 05 00")});
}

TEST(Commands, NetworkConfigIsTakenInSilence) {
  Bench bench;
  EXPECT_TRUE(answers(bench, "31 01 59 02 00 00 02 01 0f 0f 00 00 16 05 50 c3 00 00 00 01 10 27").empty());
  EXPECT_TRUE(answers(bench, "31 01 59 02 00 00 00 00 0f 0f 00 00 16 05 50 c3 00 00 00 00").empty());
  EXPECT_EQ(bench.device.counters().commands, 2U);
  EXPECT_EQ(bench.device.client(), client_address);
}

TEST(Commands, TestsSerialAndModemGetTheirHarmlessAnswers) {
  Bench bench;
  EXPECT_TRUE(answers(bench, "2a 01 59 02 00 00 00 00 02 41 42").empty());  // serial
  EXPECT_TRUE(answers(bench,
                      "2d 01 59 02 00 00 00 00"
                      "00 00 00 00 00 00 00 00"
                      "01 00 00 00 00 00 00 00")
                  .empty());
  EXPECT_TRUE(answers(bench, "2e 01 59 02 00 00 00 00 00 00 00 00").empty());
  EXPECT_TRUE(answers(bench, "2f 01 59 02 00 00 00 00 00 00 00 00").empty());
  EXPECT_EQ(answers(bench, "2c 01 59 02 00 00 00 00 00 00 00 00"),
            Datagrams{from_hex("4a 01 59 02 00 00 00 00 00 a0 01 a0 02 a0 03 a0"
                               "00 00 00 10 00 00 00 10 00 10 00 00 00 00 00 00 00 00"
                               "ff ff ff ff 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00")});
  EXPECT_EQ(answers(bench, "32 01 59 02 00 00 02 01 08 00 56 00 53 00 10 00"),
            Datagrams{from_hex("4b 01 59 02 00 00 00 00 00 00")});
  for (const char* gpio : {"33 01 59 02 00 00 00 00 00 00 00 00", "34 01 59 02 00 00 00 00 01 00 00 00",
                           "35 01 59 02 00 00 00 00 00 00 00 00"}) {
    EXPECT_EQ(answers(bench, gpio), Datagrams{from_hex("4c 01 59 02 00 00 00 00 00 00")}) << gpio;
  }
  EXPECT_EQ(bench.device.counters().commands, 9U);
  EXPECT_EQ(bench.device.counters().bad_datagrams, 0U);
}

/// The message 0x45 for an address, with these bytes followed by erased memory.
std::vector<std::uint8_t> readback(std::string_view address_bytes, std::string_view content) {
  auto expected = from_hex("45 01 59 02 00 00 00 00");
  const auto address = from_hex(address_bytes);
  expected.insert(expected.end(), address.begin(), address.end());
  expected.resize(16, 0);
  const auto data = from_hex(content);
  expected.insert(expected.end(), data.begin(), data.end());
  expected.resize(1040, 0xFF);
  return expected;
}

TEST(Commands, FlashIsWrittenAndReadBack) {
  Bench bench;
  auto write = to_head<FlashWrite>();
  write.address = 0x0001'0400;
  write.data.fill(0xFF);
  write.data[0] = 0xAB;
  write.data[4] = 0xCD;
  EXPECT_EQ(answers(bench, encode(Command{write})),
            Datagrams{from_hex("44 01 59 02 00 00 00 00 00 04 01 00 00 80 00 00")});
  write.flags = 1;
  EXPECT_EQ(answers(bench, encode(Command{write})),
            (Datagrams{from_hex("44 01 59 02 00 00 00 00 00 04 01 00 00 80 00 00"),
                       readback("00 04 01 00", "ab ff ff ff cd")}));
  EXPECT_EQ(answers(bench, "23 01 59 02 00 00 00 00 06 04 01 00"), Datagrams{readback("04 04 01 00", "cd")})
      << "read addresses are rounded down to a word";
  EXPECT_EQ(answers(bench, "23 01 59 02 00 00 00 00 00 00 20 00"), Datagrams{readback("00 00 20 00", "")})
      << "what was never written is erased";
}

TEST(Commands, FlashWriteBeyondTheMemoryIsReportedAsFailed) {
  Bench bench;
  auto write = to_head<FlashWrite>();
  write.address = 0x0080'0000;
  const auto answer = answers(bench, encode(Command{write}));
  ASSERT_EQ(answer.size(), 1U);
  EXPECT_NE((answer[0][12] | answer[0][13] << 8) & 0x7FFF, 0);
}

TEST(Commands, InfoBlocksAreReadAtTheirAddresses) {
  Bench bench;
  EXPECT_EQ(answers(bench, "25 01 59 02 00 00 00 00 00 00 00 00"),
            Datagrams{readback("00 00 3e 00", "59 02 00 00 01 00 00 00")});
  EXPECT_EQ(answers(bench, "25 01 59 02 00 00 00 00 01 00 00 00"), Datagrams{readback("00 00 7c 00", "")});
  EXPECT_EQ(answers(bench, "25 01 59 02 00 00 00 00 02 00 00 00"),
            Datagrams{readback("00 00 7e 00", "c9 02 a8 c0 00 ff ff ff")});
  EXPECT_TRUE(answers(bench, "25 01 59 02 00 00 00 00 03 00 00 00").empty());
}

/// The message 0x24 as a later client sends it, for 192.168.2.77/24 (tests/data/gemini/messages.json).
std::vector<std::uint8_t> write_address_77() {
  auto command = from_hex("24 01 59 02 00 00 02 01 02 00 00 00 00 00 00 00 4d 02 a8 c0 00 ff ff ff");
  command.resize(152, 0);
  return command;
}

TEST(Commands, ProgrammedAddressTakesEffectAtReboot) {
  Bench bench;
  const DeviceAddresses before = bench.device.addresses();
  EXPECT_EQ(before, (DeviceAddresses{0x0A3D13C8, head_address, 0xFFFFFF00}));
  EXPECT_EQ(answers(bench, write_address_77()),
            Datagrams{from_hex("44 01 59 02 00 00 00 00 00 00 7e 00 00 80 00 00")});
  EXPECT_EQ(answers(bench, "25 01 59 02 00 00 00 00 02 00 00 00"),
            Datagrams{readback("00 00 7e 00", "4d 02 a8 c0 00 ff ff ff")});
  bench.run_until(1s);
  EXPECT_EQ(bench.device.addresses(), before);
  EXPECT_EQ(bench.all<Status>().back().second.alternate_ip, head_address);

  EXPECT_TRUE(answers(bench, "2b 01 59 02 00 00 02 01 01 00 00 00").empty());
  EXPECT_EQ(bench.device.addresses(), (DeviceAddresses{0x0A3D13C8, 0xC0A8024D, 0xFFFFFF00}));
  bench.run_until(10s);
  EXPECT_EQ(bench.all<Status>().back().second.alternate_ip, 0xC0A8024DU);
}

TEST(Commands, AMoveOfTheServerIsReportedAtOnceAndKeptByAReboot) {
  Bench bench;
  bench.device.move_to(0xC0A8024D, 0xFFFF0000);
  EXPECT_EQ(bench.device.addresses(), (DeviceAddresses{0x0A3D13C8, 0xC0A8024D, 0xFFFF0000}));
  bench.run_until(2s);
  EXPECT_EQ(bench.all<Status>().back().second.alternate_ip, 0xC0A8024DU);
  EXPECT_EQ(bench.all<Status>().back().second.subnet_mask, 0xFFFF0000U);
  EXPECT_TRUE(answers(bench, "2b 01 59 02 00 00 02 01 01 00 00 00").empty());
  bench.run_until(10s);
  EXPECT_EQ(bench.device.addresses(), (DeviceAddresses{0x0A3D13C8, 0xC0A8024D, 0xFFFF0000}));
}

TEST(Commands, UnusableProgrammedAddressesLeaveTheHeadReachable) {
  const std::array<AddressBlock, 4> unusable{
      AddressBlock{0, 0xFFFFFF00}, AddressBlock{0xFFFFFFFF, 0xFFFFFF00}, AddressBlock{0xC0A8024D, 0xFF00FF00},
      AddressBlock{0xC0A8024D, 0}};
  for (const AddressBlock& block : unusable) {
    Bench bench;
    auto write = to_head<InfoBlockWrite>();
    write.block = block;
    bench.command(write);
    bench.command(to_head<Reboot>());
    EXPECT_EQ(bench.device.addresses(), (DeviceAddresses{0x0A3D13C8, head_address, 0xFFFFFF00}));
  }
}

TEST(Commands, ProductionBlocksAreStoredWithoutEffect) {
  Bench bench;
  auto write = to_head<InfoBlockWrite>();
  write.block = IdentityBlock{777, 1};
  EXPECT_EQ(answers(bench, encode(Command{write})),
            Datagrams{from_hex("44 01 59 02 00 00 00 00 00 00 3e 00 00 80 00 00")});
  EXPECT_EQ(answers(bench, "25 01 59 02 00 00 00 00 00 00 00 00"),
            Datagrams{readback("00 00 3e 00", "09 03 00 00 01 00 00 00")});
  write.block = VelocimeterBlock{1, -2};
  bench.command(write);
  EXPECT_EQ(answers(bench, "25 01 59 02 00 00 00 00 01 00 00 00"),
            Datagrams{readback("00 00 7c 00", "01 00 00 00 fe ff ff ff")});
  bench.command(to_head<Reboot>());
  bench.run_until(6s);
  EXPECT_EQ(bench.all<Status>().back().second.sonar_id, 601);
}

TEST(Commands, RebootIsFiveSecondsOfSilenceAndAClockFromZero) {
  Bench bench;
  bench.command(ping_of(1205, RunMode::continuous, 100ms));
  bench.run_until(2500ms);
  bench.command(to_head<Reboot>());
  const std::size_t at_reboot = bench.sent.size();
  EXPECT_EQ(bench.device.client(), 0U);
  bench.run_until(5s);
  bench.command(to_head<StatusRequest>());
  bench.command(ping_of(100));
  bench.run_until(7499ms);
  EXPECT_EQ(bench.sent.size(), at_reboot) << "a rebooting head neither sends nor hears";
  bench.run_until(9600ms);
  const auto statuses = bench.all<Status>(at_reboot);
  ASSERT_EQ(statuses.size(), 3U);
  EXPECT_EQ(statuses[0].first, 7500ms);
  EXPECT_EQ(statuses[0].second.clock_us, 0U);
  EXPECT_EQ(statuses[0].second.surface_ip, 0U);
  EXPECT_EQ(statuses[1].second.clock_us, 1'000'000U);
  EXPECT_EQ(bench.sent.size(), at_reboot + 3) << "the continuous programme is gone";

  bench.command(ping_of(100));
  bench.run_for(100ms);
  const auto heads = bench.all<PingHead>(at_reboot);
  ASSERT_EQ(heads.size(), 1U);
  EXPECT_EQ(heads[0].second.transmit_time_us, 2'100'000U);
  EXPECT_EQ(bench.device.counters().reboots, 1U);
}

TEST(Commands, OtherRebootControlsConcernTheBootLoader) {
  Bench bench;
  auto command = to_head<Reboot>();
  command.control = 2;
  bench.command(command);
  bench.run_until(1s);
  EXPECT_EQ(bench.all<Status>().size(), 2U);
  EXPECT_EQ(bench.device.counters().reboots, 0U);
}

TEST(Commands, OnlyTheOwnIdIsHeard) {
  Bench bench;
  for (const std::uint16_t id : {0, 1, 600, 602, 0x5902}) {
    StatusRequest request;
    request.header.sonar_id = id;
    bench.command(request);
  }
  EXPECT_EQ(bench.count(MessageType::acknowledge), 0U);
  EXPECT_EQ(bench.device.counters().wrong_id, 5U);
  EXPECT_EQ(bench.device.client(), 0U) << "a command for another head connects nobody";
}

TEST(Commands, IdZeroCanBeAllowed) {
  DeviceConfig config = example_config();
  config.accept_id_zero = true;
  Bench bench(config);
  bench.command(StatusRequest{});
  ASSERT_EQ(bench.count(MessageType::acknowledge), 1U);
  EXPECT_EQ(bench.all<Acknowledge>()[0].second.header.sonar_id, 601) << "it still answers with its own";
}

TEST(Commands, AnyHeaderBytesButTypeAndIdAreAccepted) {
  Bench bench;
  EXPECT_EQ(answers(bench, "20 07 59 02 ff ff 1e 01").size(), 1U);
}

TEST(Commands, UnknownAndShortMessagesAreTakenInSilence) {
  Bench bench;
  for (const char* unknown :
       {"26 01 59 02 00 00 00 00", "cb 01 59 02 00 00 1e 01 32 00", "40 01 59 02 00 00 00 00",
        "00 00 59 02 00 00 00 00", "c9 01 59 02 00 00 1e 01"}) {
    EXPECT_TRUE(answers(bench, unknown).empty()) << unknown;
  }
  EXPECT_EQ(bench.device.counters().unknown_type, 5U);
  for (const char* bad : {"", "20", "20 01 59 02 00 00 00", "21 01 59 02 00 00 00 00 00",
                          "36 01 59 02 00 00 00 00", "24 01 59 02 00 00 00 00 07 00 00 00 00 00 00 00"}) {
    EXPECT_TRUE(answers(bench, bad).empty()) << bad;
  }
  EXPECT_EQ(bench.device.counters().bad_datagrams, 6U);
  EXPECT_EQ(bench.device.client(), 0U) << "neither connects a client";
}

TEST(Commands, TrailingBytesAreIgnored) {
  Bench bench;
  EXPECT_EQ(answers(bench, "20 01 59 02 00 00 00 00 de ad be ef").size(), 1U);
}

TEST(Commands, NewestClientGetsTheAnswers) {
  Bench bench;
  bench.command(to_head<StatusRequest>());
  bench.command(to_head<GpoWrite>(), other_client);
  ASSERT_EQ(bench.sent.size(), 3U);
  EXPECT_EQ(bench.sent[1].client, client_address);
  EXPECT_EQ(bench.sent[2].client, other_client);
  EXPECT_EQ(bench.device.client(), other_client);
  EXPECT_EQ(bench.device.counters().client_changes, 1U);
}

TEST(Commands, AnswersComeFromTheAddressThatWasAddressed) {
  Bench bench;
  bench.raw(encode(Command{to_head<StatusRequest>()}), client_address, 0x0A3D13C8);
  EXPECT_EQ(bench.sent.back().reply_from, 0x0A3D13C8U);
  bench.raw(encode(Command{to_head<StatusRequest>()}), client_address, head_address);
  EXPECT_EQ(bench.sent.back().reply_from, head_address);
}

}  // namespace
}  // namespace sonard::gemini
