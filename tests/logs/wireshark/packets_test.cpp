// SPDX-License-Identifier: Apache-2.0
// Packets and times of a capture in tshark.
#include <gtest/gtest.h>

#include "tests/logs/wireshark/captures.hpp"

namespace sonard::testing {
namespace {

TEST(Capture, AddressesPortsTimesAndInterface) {
  const pcapng::Bytes packet = pcapng::udp_packet({0xC0A8020A, 52'901}, {0xC0A802C8, 52'901},
                                                  pcapng::Bytes{0x20, 1, 2, 2, 0, 0, 0, 0});
  const auto row = dissect({packet},
                           {"frame.time_epoch", "frame.interface_name", "ip.src", "ip.dst", "udp.srcport",
                            "udp.dstport", "udp.length", "ip.checksum.status", "udp.checksum.status"},
                           {"-o", "ip.check_checksum:TRUE"})[0];
  EXPECT_EQ(row.at("frame.time_epoch"), "1700000000.000000001");
  EXPECT_EQ(row.at("frame.interface_name"), "lab");
  EXPECT_EQ(row.at("ip.src"), "192.168.2.10");
  EXPECT_EQ(row.at("ip.dst"), "192.168.2.200");
  EXPECT_EQ(row.at("udp.srcport"), "52901");
  EXPECT_EQ(row.at("udp.length"), "16");
  EXPECT_EQ(row.at("ip.checksum.status"), "1");
  EXPECT_EQ(row.at("udp.checksum.status"), "1");
}

// Long data become several segments; the padding of an odd number of bytes counts in the checksum.
TEST(Capture, LongPiecesAndLongDatagrams) {
  pcapng::TcpConversation conversation{{0x7F000001, 40'000}, {0x7F000002, 40'001}};
  std::vector<pcapng::Bytes> packets = conversation.open();
  for (const auto& segment : conversation.from_client(pcapng::Bytes(10'001, 7))) {
    packets.push_back(segment);
  }
  for (const auto& segment : conversation.from_server(pcapng::Bytes(1, 8))) {
    packets.push_back(segment);
  }
  for (const auto& segment : conversation.close()) {
    packets.push_back(segment);
  }
  packets.push_back(pcapng::udp_packet({1, 2}, {3, 4}, pcapng::Bytes(pcapng::max_udp_payload, 0xFF)));
  const auto rows = dissect(
      packets, {"tcp.len", "tcp.seq", "tcp.checksum.status", "tcp.analysis.flags", "udp.checksum.status"});
  ASSERT_EQ(rows.size(), 3U + 7 + 1 + 3 + 1);
  EXPECT_EQ(rows[3].at("tcp.len"), "1460");
  EXPECT_EQ(rows[9].at("tcp.len"), "1241");
  EXPECT_EQ(rows[9].at("tcp.seq"), "8761");
  for (std::size_t i = 0; i + 1 < rows.size(); ++i) {
    EXPECT_EQ(rows[i].at("tcp.checksum.status"), "1") << i;
    EXPECT_EQ(rows[i].at("tcp.analysis.flags"), "") << i;
  }
  EXPECT_EQ(rows.back().at("udp.checksum.status"), "1");
}

}  // namespace
}  // namespace sonard::testing
