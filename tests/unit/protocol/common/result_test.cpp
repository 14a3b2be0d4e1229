// SPDX-License-Identifier: Apache-2.0
#include "protocol/common/result.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <variant>

#include "protocol/common/wire_error.hpp"

namespace sonard {
namespace {

Result<int, std::string> half(int number) {
  if (number % 2 != 0) {
    return std::string{"odd"};
  }
  return number / 2;
}

TEST(Result, HoldsTheValue) {
  const auto result = half(6);
  ASSERT_TRUE(result);
  EXPECT_EQ(*result, 3);
  EXPECT_EQ(result.value_or(-1), 3);
}

TEST(Result, HoldsTheError) {
  const auto result = half(7);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error(), "odd");
  EXPECT_EQ(result.value_or(-1), -1);
}

TEST(Result, ConvertsIntoAVariantValue) {
  using Message = std::variant<int, std::string>;
  const Result<Message, WireError> result = std::string{"text"};
  ASSERT_TRUE(result);
  EXPECT_EQ(std::get<std::string>(*result), "text");
}

TEST(Result, MovesItsValueOut) {
  Result<std::unique_ptr<int>, WireError> result = std::make_unique<int>(5);
  const std::unique_ptr<int> taken = *std::move(result);
  EXPECT_EQ(*taken, 5);
}

TEST(Result, ComparesByContent) {
  EXPECT_EQ(half(4), half(4));
  EXPECT_EQ(half(1), half(3));
  EXPECT_FALSE(half(4) == half(6));
  EXPECT_FALSE(half(4) == half(5));
}

}  // namespace
}  // namespace sonard
