// SPDX-License-Identifier: Apache-2.0
// Byte examples of the Gemini through the dissector. Expected values are read off docs/protocols/gemini.md
// (sections 5, 6, 10) and tests/data/gemini/notes.md by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/hex_fixture.hpp"

namespace sonard::testing {
namespace {

using ::testing::HasSubstr;

const std::string prefix = "gemini_sonar.";

bool is_command(const Bytes& datagram) {
  return datagram[0] < 0x40 || datagram[0] == 0xC8;
}

pcapng::Bytes packet_of(const Bytes& datagram) {
  return is_command(datagram) ? to_head(datagram) : from_head(datagram);
}

struct Expectation {
  std::string fixture;
  std::string message;
  Row fields;
};

const std::vector<Expectation> expectations{
    {"status_request", "status_request", {{"header.sonar_id", "601"}, {"header.version", "1"}}},
    {"ping_config",
     "ping_config",
     {{"ping_config.run_mode", "0x0000"},
      {"ping_config.ext_mode", "0x0204"},
      {"ping_config.end_range", "483"},
      {"ping_config.interping_us", "200000"},
      {"ping_config.tx_length", "4"},
      {"ping_config.main_gain", "0x83e8"},
      {"ping_config.software_gain", "7680"},
      {"ping_config.spreading", "67"},
      {"ping_config.filter_bank", "7"},
      {"ping_config.shade_bank", "1"},
      {"ping_config.sound_speed", "14992"},
      {"ping_config.velocimeter_mode", "1"},
      {"ping_config.tx_mark", "29"},
      {"ping_config.velocimeter_tx_mark", "17"},
      {"ping_config.idents", "0,0,0,0"}}},
    {"ping_config_later_client",
     "ping_config",
     {{"header.destination", "2"},
      {"header.source", "1"},
      {"ping_config.end_range", "482"},
      {"ping_config.interping_us", "250000"},
      {"ping_config.spreading", "213"},
      {"ping_config.sound_speed", "15000"}}},
    {"status",
     "status",
     {{"status.firmware_version", "281"},
      {"status.fixed_ip", "10.61.19.200"},
      {"status.alternate_ip", "192.168.2.201"},
      {"status.surface_ip", "192.168.2.5"},
      {"status.subnet_mask", "255.255.255.0"},
      {"status.die_temperature", "646"},
      {"status.clock_us", "305419896"},
      {"status.transducer", "1"},
      {"status.boot_status", "0x00000105"},
      {"status.link_type", "0x0004"},
      {"status.mac_address", "00:12:34:00:02:59"}}},
    {"acknowledge",
     "acknowledge",
     {{"acknowledge.receipt_us", "305419896"}, {"acknowledge.reply_us", "305419936"}}},
    {"ping_head",
     "ping_head",
     {{"ping_head.ping_id", "5"},
      {"ping_head.ext_mode", "0x0204"},
      {"ping_head.transmit_time_us", "305463296"},
      {"ping_head.end_range", "483"},
      {"ping_head.beams", "256"},
      {"ping_head.channels", "96"},
      {"ping_head.base_gain", "2"},
      {"ping_head.velocimeter_speed", "14992"},
      {"ping_head.lines", "483"},
      {"ping_head.sound_speed_mps", "1499.2"}}},
    {"ping_line",
     "ping_line",
     {{"ping_line.ping_id", "5"},
      {"ping_line.number", "0"},
      {"ping_line.line_info", "0x2004"},
      {"ping_line.scale", "7680"},
      {"ping_line.data_length", "256"},
      {"ping_line.last", "0"}}},
    {"ping_tail", "ping_tail", {{"ping_tail.ping_id", "5"}, {"ping_tail.resent", "0"}}},
    {"ping_tail_resent", "ping_tail", {{"ping_tail.ping_id", "5"}, {"ping_tail.resent", "1"}}},
    {"retry_line",
     "retry_request",
     {{"retry_request.kind", "1"}, {"retry_request.first_line", "10"}, {"retry_request.line_count", "1"}}},
    {"retry_tail", "retry_request", {{"retry_request.kind", "2"}}},
    {"observed_retry_lines",
     "retry_request",
     {{"header.sonar_id", "1234"}, {"retry_request.first_line", "40"}, {"retry_request.line_count", "3"}}},
    {"observed_network_config",
     "network_config",
     {{"network_config.ethernet_ifg", "15"},
      {"network_config.baud_divisor", "1302"},
      {"network_config.serial_poll_us", "50000"},
      {"network_config.serial_routing", "256"},
      {"network_config.extension", "10000"}}},
    {"network_config_early",
     "network_config",
     {{"network_config.baud_divisor", "1302"}, {"network_config.extension", ""}}},
    {"observed_info_block_write",
     "info_block_write",
     {{"info_block_write.bank", "2"},
      {"info_block_write_address.alternate_ip", "192.168.2.77"},
      {"info_block_write_address.subnet_mask", "255.255.255.0"}}},
    {"observed_reboot", "reboot", {{"reboot.control", "1"}}},
    {"observed_going_offline", "going_offline", {}},
    {"diagnostic",
     "diagnostic",
     {{"diagnostic.rx1_board", "1"}, {"diagnostic.psu_board", "4"}, {"diagnostic.tx_board", "5"}}},
};

TEST(GeminiDissector, FieldsOfExamples) {
  std::vector<pcapng::Bytes> packets;
  std::vector<std::string> fields{prefix + "message", expert_field};
  for (const Expectation& expected : expectations) {
    packets.push_back(packet_of(load_hex_fixture("gemini", expected.fixture)));
    for (const auto& [field, value] : expected.fields) {
      fields.push_back(prefix + field);
    }
  }
  const auto rows = dissect(packets, fields);
  for (std::size_t i = 0; i < expectations.size(); ++i) {
    SCOPED_TRACE(expectations[i].fixture);
    EXPECT_EQ(rows[i].at(prefix + "message"), expectations[i].message);
    EXPECT_EQ(rows[i].at(expert_field), "");
    for (const auto& [field, value] : expectations[i].fields) {
      EXPECT_EQ(rows[i].at(prefix + field), value) << field;
    }
  }
}

// All examples except two, which are only the beginnings of longer datagrams.
TEST(GeminiDissector, NoExampleIsMalformed) {
  std::vector<std::string> names = hex_fixture_names("gemini");
  std::erase_if(names, [](const std::string& name) { return name.ends_with("_start"); });
  std::vector<pcapng::Bytes> packets;
  for (const std::string& name : names) {
    packets.push_back(packet_of(load_hex_fixture("gemini", name)));
  }
  const auto rows = dissect(packets, {prefix + "message", expert_field, "udp.checksum.status"});
  for (std::size_t i = 0; i < names.size(); ++i) {
    SCOPED_TRACE(names[i]);
    EXPECT_NE(rows[i].at(prefix + "message"), "");
    EXPECT_EQ(rows[i].at(expert_field), "");
    EXPECT_EQ(rows[i].at("udp.checksum.status"), "1");
  }
}

// The header alone is complete for status requests only, and half a header never is.
TEST(GeminiDissector, EveryExampleCutShortIsShownAsMalformed) {
  std::vector<pcapng::Bytes> packets;
  std::vector<std::string> names;
  for (const std::string& name : hex_fixture_names("gemini")) {
    const Bytes whole = load_hex_fixture("gemini", name);
    const bool is_header = name == "status_request" || name == "observed_status_request";
    for (const std::ptrdiff_t size : {1, 7, is_header ? 7 : 9}) {
      packets.push_back(packet_of(Bytes{whole.begin(), whole.begin() + size}));
      names.push_back(name + " of " + std::to_string(size));
    }
  }
  const auto rows = dissect(packets, {prefix + "malformed", prefix + "bad_value"});
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_NE(rows[i].at(prefix + "malformed") + rows[i].at(prefix + "bad_value"), "") << names[i];
  }
}

Bytes with(Bytes bytes, std::size_t offset, std::uint8_t value) {
  bytes.at(offset) = value;
  return bytes;
}

// A run-length coded ping of two lines (6.8): 00 c is c zeros, 01 one zero.
TEST(GeminiDissector, LinesAreHeldToTheHeadOfTheirPing) {
  Bytes head = with(with(load_hex_fixture("gemini", "ping_head"), 22, 2), 23, 0);
  head = with(head, 44, 50);                                                      // threshold
  const Bytes good{0x42, 1,   0x59, 2, 0, 0, 0, 0, 0, 5, 0, 0, 0, 0, 0x04, 0x02,  // 4 words
                   0,    255, 200,  0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,    0};
  Bytes few = with(good, 17, 100);
  few = with(few, 10, 1);
  const Bytes beyond = with(good, 10, 2);
  const auto rows = dissect({from_head(head), from_head(good), from_head(few), from_head(beyond)},
                            {prefix + "ping_line.head_frame", prefix + "ping_line.beams_coded",
                             prefix + "ping_line.data_length", expert_field, "_ws.col.Info"});
  EXPECT_EQ(rows[1].at(prefix + "ping_line.head_frame"), "1");
  EXPECT_EQ(rows[1].at(prefix + "ping_line.beams_coded"), "256");
  EXPECT_EQ(rows[1].at(prefix + "ping_line.data_length"), "16");
  EXPECT_EQ(rows[1].at(expert_field), "");
  EXPECT_THAT(rows[1].at("_ws.col.Info"), HasSubstr("line 0 of 2"));
  EXPECT_EQ(rows[2].at(prefix + "ping_line.beams_coded"), "101");
  EXPECT_THAT(rows[2].at(expert_field), HasSubstr("101 beams of 256"));
  EXPECT_THAT(rows[3].at(expert_field), HasSubstr("Line 2 of 2"));
}

TEST(GeminiDissector, PortsAreAPreference) {
  const Bytes status = load_hex_fixture("gemini", "status");
  const pcapng::Bytes elsewhere = pcapng::udp_packet({0x7F000001, 40'000}, {0x7F000001, 40'001}, status);
  EXPECT_EQ(dissect({elsewhere}, {prefix + "message"})[0].at(prefix + "message"), "");
  EXPECT_EQ(dissect({elsewhere}, {prefix + "message"}, {"-o", "gemini_sonar.ports:40001"})[0].at(prefix +
                                                                                                 "message"),
            "status");
}

}  // namespace
}  // namespace sonard::testing
