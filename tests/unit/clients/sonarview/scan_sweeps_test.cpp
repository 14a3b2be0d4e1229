// SPDX-License-Identifier: Apache-2.0
// Turns and gaps of scans whose bearings are written out by hand (protocol/micron/README.md 8.3).
#include "clients/sonarview/micron/scan_sweeps.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "protocol/micron/scan_settings.hpp"

namespace sonard::client {
namespace {

using micron::SweepCode;
using testing::ElementsAre;
using testing::IsEmpty;

micron::ReceivedLine line_at(int bearing, SweepCode sweep = SweepCode::normal) {
  micron::ReceivedLine line;
  line.head.bearing = static_cast<std::uint16_t>(bearing);
  line.head.sweep = sweep;
  return line;
}

std::vector<int> bearings(const Sweep& sweep) {
  std::vector<int> all;
  for (const auto& line : sweep.lines) {
    all.push_back(line.bearing);
  }
  return all;
}

/// A scan, and the turns that it has completed.
struct Scan {
  explicit Scan(const micron::ScanSettings& settings) : sweeps(micron::make_head_command(settings)) {}
  void receive(const std::vector<int>& all) {
    for (const int bearing : all) {
      if (auto sweep = sweeps.add(line_at(bearing))) {
        done.push_back(*sweep);
      }
    }
  }
  ScanSweeps sweeps;
  std::vector<Sweep> done;
};

// Steps of 200 units, 11.25 degrees: 32 per turn.
micron::ScanSettings wide_steps(bool clockwise = true) {
  return {.step = 200, .clockwise = clockwise};
}

TEST(ScanSweeps, ThePictureWithinATurnShowsTheNewestLineOfEachBearing) {
  const Sweep before{0, {{0, {}}, {200, {}}, {400, {}}}, 0};
  const Sweep turn{1, {{0, {}}, {210, {}}}, 0};
  const Sweep shown = with_lines_before(turn, before);
  EXPECT_EQ(shown.number, 1U);
  EXPECT_THAT(bearings(shown), ElementsAre(200, 400, 0, 210));
  EXPECT_THAT(bearings(with_lines_before(turn, std::nullopt)), ElementsAre(0, 210));
}

TEST(ScanSweeps, ASweepEndsBeforeItsFirstBearingComesAgain) {
  Scan scan(wide_steps());
  for (int line = 0; line < 64; ++line) {
    scan.receive({(3200 + 200 * line) % 6400});
    EXPECT_EQ(scan.done.size(), static_cast<std::size_t>((line + 1) / 32)) << line;
  }
  ASSERT_EQ(scan.done.size(), 2U);
  EXPECT_EQ(scan.done[1].number, 1U);
  EXPECT_EQ(scan.done[1].lines.size(), 32U);
  EXPECT_EQ(scan.done[1].lines.front().bearing, 3200);
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

TEST(ScanSweeps, CounterClockwiseIsTheSame) {
  Scan scan(wide_steps(false));
  for (int line = 0; line < 33; ++line) {
    scan.receive({(6400 + 1000 - 200 * line) % 6400});
  }
  ASSERT_EQ(scan.done.size(), 1U);
  EXPECT_EQ(scan.done[0].lines.size(), 32U);
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

TEST(ScanSweeps, StepsThatDoNotDivideTheTurnMakeItALineLonger) {
  micron::ScanSettings settings;
  settings.step = 250;  // 25.6 per turn
  Scan scan(settings);
  int bearing = 3200;
  for (int line = 0; line < 52; ++line, bearing = (bearing + 250) % 6400) {
    scan.receive({bearing});
  }
  ASSERT_EQ(scan.done.size(), 2U);
  EXPECT_EQ(scan.done[0].lines.size(), 26U);
  EXPECT_EQ(scan.done[1].lines.size(), 26U);
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

TEST(ScanSweeps, LinesThatAreLostAreCountedByTheGap) {
  Scan scan(wide_steps());
  scan.receive({3200, 3400, 4000, 4200});  // 3600 and 3800 are missing
  EXPECT_EQ(scan.sweeps.lines_missed(), 2U);
  EXPECT_EQ(scan.sweeps.current().lines_missed, 2U);
  EXPECT_NEAR(scan.sweeps.share(), 1000.0 / 6400.0, 1e-12);
}

TEST(ScanSweeps, ASweepWhoseEndIsLostEndsWithTheNextLine) {
  Scan scan(wide_steps());
  for (int line = 0; line < 31; ++line) {
    scan.receive({(3200 + 200 * line) % 6400});
  }
  EXPECT_THAT(scan.done, IsEmpty());
  scan.receive({3400});  // 3000 and 3200 are missing
  ASSERT_EQ(scan.done.size(), 1U);
  EXPECT_EQ(scan.done[0].lines.size(), 31U);
  EXPECT_EQ(scan.done[0].lines_missed, 2U);
  EXPECT_THAT(bearings(scan.sweeps.current()), ElementsAre(3400));
}

TEST(ScanSweeps, ALineLostBetweenTwoSweepsIsCounted) {
  Scan scan(wide_steps());
  for (int line = 0; line < 32; ++line) {
    scan.receive({(3200 + 200 * line) % 6400});
  }
  ASSERT_EQ(scan.done.size(), 1U);
  scan.receive({3400});
  EXPECT_EQ(scan.sweeps.lines_missed(), 1U);
}

TEST(ScanSweeps, ALineThatComesTwiceIsNoGap) {
  Scan scan(wide_steps());
  scan.receive({3200, 3400, 3400, 3600});
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

micron::ScanSettings sector(int left, int right) {
  micron::ScanSettings settings;
  settings.step = 200;
  settings.sector = micron::ScanSector{left, right};
  return settings;
}

TEST(ScanSweeps, ASweepGoesFromLimitToLimitAndTheWayThereIsNone) {
  Scan scan(sector(2800, 3500));
  scan.receive({3200, 3400, 3500, 3300, 3100, 2900, 2800, 3000, 3200, 3400, 3500});
  ASSERT_EQ(scan.done.size(), 2U);
  EXPECT_THAT(bearings(scan.done[0]), ElementsAre(3500, 3300, 3100, 2900, 2800));
  EXPECT_THAT(bearings(scan.done[1]), ElementsAre(2800, 3000, 3200, 3400, 3500));
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

TEST(ScanSweeps, ASectorMayLieAstern) {
  Scan scan(sector(6200, 300));
  scan.receive({300, 100, 6300, 6200, 0, 200, 300});
  ASSERT_EQ(scan.done.size(), 2U);
  EXPECT_THAT(bearings(scan.done[0]), ElementsAre(300, 100, 6300, 6200));
  EXPECT_THAT(bearings(scan.done[1]), ElementsAre(6200, 0, 200, 300));
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

TEST(ScanSweeps, ASectorMayBeAllButALittle) {
  Scan scan(sector(100, 6300));  // 6200 wide, 31 steps
  for (int line = 0; line <= 31; ++line) {
    scan.receive({100 + 200 * line});
  }
  ASSERT_EQ(scan.done.size(), 1U);
  EXPECT_EQ(scan.done[0].lines.size(), 32U);
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

TEST(ScanSweeps, ASweepWhoseLimitIsLostEndsWhereTheHeadTurnsBack) {
  Scan scan(sector(2800, 3500));
  scan.receive({2800, 3000, 3200, 3400, /*3500,*/ 3300, 3100});
  ASSERT_EQ(scan.done.size(), 1U);
  EXPECT_THAT(bearings(scan.done[0]), ElementsAre(2800, 3000, 3200, 3400));
  EXPECT_EQ(scan.done[0].lines_missed, 1U);
  EXPECT_THAT(bearings(scan.sweeps.current()), ElementsAre(3300, 3100));
  EXPECT_EQ(scan.sweeps.lines_missed(), 1U);
}

TEST(ScanSweeps, AHeadThatStopsShortOfALimitSaysSo) {
  Scan scan(sector(2800, 3500));
  scan.receive({2800, 3000, 3200});
  const auto sweep = scan.sweeps.add(line_at(3400, SweepCode::right_limit));
  ASSERT_TRUE(sweep);
  EXPECT_THAT(bearings(*sweep), ElementsAre(2800, 3000, 3200, 3400));
  scan.receive({3200});
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

TEST(ScanSweeps, AHeadThatBeginsAnewLosesTheSweepAndNoLine) {
  Scan scan(wide_steps());
  scan.receive({3200, 3400, 3600});
  scan.sweeps.restart();
  scan.receive({800});
  EXPECT_THAT(bearings(scan.sweeps.current()), ElementsAre(800));
  EXPECT_EQ(scan.sweeps.current().number, 0U);
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

TEST(ScanSweeps, ASectorBegunAnewGoesEitherWayAtFirst) {
  Scan scan(sector(2800, 3500));
  scan.receive({2800, 3000});
  scan.sweeps.restart();
  scan.receive({3300, 3100, 2900, 2800, 3000, 3200, 3400, 3500});
  ASSERT_EQ(scan.done.size(), 1U);
  EXPECT_THAT(bearings(scan.done[0]), ElementsAre(2800, 3000, 3200, 3400, 3500));
  EXPECT_EQ(scan.sweeps.lines_missed(), 0U);
}

}  // namespace
}  // namespace sonard::client
