// SPDX-License-Identifier: Apache-2.0
// Packets byte by byte. The checksums were calculated by hand: one's complement sums of 16-bit words.
#include "protocol/pcapng/packets.hpp"

#include <gtest/gtest.h>

namespace sonard::pcapng {
namespace {

constexpr Endpoint a{0x0A'00'00'01, 0x1234};
constexpr Endpoint b{0x0A'00'00'02, 0x5678};

TEST(UdpPacket, Bytes) {
  // IPv4: 4500 + 001F + 4000 + 4011 + 0A00 + 0001 + 0A00 + 0002 = D933, inverted 26CC.
  // UDP: 0A00 + 0001 + 0A00 + 0002 + 0011 + 000B + 1234 + 5678 + 000B + 0102 + 0300 = 80D8, inverted 7F27.
  EXPECT_EQ(udp_packet(a, b, Bytes{1, 2, 3}), (Bytes{0x45, 0,    0,    31,   0, 0,  0x40, 0,    64, 17, 0x26,
                                                     0xCC, 10,   0,    0,    1, 10, 0,    0,    2,  //
                                                     0x12, 0x34, 0x56, 0x78, 0, 11, 0x7F, 0x27, 1,  2,  3}));
}

TEST(UdpPacket, AChecksumOfZeroIsWrittenAsOnes) {
  // Without the payload the words sum to 0A00 + 0001 + 0A00 + 0002 + 0011 + 000A + 1234 + 5678 + 000A =
  // 7CD4. With FFFF - 7CD4 = 832B as payload they sum to FFFF, whose inverse is 0.
  const Bytes packet = udp_packet(a, b, Bytes{0x83, 0x2B});
  EXPECT_EQ(packet[26], 0xFF);
  EXPECT_EQ(packet[27], 0xFF);
}

/// Sequence and acknowledgement numbers, and flags.
struct Segment {
  std::uint32_t sequence = 0;
  std::uint32_t acknowledged = 0;
  int flags = 0;
  std::size_t size = 0;

  bool operator==(const Segment&) const = default;
};

Segment read(const Bytes& packet) {
  const auto be32 = [&](std::size_t offset) {
    return std::uint32_t{packet[offset]} << 24 | std::uint32_t{packet[offset + 1]} << 16 |
           std::uint32_t{packet[offset + 2]} << 8 | packet[offset + 3];
  };
  return {be32(24), be32(28), packet[33], packet.size() - 40};
}

// In RFC 9293, SYN and FIN count as one byte each.
TEST(TcpConversation, NumbersRunOnFromOpenToClose) {
  TcpConversation conversation{a, b};
  std::vector<Segment> segments;
  const auto take = [&](const std::vector<Bytes>& packets) {
    for (const Bytes& packet : packets) {
      segments.push_back(read(packet));
    }
  };
  take(conversation.open());
  take(conversation.from_client(Bytes(2000)));
  take(conversation.from_server(Bytes(5)));
  take(conversation.from_client(Bytes{}));
  take(conversation.close());
  EXPECT_EQ(segments, (std::vector<Segment>{{0, 0, 0x02, 0},
                                            {0, 1, 0x12, 0},
                                            {1, 1, 0x10, 0},
                                            {1, 1, 0x18, 1460},
                                            {1461, 1, 0x18, 540},
                                            {1, 2001, 0x18, 5},
                                            {2001, 6, 0x11, 0},
                                            {6, 2002, 0x11, 0},
                                            {2002, 7, 0x10, 0}}));
}

}  // namespace
}  // namespace sonard::pcapng
