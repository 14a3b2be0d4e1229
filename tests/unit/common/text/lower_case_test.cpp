// SPDX-License-Identifier: Apache-2.0
#include "common/text/lower_case.hpp"

#include <gtest/gtest.h>

namespace sonard {
namespace {

TEST(LowerCase, ChangesLettersOnly) {
  EXPECT_EQ(lower_case("NVIDIA H200 [0]"), "nvidia h200 [0]");
  EXPECT_EQ(lower_case(""), "");
}

}  // namespace
}  // namespace sonard
