// SPDX-License-Identifier: Apache-2.0
// Angles of a scan's pings (protocol/ping360/README.md 3.3), as sequences written out by hand.
#include "protocol/ping360/sweep.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <vector>

#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {
namespace {

std::vector<int> angles(int start, int stop, int step, std::size_t count, bool to_stop = false) {
  Sweep sweep(start, stop, step, to_stop);
  std::vector<int> found;
  for (; found.size() < count; sweep.advance()) {
    found.push_back(sweep.angle());
  }
  return found;
}

TEST(Ping360Sweep, MoreThanHalfATurnGoesOneWay) {
  EXPECT_EQ(angles(0, 399, 100, 6), (std::vector{0, 100, 200, 300, 0, 100}));
  EXPECT_EQ(angles(0, 201, 100, 4), (std::vector{0, 100, 200, 0}));
  EXPECT_EQ(angles(300, 200, 80, 6), (std::vector{300, 380, 60, 140, 300, 380})) << "across 0";
}

TEST(Ping360Sweep, HalfATurnGoesBackAndForth) {
  EXPECT_EQ(angles(0, 200, 100, 6), (std::vector{0, 100, 200, 100, 0, 100}));
  EXPECT_EQ(angles(395, 5, 5, 6), (std::vector{395, 0, 5, 0, 395, 0})) << "ends are not doubled";
  EXPECT_EQ(angles(10, 11, 1, 4), (std::vector{10, 11, 10, 11}));
}

TEST(Ping360Sweep, StepsThatMissTheStop) {
  EXPECT_EQ(angles(0, 10, 4, 6), (std::vector{0, 4, 8, 4, 0, 4}));
  EXPECT_EQ(angles(0, 10, 4, 7, true), (std::vector{0, 4, 8, 10, 8, 4, 0})) << "where told to end on it";
  EXPECT_EQ(angles(0, 8, 4, 5, true), (std::vector{0, 4, 8, 4, 0}));
  EXPECT_EQ(angles(0, 3, 10, 3), (std::vector{0, 0, 0}));
  EXPECT_EQ(angles(0, 3, 10, 3, true), (std::vector{0, 3, 0}));
  EXPECT_EQ(angles(0, 398, 10, 41, true).back(), 0) << "one way ends on the last whole step";
}

TEST(Ping360Sweep, EqualLimitsStare) {
  EXPECT_EQ(angles(77, 77, 1, 3), (std::vector{77, 77, 77}));
}

TEST(Ping360Sweep, EverySectorStaysInsideAndMovesByItsStepOrBackToItsStart) {
  for (int start = 0; start < 400; start += 37) {
    for (int stop = 0; stop < 400; stop += 13) {
      for (int step = 1; step <= 10; ++step) {
        const int span = wrapped(stop - start);
        const auto found = angles(start, stop, step, 900);
        EXPECT_EQ(found[0], start);
        for (std::size_t i = 1; i < found.size(); ++i) {
          EXPECT_LE(wrapped(found[i] - start), span);
          const int turn = std::abs(shortest_turn(found[i - 1], found[i]));
          EXPECT_TRUE(turn == step || span < step || (span > 200 && found[i] == start));
        }
        EXPECT_EQ(std::set<int>(found.begin(), found.end()).size(),
                  static_cast<std::size_t>(span / step + 1));
      }
    }
  }
}

}  // namespace
}  // namespace sonard::ping360
