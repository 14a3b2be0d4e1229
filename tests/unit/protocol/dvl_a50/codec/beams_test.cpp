// SPDX-License-Identifier: Apache-2.0
// The model of the beams against a report of a real device, and against closed forms.
#include "protocol/dvl_a50/beams.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "protocol/dvl_a50/measurement.hpp"

namespace sonard::dvl_a50 {
namespace {

/// Of release 2.7.2 at rest; the device had thrown out beam 2.
constexpr Vector real_velocity{0.00046143701, -0.00018614993, -0.00002498543};
constexpr std::array real_beams{-0.00019833934, -0.00009753491, -0.00617350964, 0.00005143248};
constexpr Matrix real_covariance{{{2.896e-10, -1.323e-10, 4.608e-11},
                                  {-1.323e-10, 4.011e-10, -7.873e-11},
                                  {4.608e-11, -7.873e-11, 3.656e-11}}};

std::array<Beam, 4> beams_of(const Vector& velocity_mps) {
  std::array<Beam, 4> beams{};
  for (std::size_t i = 0; i < 4; ++i) {
    beams[i] = {static_cast<int>(i), dot(beam_directions[i], velocity_mps), 2.183, 0, 0, true};
  }
  return beams;
}

TEST(DvlBeams, VelocitiesAreThoseOfARealReport) {
  for (const std::size_t beam : {0U, 1U, 3U}) {
    EXPECT_NEAR(dot(beam_directions[beam], real_velocity), real_beams[beam], 5e-8) << beam;
  }
  std::array<Beam, 4> beams = beams_of({});
  for (std::size_t i = 0; i < 4; ++i) {
    beams[i].velocity_mps = real_beams[i];
    beams[i].valid = i != 2;
  }
  const auto solution = solve(beams, 1.0);
  ASSERT_TRUE(solution);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(solution->velocity_mps[axis], real_velocity[axis], 2e-7) << axis;
  }
}

TEST(DvlBeams, AltitudeAndFigureOfMeritAreThoseOfARealReport) {
  std::array<Beam, 4> beams{};
  constexpr std::array distances_m{195 * 0.0118, 225 * 0.0118, 196 * 0.0118, 213 * 0.0118};
  for (std::size_t i = 0; i < 4; ++i) {
    beams[i].distance_m = distances_m[i];
  }
  EXPECT_NEAR(*altitude_m(beams, -0.015), 2.244393826, 1e-6);
  EXPECT_NEAR(figure_of_merit(real_covariance), 2.25062e-5, 1e-8);
}

TEST(DvlBeams, LeastSquaresOfFourBeamsHaveAClosedForm) {
  const Vector velocity_mps{0.5, -0.2, 0.05};
  const auto solution = solve(beams_of(velocity_mps), 2e-3);
  ASSERT_TRUE(solution);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(solution->velocity_mps[axis], velocity_mps[axis], 1e-14);
  }
  EXPECT_NEAR(solution->covariance[0][0] / 4e-6, 3.414214, 1e-6);
  EXPECT_NEAR(solution->covariance[1][1] / 4e-6, 3.414214, 1e-6);
  EXPECT_NEAR(solution->covariance[2][2] / 4e-6, 0.292893, 1e-6);
  EXPECT_NEAR(solution->covariance[0][1], 0.0, 1e-18);
  EXPECT_NEAR(figure_of_merit(solution->covariance), 2e-3 * std::sqrt(3.414214), 1e-9);
}

TEST(DvlBeams, ThreeAreEnoughAndTwoAreNot) {
  const Vector velocity_mps{-1.0, 0.3, 0.2};
  for (std::size_t blocked = 0; blocked < 4; ++blocked) {
    std::array<Beam, 4> beams = beams_of(velocity_mps);
    beams[blocked] = {.velocity_mps = 99.0};
    const auto solution = solve(beams, 1e-3);
    ASSERT_TRUE(solution);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(solution->velocity_mps[axis], velocity_mps[axis], 1e-12);
    }
    beams[(blocked + 1) % 4].valid = false;
    EXPECT_FALSE(solve(beams, 1e-3));
  }
}

