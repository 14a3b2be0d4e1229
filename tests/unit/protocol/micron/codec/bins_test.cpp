// SPDX-License-Identifier: Apache-2.0
// Two bins per byte (protocol/micron/README.md 6.3, 10).
#include "protocol/micron/bins.hpp"

#include <gtest/gtest.h>

namespace sonard::micron {
namespace {

using Bytes = std::vector<std::uint8_t>;

// The 4-bit example of section 10, in both orders of nibbles.
const Bytes packed{0xF8, 0x10, 0x0A, 0x40};
const Bytes high_first{15, 8, 1, 0, 0, 10, 4, 0};
const Bytes low_first{8, 15, 0, 1, 10, 0, 0, 4};

TEST(Nibbles, BothOrders) {
  EXPECT_EQ(unpack_nibbles(packed, NibbleOrder::high_first), high_first);
  EXPECT_EQ(unpack_nibbles(packed, NibbleOrder::low_first), low_first);
  EXPECT_EQ(pack_nibbles(high_first, NibbleOrder::high_first), packed);
  EXPECT_EQ(pack_nibbles(low_first, NibbleOrder::low_first), packed);
}

TEST(Nibbles, OddNumberIsFilledUpWithZero) {
  EXPECT_EQ(pack_nibbles(Bytes{1, 2, 3}, NibbleOrder::high_first), (Bytes{0x12, 0x30}));
  EXPECT_EQ(pack_nibbles(Bytes{1, 2, 3}, NibbleOrder::low_first), (Bytes{0x21, 0x03}));
}

TEST(FourBit, WindowFromAdLowOn) {
  // AD low 40 (13 dB), AD span 38 (12 dB): 0 means up to 13 dB, 15 means 25 dB and above.
  EXPECT_EQ(to_four_bit(0, 40, 38), 0);
  EXPECT_EQ(to_four_bit(40, 40, 38), 0);
  EXPECT_EQ(to_four_bit(42, 40, 38), 0);  // 2 * 16 / 38 < 1
  EXPECT_EQ(to_four_bit(43, 40, 38), 1);
  EXPECT_EQ(to_four_bit(59, 40, 38), 8);
  EXPECT_EQ(to_four_bit(77, 40, 38), 15);
  EXPECT_EQ(to_four_bit(78, 40, 38), 15);
  EXPECT_EQ(to_four_bit(255, 40, 38), 15);
}

TEST(FourBit, FullSpanAndNone) {
  EXPECT_EQ(to_four_bit(255, 0, 255), 15);
  EXPECT_EQ(to_four_bit(127, 0, 255), 7);
  EXPECT_EQ(to_four_bit(10, 10, 0), 0) << "a span of 0 acts as 1";
  EXPECT_EQ(to_four_bit(11, 10, 0), 15);
}

}  // namespace
}  // namespace sonard::micron
