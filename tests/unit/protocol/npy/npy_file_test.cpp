// SPDX-License-Identifier: Apache-2.0
// Bytes as in the documentation of numpy.lib.format for version 1.0, written out by hand.
#include "protocol/npy/npy_file.hpp"

#include <string>

#include <gtest/gtest.h>

namespace sonard::npy {
namespace {

std::string eight_bit_file() {
  // 0x93 NUMPY, version 1.0, header length 118 little-endian: 10 + 118 = 128 is a multiple of 64.
  std::string file("\x93NUMPY\x01\x00\x76\x00", 10);
  file += "{'descr': '|u1', 'fortran_order': False, 'shape': (2, 3), }";
  file.append(127 - file.size(), ' ');
  file += '\n';
  file += std::string("\x00\x01\x02\xFD\xFE\xFF", 6);
  return file;
}

TEST(NpyFile, IsFormat10ToTheByte) {
  EXPECT_EQ(encode({2, 3, {0, 1, 2, 253, 254, 255}, {}}), eight_bit_file());
}

TEST(NpyFile, SixteenBitSamplesAreLittleEndian) {
  const std::string file = encode({1, 2, {}, {0x0102, 0xFFFE}});
  ASSERT_EQ(file.size(), 128U + 4U);
  EXPECT_NE(file.find("'descr': '<u2'"), std::string::npos);
  EXPECT_EQ(file.substr(128), std::string("\x02\x01\xFE\xFF", 4));
}

TEST(NpyFile, FloatsAreLittleEndian) {
  const std::string file = encode({2, 1, {}, {}, {1.0F, -2.5F}});
  ASSERT_EQ(file.size(), 128U + 8U);
  EXPECT_NE(file.find("'descr': '<f4', 'fortran_order': False, 'shape': (2, 1)"), std::string::npos);
  EXPECT_EQ(file.substr(128), std::string("\x00\x00\x80\x3F\x00\x00\x20\xC0", 8));
}

TEST(NpyFile, SamplesBeginAtAMultipleOf64WhateverTheShape) {
  for (int rows = 1; rows < 2'000'000'000 / 10; rows *= 10) {
    const std::string text = header("|u1", rows, 7);
    EXPECT_EQ(text.size() % 64, 0U) << rows;
    EXPECT_EQ(text.back(), '\n');
    EXPECT_EQ(static_cast<unsigned char>(text[8]) + 256U * static_cast<unsigned char>(text[9]),
              text.size() - 10);
  }
}

TEST(NpyFile, ReadsBackWhatItWrote) {
  const Table wide{1, 2, {}, {0x0102, 0xFFFE}};
  EXPECT_EQ(*parse(encode(wide)), wide);
  const Table ranges{1, 3, {}, {}, {0.0F, 2.75F, -1e-9F}};
  EXPECT_EQ(*parse(encode(ranges)), ranges);
  EXPECT_EQ(*parse(eight_bit_file()), (Table{2, 3, {0, 1, 2, 253, 254, 255}, {}}));
}

TEST(NpyFile, RefusesAnyOtherFile) {
  const std::string file = eight_bit_file();
  for (std::size_t size = 0; size < file.size(); ++size) {
    EXPECT_FALSE(parse(file.substr(0, size))) << size;
  }
  EXPECT_FALSE(parse(file + "x"));
}

}  // namespace
}  // namespace sonard::npy
