// SPDX-License-Identifier: Apache-2.0
// Bearings, their order, and the places where a scan turns round (protocol/micron/README.md 5.4, 8.3).
#include <set>
#include <tuple>

#include "bench.hpp"

namespace sonard::micron {
namespace {

using Bearings = std::vector<int>;

struct Scan {
  Bearings bearings;
  std::vector<int> codes;
};

Scan scan(Bench& bench, std::size_t count) {
  Scan result;
  for (const HeadData& line : bench.scan(count)) {
    result.bearings.push_back(line.bearing);
    result.codes.push_back(static_cast<int>(line.sweep));
  }
  return result;
}

class AllRound : public ::testing::TestWithParam<int> {};

TEST_P(AllRound, HasOneLineForEachStepOfTheTurn) {
  const int step = GetParam();
  for (const bool right : {true, false}) {
    Bench bench;
    bench.make_ready(all_round(static_cast<std::uint8_t>(step), right));
    const auto lines = static_cast<std::size_t>(6400 / step + 2);
    const Scan result = scan(bench, lines);
    for (std::size_t i = 0; i < lines; ++i) {
      const int turned = static_cast<int>(i) * step * (right ? 1 : -1);
      ASSERT_EQ(result.bearings[i], (3200 + turned + 2 * 6400) % 6400) << i;
      ASSERT_EQ(result.codes[i], 0);
    }
  }
}
INSTANTIATE_TEST_SUITE_P(steps, AllRound, ::testing::Values(8, 16, 32, 64, 128, 88, 255));

TEST(AllRoundScan, EndsATurnWhereItBegan) {
  Bench bench;
  bench.make_ready(all_round(32));
  const Scan result = scan(bench, 401);
  EXPECT_EQ(std::set<int>(result.bearings.begin(), result.bearings.end()).size(), 200U);
  EXPECT_EQ(result.bearings[200], result.bearings[0]);
  EXPECT_EQ(result.bearings[400], result.bearings[0]);
}

TEST(AllRoundScan, Step0ActsAs16AndIsEchoedAs0) {
  Bench bench;
  bench.make_ready(all_round(0));
  const auto lines = bench.scan(2);
  EXPECT_EQ(lines[1].bearing - lines[0].bearing, 16);
  EXPECT_EQ(lines[0].step, 0);
}

TEST(AllRoundScan, GoesOnFromWhereItIsWithNewParameters) {
  Bench bench;
  bench.make_ready(all_round(32));
  EXPECT_EQ(scan(bench, 3).bearings, (Bearings{3200, 3232, 3264}));
  bench.run_for(1s);
  const int owed = static_cast<int>(bench.all<HeadData>().back().second.bearing);
  bench.command(all_round(100, false));
  bench.run_for(1s);
  EXPECT_EQ(scan(bench, 2).bearings, (Bearings{owed + 32, owed - 68}));
}

/// The bearings and codes of a sector, as a loop over its closed form: there and back, with each end once.
Scan expected_sector(int left, int width, int step, int start, bool right, std::size_t count) {
  Scan expected;
  int offset = start;
  while (expected.bearings.size() < count) {
    expected.bearings.push_back((left + offset) % 6400);
    expected.codes.push_back(offset == 0 ? 1 : offset == width ? 2 : 0);
    if ((right && offset == width) || (!right && offset == 0)) {
      right = !right;
    }
    offset = right ? std::min(offset + step, width) : std::max(offset - step, 0);
  }
  return expected;
}

TEST(SectorScan, OfTheRosDriverTurnsAtBothLimits) {
  Bench bench;
  bench.make_ready(sector(2666, 3733, 16));
  const Scan result = scan(bench, 200);
  const Scan expected = expected_sector(2666, 1067, 16, 534, true, 200);
  EXPECT_EQ(result.bearings, expected.bearings);
  EXPECT_EQ(result.codes, expected.codes);
  // By hand: 33 whole steps from 3200 to 3728, a step clamped to 3733, then back.
  EXPECT_EQ(result.bearings[33], 3728);
  EXPECT_EQ(result.bearings[34], 3733);
  EXPECT_EQ(result.codes[34], 2);
  EXPECT_EQ(result.bearings[35], 3717);
  EXPECT_EQ(result.bearings[34 + 67], 2666);
  EXPECT_EQ(result.codes[34 + 67], 1);
}

TEST(SectorScan, Of90DegreesInWholeStepsHas51BearingsEachWay) {
  Bench bench;
  HeadCommand command = sector(2400, 4000, 32);
  command.control = 0x2301;  // to the left first
  bench.make_ready(command);
  const Scan result = scan(bench, 126);
  EXPECT_EQ(result.bearings[25], 2400);
  EXPECT_EQ(result.codes[25], 1);
  EXPECT_EQ(result.bearings[75], 4000);
  EXPECT_EQ(result.codes[75], 2);
  EXPECT_EQ(result.bearings[125], 2400);
  EXPECT_EQ(std::ranges::count(result.codes, 0), 123);
}

TEST(SectorScan, MayCrossAstern) {
  Bench bench;
  bench.make_ready(sector(5600, 800, 64));
  const Scan result = scan(bench, 100);
  // 3200 is as far from one limit as from the other, and the head goes to the left one.
  const Scan expected = expected_sector(5600, 1600, 64, 0, true, 100);
  EXPECT_EQ(result.bearings, expected.bearings);
  EXPECT_EQ(result.codes, expected.codes);
  EXPECT_EQ(result.bearings[13], 32) << "past 6368, across astern";
}

TEST(SectorScan, LeftBeyondRightMayMeanThatTheyWereConfused) {
  DeviceConfig config;
  config.limits_order = LimitsOrder::swapped;
  Bench bench(config);
  bench.make_ready(sector(4000, 2400, 32));
  const auto lines = bench.scan(120);
  const Scan expected = expected_sector(2400, 1600, 32, 800, true, 120);
  EXPECT_EQ(bearings_of(lines), expected.bearings);
  EXPECT_EQ(lines[0].left_limit, 4000) << "echoed as they came";
  EXPECT_EQ(lines[0].right_limit, 2400);
}

TEST(SectorScan, HeadOutsideGoesToTheNearerLimit) {
  for (const auto& [left, right, first] : {std::tuple{3600, 4400, 3600}, std::tuple{1600, 2400, 2400}}) {
    Bench bench;
    bench.make_ready(sector(static_cast<std::uint16_t>(left), static_cast<std::uint16_t>(right)));
    EXPECT_EQ(scan(bench, 1).bearings, Bearings{first});
  }
}

TEST(SectorScan, EnteredAtALimitOutwardTurnsAtOnce) {
  Bench bench;
  HeadCommand command = sector(3600, 4400, 100);
  command.control = 0x2301;
  bench.make_ready(command);
  const Scan result = scan(bench, 3);
  EXPECT_EQ(result.bearings, (Bearings{3600, 3700, 3800}));
  EXPECT_EQ(result.codes, (std::vector<int>{1, 0, 0}));
}

TEST(SectorScan, NarrowerThanAStepGoesFromLimitToLimit) {
  Bench bench;
  bench.make_ready(sector(3190, 3210, 128));
  EXPECT_EQ(scan(bench, 5).bearings, (Bearings{3200, 3210, 3190, 3210, 3190}));
}

TEST(SectorScan, Limit6400Is0) {
  Bench bench;
  bench.make_ready(sector(4800, 6400, 255));
  const auto lines = bench.scan(9);
  EXPECT_EQ(bearings_of(lines), (Bearings{4800, 5055, 5310, 5565, 5820, 6075, 6330, 0, 6145}));
  EXPECT_EQ(lines[7].sweep, SweepCode::right_limit);
  EXPECT_EQ(lines[7].right_limit, 6400);
}

TEST(StillHead, StaresAtTheLeftLimit) {
  HeadCommand stare = sector(2000, 4000);
  stare.control |= control_bits::stare;
  HeadCommand no_width = sector(2000, 2000);
  HeadCommand continuous_stare = all_round();
  continuous_stare.left_limit = 2000;
  continuous_stare.control |= control_bits::stare;
  for (const HeadCommand& command : {stare, no_width, continuous_stare}) {
    Bench bench;
    bench.make_ready(command);
    const Scan result = scan(bench, 4);
    EXPECT_EQ(result.bearings, (Bearings{2000, 2000, 2000, 2000}));
    EXPECT_EQ(result.codes, (std::vector<int>{0, 0, 0, 0}));
  }
}

TEST(StillHead, DoesNotTurnWithItsMotorOff) {
  Bench bench;
  HeadCommand command = sector(1000, 2000);
  command.control |= control_bits::motor_off;
  bench.make_ready(command);
  EXPECT_EQ(scan(bench, 3).bearings, (Bearings{3200, 3200, 3200}));
}

TEST(Reverse, TakesEffectFromTheNextStepAndShowsInTheControlBits) {
  Bench bench;
  bench.make_ready(all_round(32));
  EXPECT_EQ(scan(bench, 3).bearings, (Bearings{3200, 3232, 3264}));
  bench.run_for(1s);  // the lines still owed
  const int last = bench.all<HeadData>().back().second.bearing;
  bench.raw(fixture("reverse"));
  const auto lines = bench.scan(4);
  EXPECT_EQ(bearings_of(lines), (Bearings{last + 32, last, last - 32, last - 64}))
      << "the step after the last line was already made";
  EXPECT_EQ(lines[0].control, 0x2303);
  bench.raw(fixture("reverse"));
  bench.run_for(1s);
  EXPECT_EQ(bench.scan(1)[0].control, 0x2307);
}

TEST(Reverse, ControlBitsStayAsCommandedWhenASectorTurnsByItself) {
  Bench bench;
  bench.make_ready(sector(3100, 3300, 50));
  for (const HeadData& line : bench.scan(20)) {
    EXPECT_EQ(line.control, 0x2305);
  }
}

TEST(Reverse, HeadMayClaimToScanRightAlways) {
  DeviceConfig config;
  config.always_reports_scan_right = true;
  Bench bench(config);
  bench.make_ready(all_round(32, false));
  const auto lines = bench.scan(2);
  EXPECT_EQ(bearings_of(lines), (Bearings{3200, 3168}));
  EXPECT_EQ(lines[0].control, 0x2307);
}

TEST(Invert, BearingInTheVehicleIsMirroredWhenMountingAndBitDisagree) {
  for (const bool inverted : {false, true}) {
    for (const bool bit : {false, true}) {
      DeviceConfig config;
      config.mounted_inverted = inverted;
      Bench bench(config);
      HeadCommand command = sector(4800, 4800);
      command.control |= bit ? control_bits::invert : std::uint16_t{0};
      bench.make_ready(command);
      EXPECT_EQ(bench.scan(1)[0].bearing, 4800);
      const double starboard = std::numbers::pi / 2;
      EXPECT_DOUBLE_EQ(bench.jobs[0].bearing_rad, inverted == bit ? starboard : -starboard);
    }
  }
}

}  // namespace
}  // namespace sonard::micron
