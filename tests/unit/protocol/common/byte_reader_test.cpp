// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/byte_reader.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "protocol/common/byte_writer.hpp"
#include "protocol/common/wire_error.hpp"

namespace sonard {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(ByteReader, ReadsLeastSignificantByteFirst) {
  const Bytes bytes{0x01, 0x03, 0x02, 0x07, 0x06, 0x05, 0x04, 0xF8, 0xF7, 0xF6, 0xF5, 0xF4, 0xF3, 0xF2, 0xF1};
  ByteReader reader{bytes};
  EXPECT_EQ(reader.u8("a"), 0x01);
  EXPECT_EQ(reader.u16le("b"), 0x0203);
  EXPECT_EQ(reader.u32le("c"), 0x04050607U);
  EXPECT_EQ(reader.u64le("d"), 0xF1F2F3F4F5F6F7F8U);
  EXPECT_EQ(reader.remaining(), 0U);
  EXPECT_TRUE(reader.ok());
}

TEST(ByteReader, ReadsOddWidths) {
  const Bytes bytes{0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77};
  ByteReader reader{bytes};
  EXPECT_EQ(reader.little_endian(7, "time"), 0x77665544332211U);
}

TEST(ByteReader, LatchesTheFirstErrorAndReadsZeroFromThenOn) {
  const Bytes bytes{0x01, 0x02, 0x03};
  ByteReader reader{bytes};
  EXPECT_EQ(reader.u16le("first"), 0x0201);
  EXPECT_EQ(reader.u32le("second"), 0U);
  EXPECT_EQ(reader.u8("third"), 0U) << "a byte is left, but the reader has failed";
  reader.fail(WireErrorReason::bad_value, "fourth");
  ASSERT_TRUE(reader.error().has_value());
  EXPECT_EQ(*reader.error(), (WireError{WireErrorReason::truncated, 2, "second"}));
}

TEST(ByteReader, GivesNoPartialSpan) {
  const Bytes bytes{0x01, 0x02, 0x03};
  ByteReader reader{bytes};
  EXPECT_TRUE(reader.bytes(4, "data").empty());
  EXPECT_FALSE(reader.ok());
}

TEST(ByteReader, TakesASpanToTheLastByte) {
  const Bytes bytes{0x01, 0x02, 0x03};
  ByteReader reader{bytes};
  reader.skip(1, "spare");
  const auto view = reader.bytes(2, "data");
  ASSERT_EQ(view.size(), 2U);
  EXPECT_EQ(view[0], 0x02);
  EXPECT_EQ(view[1], 0x03);
  EXPECT_TRUE(reader.ok());
}

TEST(ByteReader, RefusesACountThatWouldOverflowTheOffset) {
  const Bytes bytes{0x01, 0x02};
  ByteReader reader{bytes};
  reader.skip(1, "spare");
  EXPECT_TRUE(reader.bytes(SIZE_MAX, "data").empty());
  EXPECT_EQ(*reader.error(), (WireError{WireErrorReason::truncated, 1, "data"}));
}

TEST(ByteReader, CanBlameAFieldReadBefore) {
  const Bytes bytes{0x01, 0x02};
  ByteReader reader{bytes};
  reader.skip(2, "count");
  reader.fail_at(0, WireErrorReason::bad_length, "count");
  EXPECT_EQ(*reader.error(), (WireError{WireErrorReason::bad_length, 0, "count"}));
}

TEST(ByteWriter, AppendsLeastSignificantByteFirst) {
  Bytes out{0xEE};
  ByteWriter writer{out};
  writer.u8(0x01);
  writer.u16le(0x0203);
  writer.u32le(0x04050607);
  writer.little_endian(0x08090A, 3);
  writer.zeros(2);
  writer.bytes(std::array<std::uint8_t, 2>{0xAA, 0xBB});
  EXPECT_EQ(writer.offset(), 14U) << "counted from where the writer began";
  EXPECT_EQ(
      out, (Bytes{0xEE, 0x01, 0x03, 0x02, 0x07, 0x06, 0x05, 0x04, 0x0A, 0x09, 0x08, 0x00, 0x00, 0xAA, 0xBB}));
}

TEST(ByteWriter, WritesEightBytes) {
  Bytes out;
  ByteWriter writer{out};
  writer.u64le(0x0102030405060708U);
  EXPECT_EQ(out, (Bytes{8, 7, 6, 5, 4, 3, 2, 1}));
}

TEST(WireError, PrintsAsOneLine) {
  EXPECT_EQ(to_string(WireError{WireErrorReason::truncated, 22, "end_range"}),
            "truncated: field end_range at byte 22");
  EXPECT_EQ(to_string(WireErrorReason::bad_length), "bad_length");
  EXPECT_EQ(to_string(WireErrorReason::bad_value), "bad_value");
}

}  // namespace
}  // namespace sonard
