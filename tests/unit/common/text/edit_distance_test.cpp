// SPDX-License-Identifier: Apache-2.0
#include "common/text/edit_distance.hpp"

#include <gtest/gtest.h>

namespace sonard {
namespace {

// The first is the textbook's example: replace k by s and e by i, insert g.
TEST(EditDistance, CountsInsertionsDeletionsAndReplacements) {
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("sitting", "kitten"), 3U);
  EXPECT_EQ(edit_distance("materials", "material"), 1U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("abc", ""), 3U);
  EXPECT_EQ(edit_distance("same", "same"), 0U);
}

}  // namespace
}  // namespace sonard
