// SPDX-License-Identifier: Apache-2.0
// Turns of a recorded scan, against turns counted by hand.
#include "server/info/recorded_sweeps.hpp"

#include <numbers>

#include <gtest/gtest.h>

namespace sonard::server {
namespace {

/// A line at a bearing in units of the wire, 1/16 gradian.
LoggedPing at(int bearing, int bins = 100) {
  LoggedPing line;
  line.bearing_rad = (bearing - 3200) * std::numbers::pi / 3200.0;
  line.settings.bins = bins;
  line.settings.beams = 1;
  line.settings.bin_m = 0.05;
  return line;
}

LoggedHead scan_of(const std::vector<int>& bearings) {
  LoggedHead scan;
  scan.scanning = true;
  for (const int bearing : bearings) {
    scan.pings.push_back(at(bearing));
  }
  return scan;
}

TEST(RecordedSweeps, AllRoundASweepEndsWhereItBegan) {
  LoggedHead scan;
  for (int line = 0; line < 450; ++line) {
    scan.pings.push_back(at((3000 + 32 * line) % 6400));  // 200 lines per turn
  }
  const auto turns = sweeps_of(scan);
  ASSERT_EQ(turns.size(), 3U);
  EXPECT_EQ(turns[1].begin, 200U);
  EXPECT_EQ(turns[1].end, 400U);
  EXPECT_EQ(turns[2].end, 450U);
  EXPECT_EQ(turns[0].shape.step, 32);
  EXPECT_EQ(turns[0].shape.width, 6400);
  EXPECT_EQ(turns[0].shape.left, 0);
  EXPECT_EQ(turns[0].shape.bins, 100);
  EXPECT_EQ(turns[0].shape.bin_m, 0.05);
  EXPECT_FALSE(turns[2].shape.full_circle());
  EXPECT_EQ(turns[2].shape.left, 3000);
  EXPECT_EQ(turns[2].shape.width, 49 * 32);
}

TEST(RecordedSweeps, InASectorASweepEndsWhereTheHeadTurnsBack) {
  const auto turns = sweeps_of(scan_of({6300, 6350, 0, 50, 100, 50, 0, 6350, 6300, 6350}));
  ASSERT_EQ(turns.size(), 3U);
  EXPECT_EQ(turns[0].end, 5U);
  EXPECT_EQ(turns[0].shape.left, 6300);
  EXPECT_EQ(turns[0].shape.width, 200);
  EXPECT_EQ(turns[1].end, 9U);
  EXPECT_EQ(turns[1].shape.left, 6300) << "also to the left, through astern";
  EXPECT_EQ(turns[1].shape.width, 150);
}

TEST(RecordedSweeps, AMissingLineIsAGapAndNoOtherStep) {
  const auto turns = sweeps_of(scan_of({3200, 3232, 3264, 3328, 3360}));
  ASSERT_EQ(turns.size(), 1U);
  EXPECT_EQ(turns[0].shape.step, 32);
  EXPECT_EQ(turns[0].shape.width, 160);
}

TEST(RecordedSweeps, OtherBinsBeginAnotherSweep) {
  LoggedHead scan = scan_of({3200, 3232, 3264});
  scan.pings.push_back(at(3296, 200));
  const auto turns = sweeps_of(scan);
  ASSERT_EQ(turns.size(), 2U);
  EXPECT_EQ(turns[1].begin, 3U);
  EXPECT_EQ(turns[1].shape.bins, 200);
}

TEST(RecordedSweeps, AHeadThatStandsStillHasSweepsToo) {
  const auto turns = sweeps_of(scan_of(std::vector<int>(7000, 1600)));
  ASSERT_EQ(turns.size(), 2U);
  EXPECT_EQ(turns[0].end, 6400U);
  EXPECT_EQ(turns[0].shape.left, 1600);
  EXPECT_GT(turns[0].shape.width, 0);
}

TEST(RecordedSweeps, BearingsGoThereAndBack) {
  for (const int bearing : {0, 1, 1600, 3199, 3200, 3201, 4800, 6399}) {
    EXPECT_EQ(picture_bearing(at(bearing)), bearing);
  }
}

}  // namespace
}  // namespace sonard::server
