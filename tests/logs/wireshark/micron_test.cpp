// SPDX-License-Identifier: Apache-2.0
// The dissector of the Micron with streams over TCP, bytes between frames, and counts that disagree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/messages.hpp"

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

const std::vector<std::string> complaints{prefix + "malformed",    prefix + "bad_value",
                                          prefix + "no_frame",     prefix + "wrong_count",
                                          prefix + "unknown_type", "_ws.malformed"};

/// All examples of one direction, one after another.
Bytes stream(bool commands) {
  Bytes all;
  for (const std::string& name : message_names("micron")) {
    const Bytes frame = message_bytes("micron", name);
    if (is_command(frame) == commands) {
      all.insert(all.end(), frame.begin(), frame.end());
    }
  }
  return all;
}

/// The types of these examples in the same order.
std::string types_of(bool commands) {
  std::string types;
  for (const std::string& name : message_names("micron")) {
    const Bytes frame = message_bytes("micron", name);
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
  const Bytes frame = message_bytes("micron", "alive_5d");
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  pcapng::TcpConversation line{pcapng::serial_client, pcapng::serial_head};
  const auto row =
      dissect(line.from_server(bytes), {prefix + "message", prefix + "garbage", expert_field})[0];
  EXPECT_EQ(row.at(prefix + "message"), "alive");
  EXPECT_EQ(row.at(prefix + "garbage"), "40780a");
  EXPECT_THAT(row.at(expert_field), HasSubstr("belong to no frame"));
}

TEST(MicronDissector, CountsThatDisagreeAreMalformed) {
  Bytes line = message_bytes("micron", "head_data");
  line.at(42) = 9;
  Bytes command = message_bytes("micron", "head_command_ros");
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
  const auto rows = dissect(line.from_client(message_bytes("micron", "send_version")), {prefix + "message"});
  EXPECT_EQ(rows[0].at(prefix + "message"), "send_version");
}

}  // namespace
}  // namespace sonard::testing
