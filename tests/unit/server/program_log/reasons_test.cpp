// SPDX-License-Identifier: Apache-2.0
#include "server/program_log/reasons.hpp"

#include <string>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

TEST(Reasons, AreTextsWithoutNumbersAndNames) {
  Reasons reasons;
  EXPECT_EQ(reasons.count("datagram of 12 bytes from 10.0.0.1:4000"), 1U);
  EXPECT_EQ(reasons.count("datagram of 7 bytes from 10.0.0.23:51234"), 2U);
  EXPECT_EQ(reasons.count("body 'crab' is not in the world"), 1U);
  EXPECT_EQ(reasons.count("body 'lobster' is not in the world"), 2U);
  EXPECT_EQ(reasons.count("no quaternion"), 1U);
  EXPECT_EQ(reasons.count("datagram of 9 bytes from 10.0.0.1:4000"), 3U);
}

TEST(Reasons, ThatAPeerInventsShareACount) {
  Reasons reasons;
  std::string word;
  for (std::size_t i = 0; i < Reasons::most; ++i) {
    word += 'x';
    EXPECT_EQ(reasons.count(word), 1U);
  }
  EXPECT_EQ(reasons.count("one more"), 1U);
  EXPECT_EQ(reasons.count("and another"), 2U);
  EXPECT_EQ(reasons.count("x"), 2U) << "those that are known keep theirs";
}

}  // namespace
}  // namespace sonard::server
