// SPDX-License-Identifier: Apache-2.0
// The dissector of the Micron with streams over TCP, bytes between frames, and counts that disagree.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/logs/wireshark/captures.hpp"
#include "tests/support/messages.hpp"

namespace sonard::testing {
namespace {

using ::testing::HasSubstr;

const std::string prefix = "micron_sonar.";

TEST(MicronDissector, AStreamIsPutTogetherFromAnyPieces) {
  const std::vector<std::string> fields{prefix + "message",  prefix + "malformed",   prefix + "bad_value",
                                        prefix + "no_frame", prefix + "wrong_count", prefix + "unknown_type",
                                        "_ws.malformed",     "tcp.analysis.flags"};
  for (const std::size_t piece : {2000U, 50U, 3U}) {
    SCOPED_TRACE(piece);
    const pcapng::TcpConversation line{pcapng::serial_client, pcapng::serial_head};
    const auto packets = pieces_over_tcp("micron", line, piece);
    EXPECT_EQ(found_in(packets, fields), (Row{{prefix + "message", names_in_pieces("micron")}}));
    for (const Row& row : dissect(packets, {"tcp.checksum.status"})) {
      EXPECT_EQ(row.at("tcp.checksum.status"), "1");
    }
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
  packets.push_back(wire.from_client(command).at(0));
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
