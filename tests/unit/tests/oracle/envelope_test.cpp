// SPDX-License-Identifier: Apache-2.0
#include "tests/oracle/envelope.hpp"

#include <random>

#include <gtest/gtest.h>

namespace sonard::oracle {

namespace {

Sightline line(double t_begin, double w_begin, double t_end, double w_end) {
  return {t_begin, t_end, w_begin, (w_end - w_begin) / (t_end - t_begin), 0};
}

TEST(OracleEnvelope, NearSegmentHidesTheMiddleOfAFarOne) {
  Envelope envelope;
  const auto& seen = envelope.visible({line(0, 1, 10, 1), line(4, 2, 6, 2)});
  ASSERT_EQ(seen.size(), 3U);
  EXPECT_EQ(seen[0].sightline, 0U);
  EXPECT_EQ(seen[0].t_end, 4);
  EXPECT_EQ(seen[1].sightline, 1U);
  EXPECT_EQ(seen[2].t_begin, 6);
  EXPECT_EQ(seen[2].sightline, 0U);
}

TEST(OracleEnvelope, CrossingSegmentsChangePlacesWhereTheyMeet) {
  Envelope envelope;
  const auto& seen = envelope.visible({line(0, 1, 4, 3), line(0, 2.5, 4, 0.5)});
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].sightline, 1U);
  EXPECT_DOUBLE_EQ(seen[0].t_end, 1.5);  // 1 + t / 2 = 2.5 - t / 2
  EXPECT_EQ(seen[1].sightline, 0U);
}

TEST(OracleEnvelope, OfTwoThatCoincideTheFirstIsSeen) {
  Envelope envelope;
  const auto& seen = envelope.visible({line(0, 1, 4, 2), line(0, 1, 4, 2)});
  ASSERT_EQ(seen.size(), 1U);
  EXPECT_EQ(seen[0].sightline, 0U);
}

TEST(OracleEnvelope, NothingGivesNothing) {
  Envelope envelope;
  EXPECT_TRUE(envelope.visible({}).empty());
}

TEST(OracleEnvelope, RandomSegmentsAsLookingAtEveryOne) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  Envelope envelope;
  for (int round = 0; round < 50; ++round) {
    std::vector<Sightline> lines;
    for (int i = 0; i < 40; ++i) {
      const double begin = unit(random);
      lines.push_back(line(begin, unit(random), begin + 0.02 + 0.3 * unit(random), unit(random)));
    }
    const std::vector<VisiblePiece> seen = envelope.visible(lines);
    for (std::size_t i = 0; i + 1 < seen.size(); ++i) {
      ASSERT_LE(seen[i].t_end, seen[i + 1].t_begin);
    }
    for (int probe = 0; probe < 200; ++probe) {
      const double t = 1.4 * unit(random);
      double nearest = 0;
      for (const Sightline& candidate : lines) {
        nearest = t >= candidate.t_begin && t < candidate.t_end ? std::max(nearest, candidate.closeness(t))
                                                                : nearest;
      }
      double found = 0;
      for (const VisiblePiece& piece : seen) {
        found = t >= piece.t_begin && t < piece.t_end ? lines[piece.sightline].closeness(t) : found;
      }
      ASSERT_NEAR(found, nearest, 1e-12) << "round " << round << ", t " << t;
    }
  }
}

}  // namespace

}  // namespace sonard::oracle
