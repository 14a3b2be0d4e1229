// SPDX-License-Identifier: Apache-2.0
// Images: every byte at its place in the tables of protocol/glf/README.md 1.3 and 1.4, written out by hand;
// when images are packed; which images are refused.
#include <random>
#include <stdexcept>

#include <gtest/gtest.h>

#include "protocol/glf/codec.hpp"
#include "tests/unit/protocol/glf/fixture.hpp"

namespace sonard::glf::testing {
namespace {

TEST(Image, BytesAreThoseOfTheTables) {
  // 21 + 30 + 6 + 3 * 8 + 34 = 115. 1000.5 is 0x408F440000000000, 65 is 0x42820000, 1500 is 0x44BB8000.
  EXPECT_EQ(encode(small_image()),
            from_hex("2A 02 73 00 00 00 "                      // id, version, length
                     "00 00 00 00 00 44 8F 40 "                // time
                     "00 AA 04 65 00 00 00 "                   // type, device, node, spare
                     "01 00 EF EF 03 00 "                      // record type, tag, version
                     "00 00 00 00 02 00 00 00 00 00 "          // lines, compression
                     "00 00 00 00 03 00 00 00 "                // beams
                     "01 00 06 00 00 00 "                      // raw, data size
                     "0A 14 1E 28 32 FF "                      // pixels
                     "00 00 00 00 00 00 F0 3F "                // bearings
                     "00 00 00 00 00 00 00 00 "                //
                     "00 00 00 00 00 00 F0 BF "                //
                     "04 03 02 01 3E 49 00 00 00 00 82 42 "    // state, frequency, aperture
                     "00 00 00 00 00 44 8F 40 00 81 "          // transmit time, ping flags
                     "00 80 BB 44 35 00 01 02 04 00 DE DE"));  // sound speed .. end tag
}

TEST(Image, PartOfAFanKeepsWhereItStarts) {
  ImageRecord image = small_image();
  image.first_line = 7;
  image.first_beam = 9;
  image.range_compression = 0x0002;
  const Bytes record = encode(image);
  EXPECT_EQ(value_at<std::uint32_t>(record, 21 + 6), 7U);
  EXPECT_EQ(value_at<std::uint32_t>(record, 21 + 10), 9U);
  EXPECT_EQ(value_at<std::uint16_t>(record, 21 + 14), 2U);
  EXPECT_EQ(value_at<std::uint32_t>(record, 21 + 16), 9U);
  EXPECT_EQ(value_at<std::uint32_t>(record, 21 + 20), 12U);
  EXPECT_EQ(*decode_image(record), image);
}

TEST(Image, PackedOnesHaveTheSizeThatTheLayoutSays) {
  for (const int level : {1, 6, 9}) {
    const Bytes record = encode(patterned_image(3), level);
    EXPECT_EQ(value_at<std::uint16_t>(record, 21 + 24), 0) << "zlib";
    const std::size_t data_size = value_at<std::uint32_t>(record, 21 + 26);
    EXPECT_LT(data_size, 50U * 64U);
    EXPECT_EQ(record.size(), 21 + 30 + data_size + 512 + 34);
    EXPECT_EQ(value_at<std::uint32_t>(record, 2), record.size());
    EXPECT_EQ(record[21 + 30] & 0x0F, 8) << "the first byte of a zlib stream: deflate";
    EXPECT_EQ(value_at<std::uint8_t>(record, record.size() - 3), 0) << "no acoustic zoom";
    EXPECT_EQ(*decode_image(record), patterned_image(3));
  }
}

// Readers take data of the image's length for raw pixels, for any type, so compressed data must be shorter.
TEST(Image, NoiseIsStoredAsItIs) {
  ImageRecord image = patterned_image(0);
  std::mt19937 random{1};
  for (auto& pixel : image.pixels) {
    pixel = static_cast<std::uint8_t>(random());
  }
  const Bytes record = encode(image, 9);
  EXPECT_EQ(value_at<std::uint16_t>(record, 21 + 24), 1) << "raw";
  EXPECT_EQ(value_at<std::uint32_t>(record, 21 + 26), 50U * 64U);
  EXPECT_TRUE(std::equal(image.pixels.begin(), image.pixels.end(), record.begin() + 21 + 30));
  EXPECT_EQ(*decode_image(record), image);
}

// Images from zeros, which shrink well, to noise, so that zlib returns every size.
TEST(Image, ZlibIsNeverAsLongAsTheImage) {
  std::mt19937 random{2};
  int raw = 0;
  for (std::size_t noise = 0; noise <= 64; ++noise) {
    ImageRecord image = small_image();
    image.lines = 1;
    image.beams = 64;
    image.bearings_rad.assign(64, 0.0);
    image.pixels.assign(64, 0);
    std::generate_n(image.pixels.begin(), noise, [&] { return static_cast<std::uint8_t>(random()); });
    const Bytes record = encode(image);
    const bool is_raw = value_at<std::uint16_t>(record, 21 + 24) == 1;
    raw += is_raw ? 1 : 0;
    EXPECT_EQ(value_at<std::uint32_t>(record, 21 + 26) == 64, is_raw) << noise;
    EXPECT_EQ(*decode_image(record), image);
  }
  EXPECT_GT(raw, 0);
  EXPECT_LT(raw, 65);
}

TEST(Image, EmptyOnesAreRecordsToo) {
  ImageRecord image = small_image();
  image.lines = 0;
  image.pixels.clear();
  const Bytes record = encode(image);
  EXPECT_EQ(record.size(), 21U + 30 + 0 + 24 + 34);
  EXPECT_EQ(*decode_image(record), image);
}

// Without the field for the packing, all later fields move by two bytes, and the size shows raw pixels (1.4).
TEST(Image, OtherVersionsLackThePacking) {
  Bytes record = encode(small_image());
  patch<std::uint16_t>(record, 21 + 4, 2);
  record.erase(record.begin() + 21 + 24, record.begin() + 21 + 26);
  EXPECT_EQ(*decode_image(record), small_image());

  record = encode(patterned_image(1));
  patch<std::uint16_t>(record, 21 + 4, 2);
  record.erase(record.begin() + 21 + 24, record.begin() + 21 + 26);
  EXPECT_EQ(*decode_image(record), patterned_image(1));
}

TEST(Image, LengthInTheHeaderDoesNotMatter) {
  Bytes record = encode(small_image());
  patch<std::uint32_t>(record, 2, 168);
  EXPECT_EQ(*decode_image(record), small_image());
}

TEST(Image, EveryShortenedOneIsRefused) {
  const Bytes record = encode(small_image());
  for (std::size_t size = 0; size < record.size(); ++size) {
    const auto decoded = decode_image(std::span{record}.first(size));
    ASSERT_FALSE(decoded) << size;
    EXPECT_EQ(decoded.error().reason, WireErrorReason::truncated) << size;
    EXPECT_LE(decoded.error().offset, size);
  }
}

template <class Value>
WireError error_after(std::size_t offset, Value value, Bytes record = encode(small_image())) {
  patch(record, offset, value);
  const auto decoded = decode_image(record);
  EXPECT_FALSE(decoded);
  return decoded ? WireError{} : decoded.error();
}

TEST(Image, WhatMakesNoSenseIsRefusedWithItsPlace) {
  using enum WireErrorReason;
  EXPECT_EQ(error_after<std::uint8_t>(0, '+'), (WireError{bad_value, 0, "id"}));
  EXPECT_EQ(error_after<std::uint8_t>(14, 3), (WireError{bad_value, 14, "data_type"}));
  EXPECT_EQ(error_after<std::uint16_t>(23, 0xEFEE), (WireError{bad_value, 23, "record_tag"}));
  EXPECT_EQ(error_after<std::uint32_t>(27, 3), (WireError{bad_value, 31, "end_range"}));
  EXPECT_EQ(error_after<std::uint32_t>(37, 4), (WireError{bad_value, 41, "end_bearing"}));
  EXPECT_EQ(error_after<std::uint16_t>(45, 2), (WireError{bad_value, 51, "compression_type"})) << "H.264";
  EXPECT_EQ(error_after<std::uint32_t>(31, 3), (WireError{bad_length, 51, "pixels"})) << "raw, but not 3 x 3";
  EXPECT_EQ(error_after<std::uint16_t>(45, 0), (WireError{bad_value, 51, "pixels"})) << "no zlib stream";
  EXPECT_EQ(error_after<std::uint8_t>(112, 1), (WireError{bad_value, 112, "acoustic_zoom"}));
  EXPECT_EQ(error_after<std::uint16_t>(113, 0xDEDF), (WireError{bad_value, 113, "end_tag"}));
}

// More lines than the data can hold are refused before memory is allocated for them.
TEST(Image, BombsAreRefused) {
  const Bytes record = encode(patterned_image(1));
  EXPECT_EQ(error_after<std::uint32_t>(31, 51, record),
            (WireError{WireErrorReason::bad_value, 51, "pixels"}));
  EXPECT_EQ(error_after<std::uint32_t>(31, 49, record),
            (WireError{WireErrorReason::bad_value, 51, "pixels"}));
  EXPECT_EQ(error_after<std::uint32_t>(31, 0x00040000, record),
            (WireError{WireErrorReason::bad_value, 51, "pixels"}));
  EXPECT_EQ(error_after<std::uint32_t>(31, 0x00040001, record),
            (WireError{WireErrorReason::bad_length, 51, "pixels"}));
  EXPECT_EQ(error_after<std::uint32_t>(31, 0xFFFFFFFF, record),
            (WireError{WireErrorReason::bad_length, 51, "pixels"}));
}

TEST(Image, ValuesThatContradictThemselvesAreNotWritten) {
  ImageRecord image = small_image();
  image.pixels.push_back(0);
  EXPECT_THROW(encode(image), std::invalid_argument);
  image = small_image();
  image.bearings_rad.pop_back();
  EXPECT_THROW(encode(image), std::invalid_argument);
  EXPECT_THROW(encode(small_image(), 10), std::invalid_argument);
  EXPECT_THROW(encode(small_image(), -1), std::invalid_argument);
}

TEST(Image, BearingsOfALogFallFromPortToStarboard) {
  EXPECT_EQ(bearing_for_log(-1.0405), 1.0405);
  EXPECT_EQ(bearing_for_log(1.0405), -1.0405);
}

}  // namespace
}  // namespace sonard::glf::testing