TEST(DvlBeams, ADeviceTurnedClockwiseMovesToItsLeftWhenTheVehicleMovesAhead) {
  const double quarter_rad = std::numbers::pi / 2;
  const Vector ahead = to_vehicle(Vector{0.0, -1.0, 0.5}, quarter_rad);
  EXPECT_NEAR(ahead[0], 1.0, 1e-15);
  EXPECT_NEAR(ahead[1], 0.0, 1e-15);
  EXPECT_EQ(ahead[2], 0.5);
  const Matrix turned = to_vehicle(Matrix{{{4, 1, 0}, {1, 2, 0}, {0, 0, 1}}}, quarter_rad);
  EXPECT_NEAR(turned[0][0], 2.0, 1e-12);
  EXPECT_NEAR(turned[1][1], 4.0, 1e-12);
  EXPECT_NEAR(turned[0][1], -1.0, 1e-12);
}

// The head's axes are x down, y port, z ahead; a direction has the components (cos e cos a, cos e sin a, sin
// e).
TEST(DvlBeams, AreTheCornersOfTheGridOfDirections) {
  const Directions grid = beam_grid();
  DirectionRanges ranges{grid.columns, grid.rows, std::vector<float>(grid.count()), {}};
  for (std::size_t beam = 0; beam < 4; ++beam) {
    const Vector& u = beam_directions[beam];
    const Vector of_head{u[2], -u[1], u[0]};
    const double azimuth_rad = std::atan2(of_head[1], of_head[0]), elevation_rad = std::asin(of_head[2]);
    EXPECT_NEAR(std::abs(azimuth_rad), grid.horizontal_fov_rad / 2, 1e-12);
    EXPECT_NEAR(std::abs(elevation_rad), grid.vertical_fov_rad / 2, 1e-12);
    const int column = azimuth_rad > 0 ? 0 : grid.columns - 1, row = elevation_rad > 0 ? grid.rows - 1 : 0;
    ranges.range_m.at(static_cast<std::size_t>(row * grid.columns + column)) =
        1.0F + static_cast<float>(beam);
  }
  EXPECT_EQ(beam_ranges_m(ranges), (std::array{1.0, 2.0, 3.0, 4.0}));
  ranges.range_m.pop_back();
  EXPECT_EQ(beam_ranges_m(ranges), std::nullopt);
}

TEST(DvlRangeModes, Texts) {
  EXPECT_EQ(parse_range_mode("=3")->first, 3);
  EXPECT_EQ(parse_range_mode("1<=4")->last, 4);
  EXPECT_TRUE(parse_range_mode("wt")->water);
  EXPECT_TRUE(parse_range_mode("2<=2"));
  for (const char* const text : {"", "=5", "3<=1", "AUTO", "1<4", "wt ", "=", "0<=5", "a<=b"}) {
    EXPECT_FALSE(parse_range_mode(text)) << text;
  }
}

TEST(DvlRangeModes, OverlapsAreHysteresis) {
  const RangeModes modes = DeviceConfig{}.range_modes;
  EXPECT_EQ(next_mode(std::nullopt, 0.5, {}, modes), 0);
  EXPECT_EQ(next_mode(1, 0.5, {}, modes), 1);
  EXPECT_EQ(next_mode(1, 0.2, {}, modes), 0);
  EXPECT_EQ(next_mode(0, 0.7, {}, modes), 1);
  EXPECT_EQ(next_mode(3, 20.0, {}, modes), 3);
  EXPECT_EQ(next_mode(4, 20.0, {}, modes), 4);
  EXPECT_EQ(next_mode(3, 20.0, {4, 4}, modes), 4);
  EXPECT_EQ(next_mode(std::nullopt, 20.0, {0, 2}, modes), std::nullopt);
  EXPECT_EQ(next_mode(4, 60.0, {}, modes), std::nullopt);
}

}  // namespace
}  // namespace sonard::dvl_a50
