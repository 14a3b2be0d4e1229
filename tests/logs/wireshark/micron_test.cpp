// SPDX-License-Identifier: Apache-2.0
// Byte examples of the Micron through the dissector, over TCP and UDP. Expected values are read off
// docs/protocols/micron.md (sections 5, 6, 10) by hand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/hex_fixture.hpp"

namespace sonard::testing {
namespace {

using ::testing::HasSubstr;

const std::string prefix = "micron_sonar.";

bool is_command(const Bytes& frame) {
  return frame[7] == 0xFF;
}

void append(std::vector<pcapng::Bytes>& packets, const std::vector<pcapng::Bytes>& more) {
  packets.insert(packets.end(), more.begin(), more.end());
}

struct Expectation {
  std::string fixture;
  std::string message;
  Row fields;
};

const std::vector<Expectation> expectations{
    {"send_version",
     "send_version",
     {{"frame.tx_node", "255"}, {"frame.rx_node", "2"}, {"frame.length", "8"}}},
    {"send_data_with_time", "send_data", {{"send_data.time_ms", "61891786"}}},
    {"head_command_ros",
     "head_command",
     {{"head_command.form", "0x01"},
      {"head_command.control", "0x2307"},
      {"head_command.head_type", "17"},
      {"head_command.range_scale", "100"},
      {"head_command.left_limit", "2400"},
      {"head_command.right_limit", "3999"},
      {"head_command.ad_span", "255"},
      {"head_command.gain", "105,105"},
      {"head_command.motor_time", "25"},
      {"head_command.step", "32"},
      {"head_command.ad_interval", "53"},
      {"head_command.bins", "400"},
      {"head_command.max_ad_buffer", "500"},
      {"head_command.lockout_us", "100"},
      {"head_command.minor_axis", "1600"}}},
    {"head_command_rock",
     "head_command",
     {{"head_command.form", "0x1d"},
      {"head_command.control", "0x2383"},
      {"head_command.step", "88"},
      {"head_command.ad_interval", "104"},
      {"head_command.bins", "200"},
      {"head_command.lockout_us", "13333"},
      {"gain_block.ad_span", "0,0"}}},
    {"gain",
     "head_command",
     {{"head_command.form", "0x1e"},
      {"gain_block.ad_span", "63,63"},
      {"gain_block.ad_low", "15,15"},
      {"gain_block.gain", "84,84"},
      {"gain_block.slope", "100,100"}}},
    {"reverse", "head_command", {{"head_command.form", "0x0f"}}},
    {"version_data",
     "version_data",
     {{"version_data.software_version", "49"},
      {"version_data.serial_number", "35853"},
      {"version_data.program_length", "43139"},
      {"version_data.checksum", "0x883c"},
      {"version_data.node", "2"}}},
    {"alive_5d",
     "alive",
     {{"alive.time_ms", "4266"},
      {"alive.position", "3200"},
      {"alive.head_info", "0x5d"},
      {"from_head", "1"}}},
    {"alive_aa", "alive", {{"alive.position", "2400"}, {"alive.head_info", "0xaa"}}},
    {"bb_user_data",
     "bb_user_data",
     {{"bb_user_data.block_length", "250"},
      {"bb_user_data.kind", "15"},
      {"bb_user_data_dst.dst_half_duplex", "0"}}},
    {"head_data",
     "head_data",
     {{"head_data.device_type", "17"},
      {"head_data.status", "0x10"},
      {"head_data.control", "0x2307"},
      {"head_data.left_limit", "2400"},
      {"head_data.right_limit", "3999"},
      {"head_data.step", "32"},
      {"head_data.bearing", "3232"},
      {"head_data.bearing_deg", "1.8"},
      {"head_data.bins", "8"},
      {"head_data_counts.data_count", "8"},
      {"data", "b0400a1214e6400a"}}},
    {"head_data_4_bit",
     "head_data",
     {{"head_data.sweep", "2"},
      {"head_data.ad_span", "77"},
      {"head_data.ad_low", "40"},
      {"head_data.bins", "8"},
      {"data", "f8100a40"}}},
    {"head_data_imaging",
     "head_data",
     {{"head_data.device_type", "2"},
      {"head_data.sweep", "5"},
      {"head_data.tx_word", "0x05666666"},
      {"head_data.bearing", "2688"}}},
    {"aux_data", "aux_data", {{"data", "30313233346d6d0d00"}}},
};

TEST(MicronDissector, FieldsOfExamples) {
  std::vector<pcapng::Bytes> packets;
  std::vector<std::string> fields{prefix + "message", expert_field};
  for (const Expectation& expected : expectations) {
    const Bytes frame = load_hex_fixture("micron", expected.fixture);
    const pcapng::Endpoint client{0x7F000001, 50'000};
    const pcapng::Endpoint head{0x7F000001, 4002};
    packets.push_back(is_command(frame) ? pcapng::udp_packet(client, head, frame)
                                        : pcapng::udp_packet(head, client, frame));
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

const std::vector<std::string> complaints{prefix + "malformed",    prefix + "bad_value",
                                          prefix + "no_frame",     prefix + "wrong_count",
                                          prefix + "unknown_type", "_ws.malformed"};

/// All examples of one direction, one after another.
Bytes stream(bool commands) {
  Bytes all;
  for (const std::string& name : hex_fixture_names("micron")) {
    const Bytes frame = load_hex_fixture("micron", name);
    if (is_command(frame) == commands) {
      all.insert(all.end(), frame.begin(), frame.end());
    }
  }
  return all;
}

/// The types of these examples in the same order.
std::string types_of(bool commands) {
  std::string types;
  for (const std::string& name : hex_fixture_names("micron")) {
    const Bytes frame = load_hex_fixture("micron", name);
    types += is_command(frame) == commands ? std::to_string(frame[10]) + "," : "";
  }
  return types;
}

/// Both streams through one TCP connection between the ends of a serial line, in parts of `piece` bytes that
/// begin and end anywhere in frames. @return the dissector's frames and warnings, by field
Row through_tcp(std::size_t piece) {
  pcapng::TcpConversation line{pcapng::serial_client, pcapng::serial_head};
  std::vector<pcapng::Bytes> packets = line.open();
  const Bytes commands = stream(true);
  const Bytes reports = stream(false);
  for (std::size_t begin = 0; begin < commands.size(); begin += piece) {
    append(packets, line.from_client(
                        pcapng::ByteView{commands}.subspan(begin, std::min(piece, commands.size() - begin))));
  }
  for (std::size_t begin = 0; begin < reports.size(); begin += piece) {
    append(packets, line.from_server(
                        pcapng::ByteView{reports}.subspan(begin, std::min(piece, reports.size() - begin))));
  }
  append(packets, line.close());
  std::vector<std::string> fields{prefix + "frame.type", "tcp.analysis.flags", "tcp.checksum.status"};
  fields.insert(fields.end(), complaints.begin(), complaints.end());
  Row all;
  for (const Row& row : dissect(packets, fields)) {
    for (const auto& [field, value] : row) {
      const bool is_checksum = field == "tcp.checksum.status";
      if (!value.empty() && !(is_checksum && value == "1")) {
        all[field] += value + ",";
      }
    }
  }
  return all;
}

TEST(MicronDissector, AStreamIsPutTogetherFromAnyPieces) {
  for (const std::size_t piece : {2000U, 50U, 3U}) {
    SCOPED_TRACE(piece);
    const Row all = through_tcp(piece);
    EXPECT_EQ(all.at(prefix + "frame.type"), types_of(true) + types_of(false));
    for (const std::string& complaint : complaints) {
      EXPECT_EQ(all.count(complaint), 0U) << complaint;
    }
    EXPECT_EQ(all.count("tcp.analysis.flags"), 0U);
    EXPECT_EQ(all.count("tcp.checksum.status"), 0U);
  }
}

TEST(MicronDissector, GarbageIsShownAndTheFrameBehindItFound) {
  Bytes bytes{'@', 'x', 0x0A};
  const Bytes frame = load_hex_fixture("micron", "alive_5d");
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  pcapng::TcpConversation line{pcapng::serial_client, pcapng::serial_head};
  const auto row =
      dissect(line.from_server(bytes), {prefix + "message", prefix + "garbage", expert_field})[0];
  EXPECT_EQ(row.at(prefix + "message"), "alive");
  EXPECT_EQ(row.at(prefix + "garbage"), "40780a");
  EXPECT_THAT(row.at(expert_field), HasSubstr("belong to no frame"));
}

TEST(MicronDissector, CountsThatDisagreeAreMalformed) {
  Bytes line = load_hex_fixture("micron", "head_data");
  line.at(42) = 9;
  Bytes command = load_hex_fixture("micron", "head_command_ros");
  command.at(13) = 0x77;
  pcapng::TcpConversation wire{pcapng::serial_client, pcapng::serial_head};
  std::vector<pcapng::Bytes> packets = wire.from_server(line);
  append(packets, wire.from_client(command));
  const auto rows = dissect(packets, {expert_field});
  EXPECT_THAT(rows[0].at(expert_field), HasSubstr("8 and 9 bytes of data declared, 8 present"));
  EXPECT_THAT(rows[1].at(expert_field), HasSubstr("Unknown form 0x77"));
}

TEST(MicronDissector, AStreamIsFoundOnAnyPort) {
  pcapng::TcpConversation line{{0x7F000001, 40'000}, {0x7F000001, 7333}};
  const auto rows =
      dissect(line.from_client(load_hex_fixture("micron", "send_version")), {prefix + "message"});
  EXPECT_EQ(rows[0].at(prefix + "message"), "send_version");
}

}  // namespace
}  // namespace sonard::testing
