// SPDX-License-Identifier: Apache-2.0
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "protocol/glf/piecewise_bytes.hpp"

namespace sonard::glf {
namespace {

TEST(PiecewiseBytes, EveryPartIsWhatItWouldBeInOnePiece) {
  std::vector<std::uint8_t> whole(12);
  std::iota(whole.begin(), whole.end(), std::uint8_t{1});
  PiecewiseBytes pieces;
  std::size_t begin = 0;
  for (const std::size_t size : {2U, 0U, 1U, 5U, 4U}) {
    pieces.append(std::span{whole}.subspan(begin, size));
    begin += size;
  }
  ASSERT_EQ(pieces.size(), whole.size());
  for (std::size_t offset = 0; offset <= whole.size(); ++offset) {
    for (std::size_t size = 0; size <= whole.size() - offset; ++size) {
      std::vector<std::uint8_t> copy(size);
      pieces.copy(offset, copy);
      const auto first = whole.begin() + static_cast<std::ptrdiff_t>(offset);
      EXPECT_EQ(copy, std::vector(first, first + static_cast<std::ptrdiff_t>(size))) << offset << " " << size;
    }
  }
}

}  // namespace
}  // namespace sonard::glf
