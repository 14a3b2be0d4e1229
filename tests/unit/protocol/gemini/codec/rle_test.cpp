// SPDX-License-Identifier: Apache-2.0
#include "protocol/gemini/rle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace sonard::gemini {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encoded(const Bytes& beams, std::uint8_t threshold = 3) {
  Bytes out;
  rle_encode(beams, threshold, out);
  return out;
}

Bytes decoded(const Bytes& data, std::size_t beams) {
  Bytes out(beams, 0xEE);
  rle_decode(data, out);
  return out;
}

TEST(RleEncode, RunOfOneIs01) {
  EXPECT_EQ(encoded({5, 0, 7}), (Bytes{5, 1, 7, 0}));
}

TEST(RleEncode, LongerRunsAre00AndTheirLength) {
  EXPECT_EQ(encoded({0, 0}), (Bytes{0, 2, 0, 0}));
  EXPECT_EQ(encoded({9, 0, 0, 0, 9}), (Bytes{9, 0, 3, 9}));
  EXPECT_EQ(encoded(Bytes(255, 0)), (Bytes{0, 255, 0, 0}));
}

TEST(RleEncode, RunsBeyond255AreSplit) {
  EXPECT_EQ(encoded(Bytes(256, 0)), (Bytes{0, 255, 1, 0}));
  EXPECT_EQ(encoded(Bytes(257, 0)), (Bytes{0, 255, 0, 2}));
  EXPECT_EQ(encoded(Bytes(512, 0)), (Bytes{0, 255, 0, 255, 0, 2, 0, 0}));
}

TEST(RleEncode, ValuesBelowTheThresholdBecomeZeroAndTheThresholdStays) {
  EXPECT_EQ(encoded({49, 50, 51, 0}, 50), (Bytes{1, 50, 51, 1}));
  EXPECT_EQ(encoded({2, 3, 1, 1}, 3), (Bytes{1, 3, 0, 2}));
  EXPECT_EQ(encoded({2, 3, 1, 1}, 1), (Bytes{1, 3, 0, 2})) << "1 and 2 have a meaning of their own";
}

TEST(RleEncode, LeastLiteralIsTheSmallestValueThatIsKept) {
  for (int threshold = 0; threshold <= 255; ++threshold) {
    const auto given = static_cast<std::uint8_t>(threshold);
    const int least = least_literal(given);
    EXPECT_EQ(least, std::max(threshold, 3));
    for (int value = 0; value <= 255; ++value) {
      const Bytes line{static_cast<std::uint8_t>(value)};
      EXPECT_EQ(decoded(encoded(line, given), 1), value < least ? Bytes{0} : line) << threshold;
    }
  }
}

TEST(RleEncode, NothingToCode) {
  EXPECT_TRUE(encoded({}).empty());
}

TEST(RleEncode, PaddingCountsFromWhereTheLineBegan) {
  Bytes out{0xAA, 0xBB, 0xCC};
  rle_encode(Bytes{200}, 3, out);
  EXPECT_EQ(out, (Bytes{0xAA, 0xBB, 0xCC, 200, 0, 0, 0}));
}

TEST(RleDecode, LiteralsSinglesAndRuns) {
  EXPECT_EQ(decoded({5, 1, 7, 0, 3, 255}, 7), (Bytes{5, 0, 7, 0, 0, 0, 255}));
}

TEST(RleDecode, TwoIsALiteral) {
  EXPECT_EQ(decoded({2, 2}, 2), (Bytes{2, 2}));
}

TEST(RleDecode, RunOfNoBeamsIsNothing) {
  EXPECT_EQ(decoded({0, 0, 9}, 1), (Bytes{9}));
}

TEST(RleDecode, StopsWhenAllBeamsAreThere) {
  Bytes beams(2);
  EXPECT_EQ(rle_decode(Bytes{7, 8, 9, 10}, beams), 2U);
  EXPECT_EQ(beams, (Bytes{7, 8}));
}

TEST(RleDecode, StopsAtTheEndOfTheDataAndClearsTheRest) {
  Bytes beams(4, 0xEE);
  EXPECT_EQ(rle_decode(Bytes{7}, beams), 1U);
  EXPECT_EQ(beams, (Bytes{7, 0, 0, 0}));
}

TEST(RleDecode, RunBeyondTheBeamsIsCut) {
  Bytes beams(3, 0xEE);
  EXPECT_EQ(rle_decode(Bytes{7, 0, 255, 9}, beams), 3U);
  EXPECT_EQ(beams, (Bytes{7, 0, 0}));
}

TEST(RleDecode, MarkerWithoutItsCountIsNothing) {
  Bytes beams(3, 0xEE);
  EXPECT_EQ(rle_decode(Bytes{7, 0}, beams), 1U);
  EXPECT_EQ(beams, (Bytes{7, 0, 0}));
}

TEST(RleDecode, NothingInNothingOut) {
  EXPECT_EQ(rle_decode(Bytes{}, {}), 0U);
  EXPECT_EQ(rle_decode(Bytes{1, 0, 5, 9}, {}), 0U);
}

/// Lines with every density of echoes, from empty to full, at every threshold.
TEST(RleProperty, DecodingGivesBackTheLineWithSmallValuesZeroed) {
  std::mt19937 generator{20240501};
  for (int trial = 0; trial < 4000; ++trial) {
    const auto threshold = static_cast<std::uint8_t>(3 + generator() % 253);
    const unsigned echoes_in_16 = generator() % 17;
    Bytes beams(generator() % 600);
    for (auto& beam : beams) {
      beam = generator() % 16 < echoes_in_16 ? static_cast<std::uint8_t>(generator()) : std::uint8_t{0};
    }
    const Bytes data = encoded(beams, threshold);
    EXPECT_EQ(data.size() % 4, 0U);
    EXPECT_LE(data.size(), (beams.size() + 3) / 4 * 4) << "never longer than plain";

    Bytes expected = beams;
    for (auto& beam : expected) {
      beam = beam < threshold ? std::uint8_t{0} : beam;
    }
    Bytes back(beams.size(), 0xEE);
    EXPECT_EQ(rle_decode(data, back), beams.size());
    ASSERT_EQ(back, expected) << "trial " << trial;
  }
}

}  // namespace
}  // namespace sonard::gemini
