// SPDX-License-Identifier: Apache-2.0
// Statuses: each field at its offset of protocol/glf/README.md 1.5, after the 21 bytes of the header. A
// status has 218 bytes and no end tag.
#include <gtest/gtest.h>

#include "protocol/glf/codec.hpp"
#include "tests/unit/protocol/glf/fixture.hpp"

namespace sonard::glf::testing {
namespace {

TEST(Status, HeaderSaysWhatItIs) {
  const Bytes record = encode(small_status());
  ASSERT_EQ(record.size(), 21U + 218U);
  EXPECT_EQ(Bytes(record.begin(), record.begin() + 21),
            from_hex("2A 02 EF 00 00 00 00 00 00 00 00 41 9F 40 03 01 02 66 00 00 00"));
}

TEST(Status, FieldsAreAtTheirOffsets) {
  const Bytes record = encode(small_status());
  const auto body = std::span{record}.subspan(21);
  EXPECT_EQ(value_at<std::uint16_t>(body, 0), 1);
  EXPECT_EQ(value_at<std::uint16_t>(body, 2), 0x0203);
  EXPECT_EQ(value_at<std::uint16_t>(body, 4), 0x0405);
  EXPECT_EQ(value_at<std::uint16_t>(body, 6), 0x0607);
  EXPECT_EQ(value_at<std::uint16_t>(body, 8), 514);
  EXPECT_EQ(value_at<std::uint8_t>(body, 10), 1);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(value_at<double>(body, 11 + 8 * i), 20.5 + static_cast<double>(i)) << i;
  }
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(value_at<double>(body, 67 + 8 * i), 30.5 + static_cast<double>(i)) << i;
  }
  EXPECT_EQ(value_at<std::uint16_t>(body, 131), 0x3201);
  EXPECT_EQ(value_at<double>(body, 133), 94.5);
  EXPECT_EQ(value_at<double>(body, 141), 95.5);
  EXPECT_EQ(value_at<std::uint16_t>(body, 149), 99);
  for (std::uint32_t i = 0; i < 7; ++i) {
    EXPECT_EQ(value_at<std::uint32_t>(body, 151 + 4 * i), 1001 + i) << i;
  }
  EXPECT_EQ(value_at<std::uint32_t>(body, 179), 0x0A3D1301U);
  EXPECT_EQ(value_at<std::uint32_t>(body, 183), 0x0A3D1302U);
  EXPECT_EQ(value_at<std::uint32_t>(body, 187), 0x00FFFFFEU);
  EXPECT_EQ(value_at<std::uint16_t>(body, 191), 0x1122);
  EXPECT_EQ(value_at<std::uint16_t>(body, 193), 0x3344);
  EXPECT_EQ(value_at<std::uint16_t>(body, 195), 0x5566);
  EXPECT_EQ(value_at<std::uint32_t>(body, 197), 0x1003U);
  EXPECT_EQ(value_at<std::uint32_t>(body, 201), 0x1004U);
  EXPECT_EQ(value_at<std::uint64_t>(body, 205), 0x0102030405060708U);
  EXPECT_EQ(value_at<std::uint16_t>(body, 213), 0x0A0B);
  EXPECT_EQ(value_at<std::uint16_t>(body, 215), 4);
  EXPECT_EQ(value_at<std::uint8_t>(body, 217), 1);
}

TEST(Status, ReadsWhatWasWritten) {
  EXPECT_EQ(*decode_status(encode(small_status())), small_status());
  EXPECT_EQ(*decode_status(encode(StatusRecord{})), StatusRecord{});
}

TEST(Status, EveryShortenedOneIsRefused) {
  const Bytes record = encode(small_status());
  for (std::size_t size = 0; size < record.size(); ++size) {
    const auto decoded = decode_status(std::span{record}.first(size));
    ASSERT_FALSE(decoded) << size;
    EXPECT_EQ(decoded.error().reason, WireErrorReason::truncated);
  }
}

TEST(Status, AnImageIsNone) {
  EXPECT_EQ(decode_status(encode(patterned_image(0))).error(),
            (WireError{WireErrorReason::bad_value, 14, "data_type"}));
}

}  // namespace
}  // namespace sonard::glf::testing
