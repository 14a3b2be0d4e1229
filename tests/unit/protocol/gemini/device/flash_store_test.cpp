// SPDX-License-Identifier: Apache-2.0
// The head's flash memory (protocol/gemini/README.md 3.7).
#include "protocol/gemini/flash_store.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace sonard::gemini {
namespace {

TEST(FlashStore, IsErasedAtFirst) {
  const FlashStore store;
  EXPECT_TRUE(std::ranges::all_of(store.read(0x12345), [](std::uint8_t byte) { return byte == 0xFF; }));
}

TEST(FlashStore, ReadsAcrossThePageBorder) {
  FlashStore store;
  ASSERT_TRUE(store.write_page(0x400, std::vector<std::uint8_t>(1024, 0x11)));
  ASSERT_TRUE(store.write_page(0x800, std::vector<std::uint8_t>(1024, 0x22)));
  const auto data = store.read(0x7FC);
  EXPECT_EQ(data[3], 0x11);
  EXPECT_EQ(data[4], 0x22);
  EXPECT_EQ(data[1023], 0x22);
  EXPECT_EQ(store.read(0x3FF)[0], 0xFF);
  EXPECT_EQ(store.read(0x3FF)[1], 0x11);
}

TEST(FlashStore, WritingReplacesTheWholePage) {
  FlashStore store;
  ASSERT_TRUE(store.write_page(0x400, std::vector<std::uint8_t>(1024, 0x11)));
  ASSERT_TRUE(store.write_page(0x7FF, std::vector<std::uint8_t>{0x33}));
  EXPECT_EQ(store.read(0x400)[0], 0x33);
  EXPECT_EQ(store.read(0x400)[1], 0xFF);
}

TEST(FlashStore, EndsAtEightMebibytes) {
  FlashStore store;
  EXPECT_TRUE(store.write_page(0x7FFC00, std::vector<std::uint8_t>{1}));
  EXPECT_FALSE(store.write_page(0x800000, std::vector<std::uint8_t>{1}));
  EXPECT_EQ(store.read(0xFFFFFFFC)[0], 0xFF);
}

}  // namespace
}  // namespace sonard::gemini
