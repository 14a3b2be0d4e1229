// SPDX-License-Identifier: Apache-2.0
#include "renderer/sample_grid/sample_grid.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "renderer/errors.hpp"
#include "tests/support/degree.hpp"

namespace sonard::render {
namespace {

Aperture gemini_like() {
  Aperture aperture;
  aperture.beam_edges_rad = equal_sine_edges(256, 60 * degree);
  return aperture;
}

double beam_solid_angle(const SampleGrid& grid, int beam) {
  double sum = 0;
  for (int p = grid.beam_parts[static_cast<std::size_t>(beam)];
       p < grid.beam_parts[static_cast<std::size_t>(beam) + 1]; ++p) {
    const ColumnPart& part = grid.parts[static_cast<std::size_t>(p)];
    for (int row = part.row_begin; row < part.row_end; ++row) {
      sum += static_cast<double>(grid.weight(part, row));
    }
  }
  return sum;
}

// A fan of azimuth width dpsi between elevations -t and t covers dpsi * 2 sin t steradians.
TEST(SampleGrid, EveryBeamHasItsSolidAngle) {
  const Aperture aperture = gemini_like();
  for (const int views : {1, 3, 4}) {
    Sampling sampling;
    sampling.views = views;
    const SampleGrid grid = make_sample_grid(aperture, sampling);
    for (int beam = 0; beam < 256; ++beam) {
      const auto b = static_cast<std::size_t>(beam);
      const double width = aperture.beam_edges_rad[b] - aperture.beam_edges_rad[b + 1];
      EXPECT_NEAR(beam_solid_angle(grid, beam) / (width * 2 * std::sin(10 * degree)), 1.0, 1e-4)
          << "beam " << beam;
    }
  }
}

TEST(SampleGrid, BeamsRunFromPortToStarboard) {
  const SampleGrid grid = make_sample_grid(gemini_like(), Sampling{});
  ASSERT_EQ(grid.views.size(), 3U);
  EXPECT_GT(grid.views.front().azimuth_rad, 0.0);
  EXPECT_EQ(grid.parts.front().view, 0);
  EXPECT_EQ(grid.parts.front().column, 0);
  EXPECT_EQ(grid.parts.back().view, 2);
  EXPECT_EQ(grid.parts.back().column, 255);
}

TEST(SampleGrid, FullTurnIsSplitIntoViewsOfAtMostSixtyDegrees) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_angle_edges(360, 360 * degree);
  Sampling sampling;
  sampling.views = 1;
  const SampleGrid grid = make_sample_grid(aperture, sampling);
  EXPECT_EQ(grid.views.size(), 6U);
  EXPECT_NEAR(beam_solid_angle(grid, 0), beam_solid_angle(grid, 359), 1e-9);
}

// docs/physics.md 1.2 A7: whole columns on one 120 degree view leave centre beams empty below 424 columns.
TEST(SampleGrid, WholeColumnsTooFewForTheCentreBeamsAreRefused) {
  Aperture aperture;
  aperture.beam_edges_rad = equal_angle_edges(256, 120 * degree);
  Sampling sampling = Sampling::of_grid(1, 400, 512);
  const GridOptions paper{true, false};
  EXPECT_THROW(make_sample_grid(aperture, sampling, paper), RequestError);
  sampling.columns_per_view = 424;
  EXPECT_NO_THROW(make_sample_grid(aperture, sampling, paper));
}

TEST(SampleGrid, NonsenseIsRefused) {
  Aperture aperture = gemini_like();
  EXPECT_THROW(make_sample_grid(Aperture{}, Sampling{}), RequestError);
  EXPECT_THROW(make_sample_grid(aperture, Sampling::of_grid(0, 1, 1)), RequestError);
  EXPECT_THROW(make_sample_grid(aperture, Sampling::of_grid(1, 1, 1 << 20)), RequestError);
  aperture.beam_edges_rad[7] = NAN;
  EXPECT_THROW(make_sample_grid(aperture, Sampling{}), RequestError);
  aperture = gemini_like();
  std::swap(aperture.beam_edges_rad[3], aperture.beam_edges_rad[4]);
  EXPECT_THROW(make_sample_grid(aperture, Sampling{}), RequestError);
}

// docs/physics.md 2.5, for a 20 degree beam.
TEST(Aperture, SincPatternHasTheDocumentedLevels) {
  Aperture aperture;
  aperture.elevation = Aperture::Elevation::sinc;
  const auto level_db = [&](double angle_deg) {
    return 10 * std::log10(aperture.elevation_weight(angle_deg * degree));
  };
  EXPECT_NEAR(level_db(0), 0.0, 1e-12);
  EXPECT_NEAR(level_db(5), -0.7, 0.05);
  EXPECT_NEAR(level_db(10), -3.0, 0.05);
  EXPECT_NEAR(level_db(15), -7.5, 0.1);
  EXPECT_NEAR(level_db(20), -16.9, 0.1);
  EXPECT_NEAR(level_db(30), -14.4, 0.1);
  EXPECT_NEAR(aperture.elevation_limit_rad(), 25 * degree, 1e-12);
}

TEST(Aperture, TwoWayPatternIsTheSquareOfTheOneWay) {
  Aperture one_way, two_way;
  one_way.elevation = Aperture::Elevation::sinc;
  two_way.elevation = Aperture::Elevation::sinc_two_way;
  one_way.vertical_beamwidth_rad = two_way.vertical_beamwidth_rad = 35 * degree;  // of a Micron
  for (const double angle_deg : {-40.0, 0.0, 3.0, 17.5, 35.0, 43.0}) {
    const double one = one_way.elevation_weight(angle_deg * degree);
    EXPECT_NEAR(two_way.elevation_weight(angle_deg * degree), one * one, 1e-15) << angle_deg;
  }
  EXPECT_NEAR(10 * std::log10(two_way.elevation_weight(17.5 * degree)), -6.0, 0.1);
  EXPECT_EQ(two_way.elevation_limit_rad(), one_way.elevation_limit_rad());
}

// Beyond some 70 degrees the first null is behind the vertical.
TEST(Aperture, PatternOfAWideBeamIsFollowedClearOfTheVertical) {
  Aperture aperture;
  aperture.beam_edges_rad = {0.1, -0.1};
  aperture.elevation = Aperture::Elevation::sinc;
  for (const double width_deg : {60.0, 64.0, 100.0, 165.0}) {
    aperture.vertical_beamwidth_rad = width_deg * degree;
    EXPECT_NO_THROW(check_aperture(aperture)) << width_deg;
    EXPECT_GE(aperture.elevation_limit_rad(), width_deg / 2 * degree);
    EXPECT_LE(aperture.elevation_limit_rad(), std::max(80.0, width_deg / 2) * degree + 1e-12);
  }
}

}  // namespace
}  // namespace sonard::render
