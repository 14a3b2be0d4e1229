// SPDX-License-Identifier: Apache-2.0
// Ends of visible segments across a wedge, computed by hand.
#include "renderer/engines/cpu/visible_ends.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace sonard::render {
namespace {

constexpr float width_rad = 0.01F;
constexpr float tan_limit = 0.2F;

/// Segments of one body at 1 / h = `w`, one above the other.
class VisibleEndsTest : public ::testing::Test {
 protected:
  void add(float low, float high, float w, float low_slope, float high_slope, const FanTriangle& of) {
    constexpr float any = 10.0F;  // longer than the fan is high
    visible.push_back(
        {low, high, w, 0.0F, {low_slope, any}, {high_slope, any}, 1.0F, 0.0F, 0.0F, of.part, &of});
  }
  void run() {
    seen.lay_out(visible);
    VisibleEnds().run_straight(width_rad, tan_limit, seen);
  }
  /// Least distance between the ends of a segment at a side of the wedge; negative if they have crossed.
  float least_length(std::size_t i) const {
    const float turn = std::abs(seen.high_slope[i] - seen.low_slope[i]) * width_rad / 2;
    return seen.high[i] - seen.low[i] - turn;
  }

  const FanTriangle bed{}, post = [] {
    FanTriangle other{};
    other.part = 1;
    return other;
  }();
  std::vector<VisibleSegment> visible;
  VisibleArrays seen;
};

TEST_F(VisibleEndsTest, TipInsideASurfaceStays) {
  add(-0.100F, -0.050F, 0.1F, 0, 1, bed);
  add(-0.050F, -0.049F, 0.1F, 1, -1, bed);
  add(-0.049F, 0.000F, 0.1F, -1, 0, bed);
  run();
  EXPECT_EQ(seen.low_slope[1], 1);
  EXPECT_EQ(seen.high_slope[1], -1);
  EXPECT_LT(least_length(1), 0);
}

TEST_F(VisibleEndsTest, InnerEndsTurnWithASilhouette) {
  add(-0.100F, -0.050F, 0.2F, 0, 1, bed);    // a crest, and the segments beyond it
  add(-0.050F, -0.049F, 0.1F, 1, -1, bed);   // ends at a tip
  add(-0.049F, -0.048F, 0.1F, -1, 0, bed);   // as its low end turns, so does this one
  add(-0.048F, 0.000F, 0.1F, 0, 0.5F, bed);  // long enough
  run();
  EXPECT_EQ(seen.high_slope[0], 1) << "what hides does not move";
  EXPECT_EQ(seen.low_slope[1], 1);
  for (std::size_t i = 1; i < 4; ++i) {
    EXPECT_GE(least_length(i), -1e-8F) << i;
  }
  EXPECT_EQ(seen.high_slope[1], seen.low_slope[2]) << "segments go on side by side";
  EXPECT_EQ(seen.high_slope[2], seen.low_slope[3]);
  EXPECT_NEAR(seen.high_slope[1], 0.8F, 1e-5F) << "1 - 2 x 0.001 / 0.01";
  EXPECT_NEAR(seen.high_slope[2], 0.6F, 1e-5F);
  EXPECT_EQ(seen.high_slope[3], 0.5F);
}

TEST_F(VisibleEndsTest, TheSameFromAbove) {
  add(-0.100F, -0.050F, 0.1F, 0, 0, bed);
  add(-0.050F, -0.049F, 0.1F, 0, 1, bed);
  add(-0.049F, 0.000F, 0.2F, 1, 0, bed);
  run();
  EXPECT_EQ(seen.high_slope[1], 1);
  EXPECT_EQ(seen.low_slope[2], 1);
  EXPECT_NEAR(seen.low_slope[1], 0.8F, 1e-5F);
  EXPECT_EQ(seen.high_slope[0], seen.low_slope[1]);
}

TEST_F(VisibleEndsTest, AnotherBodyEndsASurface) {
  add(-0.100F, -0.050F, 0.1F, 0, 0, bed);
  add(-0.050F, -0.049F, 0.1F, 0, 1, post);  // touches the bed, but does not continue it
  add(-0.049F, 0.000F, 0.1F, 1, 0, post);
  run();
  EXPECT_EQ(seen.high_slope[0], 0);
  EXPECT_EQ(seen.low_slope[1], 0);
  EXPECT_NEAR(seen.high_slope[1], 0.2F, 1e-5F);
}

TEST_F(VisibleEndsTest, BothEndsOfASliverMeetHalfway) {
  add(-0.050F, -0.049F, 0.1F, -1, 1, post);  // in front of nothing: tapers upwards in the wedge
  run();
  EXPECT_NEAR(seen.low_slope[0], -0.1F, 1e-5F);
  EXPECT_NEAR(seen.high_slope[0], 0.1F, 1e-5F);
}

TEST_F(VisibleEndsTest, NothingRunsOutOfTheFan) {
  add(0.100F, 0.199F, 0.1F, 0, 3, bed);
  run();
  EXPECT_NEAR(seen.high_slope[0], 0.2F, 1e-4F) << "2 x 0.001 / 0.01";
}

}  // namespace
}  // namespace sonard::render
