// SPDX-License-Identifier: Apache-2.0
#include "server/recording/served_pixels.hpp"

#include <gtest/gtest.h>

#include "tests/unit/recording/fixture.hpp"

namespace sonard::server {
namespace {

constexpr int lines = 40;

// What a surface has of the sample at (line, beam).
template <class Expected>
void expect_pixels(const std::vector<std::uint8_t>& pixels, const Expected& expected) {
  ASSERT_EQ(pixels.size(), static_cast<std::size_t>(lines * 256));
  for (int line = 0; line < lines; ++line) {
    for (int beam = 0; beam < 256; ++beam) {
      EXPECT_EQ(pixels[static_cast<std::size_t>(line * 256 + beam)], expected(test::sample(5, line, beam)))
          << line << " " << beam;
    }
  }
}

TEST(ServedPixels, AreTheSamples) {
  expect_pixels(served_pixels(test::encoded_ping(5, lines)), [](std::uint8_t sample) { return sample; });
}

TEST(ServedPixels, BelowTheThresholdOfTheCodingAreZero) {
  expect_pixels(served_pixels(test::encoded_ping(5, lines, 0x0004, 100)),
                [](std::uint8_t sample) { return sample < 100 ? std::uint8_t{0} : sample; });
}

TEST(ServedPixels, AreTheHighBytesOfLongSamples) {
  expect_pixels(served_pixels(test::encoded_ping(5, lines, 0x0000)),
                [](std::uint8_t sample) { return sample; });
}

}  // namespace
}  // namespace sonard::server
