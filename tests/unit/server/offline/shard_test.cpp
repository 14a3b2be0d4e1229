// SPDX-License-Identifier: Apache-2.0
#include <vector>

#include <gtest/gtest.h>

#include "server/offline/options.hpp"

namespace sonard::server {
namespace {

TEST(ShardText, IsIndexAndCount) {
  EXPECT_EQ(parse_shard("0/1"), (Shard{0, 1}));
  EXPECT_EQ(parse_shard("2/3"), (Shard{2, 3}));
  EXPECT_EQ(parse_shard("3/3"), (Shard{3, 3}));
}

TEST(ShardText, AnythingElseIsRefused) {
  for (const char* text : {"", "1", "/", "1/", "/3", "4/3", "-1/3", "0/0", "1/3 ", " 1/3", "1/3/4", "a/b",
                           "1.5/3", "1/99999999999"}) {
    EXPECT_FALSE(parse_shard(text)) << text;
  }
}

void expect_each_frame_once(const std::vector<Shard>& shards) {
  for (int frame = 0; frame < 20; ++frame) {
    int owners = 0;
    for (const Shard& shard : shards) {
      owners += shard.has(frame) ? 1 : 0;
    }
    EXPECT_EQ(owners, 1) << frame;
  }
}

TEST(Shards, HaveEachFrameOnceCountedFrom0OrFrom1) {
  expect_each_frame_once({{0, 3}, {1, 3}, {2, 3}});
  expect_each_frame_once({{1, 3}, {2, 3}, {3, 3}});
  expect_each_frame_once({{0, 1}});
}

}  // namespace
}  // namespace sonard::server
