// SPDX-License-Identifier: Apache-2.0
#include "common/text/percent_decoding.hpp"

#include <gtest/gtest.h>

namespace sonard {
namespace {

TEST(PercentDecoding, DecodesEscapesAndNothingElse) {
  EXPECT_EQ(percent_decoded("a%20b%2Fc%2f"), "a b/c/");
  EXPECT_EQ(percent_decoded("100% %zz"), "100% %zz");
}

}  // namespace
}  // namespace sonard
