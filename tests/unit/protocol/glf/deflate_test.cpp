// SPDX-License-Identifier: Apache-2.0
// The zlib functions that logs use. They allocate no more memory than the bytes can fill.
#include <gtest/gtest.h>

#include "protocol/glf/deflate.hpp"

namespace sonard::glf {
namespace {

Bytes text(const std::string& characters) {
  return {characters.begin(), characters.end()};
}

TEST(Crc32, IsThatOfZip) {
  Crc32 crc;
  EXPECT_EQ(crc.value(), 0U);
  crc.add(text("1234"));
  crc.add(text("56789"));
  EXPECT_EQ(crc.value(), 0xCBF43926U) << "the check value of this CRC, as catalogues print it";
}

// One stored block and the Adler-32 of RFC 1950: a = 1 + 97, b = 1 + 97 for the one byte 'a'.
const Bytes stored_a{0x78, 0x01, 0x01, 0x01, 0x00, 0xFE, 0xFF, 'a', 0x00, 0x62, 0x00, 0x62};

TEST(Inflate, TakesAStreamOfTheSizeThatWasAskedFor) {
  EXPECT_EQ(inflate_exactly(stored_a, 1, DeflateForm::zlib), text("a"));
  EXPECT_EQ(inflate_exactly(std::span{stored_a}.subspan(2), 1, DeflateForm::bare), text("a"));
  EXPECT_FALSE(inflate_exactly(stored_a, 0, DeflateForm::zlib));
  EXPECT_FALSE(inflate_exactly(stored_a, 2, DeflateForm::zlib));
  EXPECT_FALSE(inflate_exactly(stored_a, 1, DeflateForm::bare));
}

TEST(Inflate, RefusesAStreamThatIsCutOrWrong) {
  for (std::size_t size = 0; size < stored_a.size(); ++size) {
    EXPECT_FALSE(inflate_exactly(std::span{stored_a}.first(size), 1, DeflateForm::zlib)) << size;
  }
  Bytes wrong = stored_a;
  wrong[7] = 'b';
  EXPECT_FALSE(inflate_exactly(wrong, 1, DeflateForm::zlib)) << "its checksum is that of 'a'";
}

// No machine has that much memory, so allocating it would throw.
TEST(Inflate, AsksForNoMemoryThatTheStreamCannotFill) {
  EXPECT_FALSE(inflate_exactly(stored_a, std::uint64_t{1} << 62, DeflateForm::zlib));
}

}  // namespace
}  // namespace sonard::glf
