// SPDX-License-Identifier: Apache-2.0
// A whole file byte by byte, written out by hand from draft-ietf-opsawg-pcapng 3 and 4, and files cut at any
// byte.
#include "protocol/pcapng/blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sonard::pcapng {
namespace {

// clang-format off
const Bytes by_hand{
    // section header: magic, version 1.0, length unspecified, application "w"
    0x0A, 0x0D, 0x0D, 0x0A,  40, 0, 0, 0,  0x4D, 0x3C, 0x2B, 0x1A,  1, 0, 0, 0,
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF,  4, 0, 1, 0, 'w', 0, 0, 0,  0, 0, 0, 0,  40, 0, 0, 0,
    // interface: link type 101, no limit, name "bow", resolution 10^-9
    1, 0, 0, 0,  40, 0, 0, 0,  101, 0, 0, 0,  0, 0, 0, 0,
    2, 0, 3, 0, 'b', 'o', 'w', 0,  9, 0, 1, 0, 9, 0, 0, 0,  0, 0, 0, 0,  40, 0, 0, 0,
    // packet of 5 bytes at 0x1122334455667788
    6, 0, 0, 0,  40, 0, 0, 0,  0, 0, 0, 0,  0x44, 0x33, 0x22, 0x11,  0x88, 0x77, 0x66, 0x55,
    5, 0, 0, 0,  5, 0, 0, 0,  1, 2, 3, 4, 5, 0, 0, 0,  40, 0, 0, 0};
// clang-format on

Bytes two_packets() {
  Writer writer{"w"};
  writer.add_interface("bow");
  writer.add_packet(0, 0x1122334455667788, Bytes{1, 2, 3, 4, 5});
  writer.add_packet(0, 0x1122334455667789, Bytes{6, 7, 8, 9});
  return writer.take();
}

TEST(PcapngBlocks, WriterMakesWhatTheDraftSays) {
  Writer writer{"w"};
  EXPECT_EQ(writer.add_interface("bow"), 0U);
  writer.add_packet(0, 0x1122334455667788, Bytes{1, 2, 3, 4, 5});
  EXPECT_EQ(writer.take(), by_hand);
  EXPECT_TRUE(writer.take().empty());
  EXPECT_EQ(writer.add_interface("stern"), 1U);
}

TEST(PcapngBlocks, ReaderReadsWhatTheDraftSays) {
  const auto block = block_at(by_hand, 80);
  ASSERT_TRUE(block && *block);
  const auto packet = read_packet(**block);
  ASSERT_TRUE(packet);
  EXPECT_EQ(packet->interface, 0U);
  EXPECT_EQ(packet->time_ns, 0x1122334455667788U);
  EXPECT_EQ((Bytes{packet->bytes.begin(), packet->bytes.end()}), (Bytes{1, 2, 3, 4, 5}));
}

TEST(PcapngRecovery, EveryCutKeepsEveryWholeBlock) {
  const Bytes whole = two_packets();
  ASSERT_EQ(whole.size(), 156U);
  const std::vector<std::size_t> block_ends{40, 80, 120, 156};
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    const auto recovery = recover(ByteView{whole}.first(size));
    if (size < 40) {
      EXPECT_FALSE(recovery) << size;
      continue;
    }
    ASSERT_TRUE(recovery);
    const auto blocks = static_cast<std::size_t>(
        std::ranges::count_if(block_ends, [&](std::size_t end) { return end <= size; }));
    EXPECT_EQ(recovery->keep_size, block_ends[blocks - 1]) << size;
    EXPECT_EQ(recovery->packets, blocks > 2 ? blocks - 2 : 0) << size;
  }
}

TEST(PcapngRecovery, ABlockThatContradictsItselfEndsTheGoodPart) {
  Bytes lengths = two_packets();
  lengths[120 - 4] = 44;
  EXPECT_EQ(recover(lengths)->keep_size, 80U);
  Bytes captured = two_packets();
  captured[80 + 20] = 200;  // more than the block holds
  EXPECT_EQ(recover(captured)->keep_size, 80U);
  Bytes interface = two_packets();
  interface[80 + 8] = 1;  // there is only one interface
  EXPECT_EQ(recover(interface)->keep_size, 80U);
}

TEST(PcapngRecovery, FlippedBitsNeverCrash) {
  const Bytes whole = two_packets();
  std::mt19937 random{1};
  for (int i = 0; i < 20'000; ++i) {
    Bytes file = whole;
    file[random() % file.size()] ^= static_cast<std::uint8_t>(1U << random() % 8);
    if (const auto recovery = recover(file)) {
      ASSERT_LE(recovery->keep_size, file.size());
    }
  }
}

}  // namespace
}  // namespace sonard::pcapng
