// SPDX-License-Identifier: Apache-2.0
// Pings of a head that are kept for later viewers.
#include <memory>

#include <gtest/gtest.h>

#include "server/web/site.hpp"

namespace sonard::server {
namespace {

std::shared_ptr<const ShownPing> ping(std::uint64_t number, int beams, int bins = 10) {
  auto shown = std::make_shared<ShownPing>();
  shown->record.number = number;
  shown->record.settings.beams = beams;
  shown->record.settings.bins = bins;
  shown->record.settings.bin_m = 0.1;
  return shown;
}

TEST(LastPings, AreTheNewestFan) {
  Pings kept;
  keep_newest(kept, ping(1, 256));
  keep_newest(kept, ping(2, 256));
  ASSERT_EQ(kept.size(), 1U);
  EXPECT_EQ(kept[0]->record.number, 2U);
}

TEST(LastPings, AreTheLinesOfATurnInTheirOrder) {
  Pings kept;
  for (std::uint64_t number = 1; number <= 1000; ++number) {
    keep_newest(kept, ping(number, 1));
  }
  ASSERT_EQ(kept.size(), 400U) << "of 0.9 degrees each, the finest step of those that are served";
  EXPECT_EQ(kept.front()->record.number, 601U);
  EXPECT_EQ(kept.back()->record.number, 1000U);
}

TEST(LastPings, BeginAnewWithLinesOfAnotherSize) {
  Pings kept;
  keep_newest(kept, ping(1, 1));
  keep_newest(kept, ping(2, 1, 20));
  keep_newest(kept, ping(3, 1, 20));
  ASSERT_EQ(kept.size(), 2U);
  EXPECT_EQ(kept.front()->record.number, 2U);
}

}  // namespace
}  // namespace sonard::server
