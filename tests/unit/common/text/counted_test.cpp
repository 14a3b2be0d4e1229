// SPDX-License-Identifier: Apache-2.0
#include "common/text/counted.hpp"

#include <gtest/gtest.h>

namespace sonard {
namespace {

TEST(Counted, HasNoPluralOfOne) {
  EXPECT_EQ(counted(0, "frame"), "0 frames");
  EXPECT_EQ(counted(1, "frame"), "1 frame");
  EXPECT_EQ(counted(2, "frame"), "2 frames");
}

}  // namespace
}  // namespace sonard
