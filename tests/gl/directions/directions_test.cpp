// SPDX-License-Identifier: Apache-2.0
// Ranges of a sonar that measures directions, against closed forms: planes, a sphere, and what lies behind an
// edge.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>

#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::test {
namespace {

using render::DirectionEchoes;
using render::DirectionGrid;

constexpr double wire_step_m = 0.0015;

/// A grid as of a sonar of 90 by 40 degrees.
DirectionGrid wide_grid() {
  DirectionGrid grid;
  grid.columns = 256;
  grid.rows = 64;
  grid.azimuth_fov_rad = 90 * degree;
  grid.elevation_fov_rad = 40 * degree;
  grid.azimuth_beamwidth_rad = 0.85 * degree;
  grid.elevation_beamwidth_rad = 1.6 * degree;
  return grid;
}

render::PingRequest request_of(const DirectionGrid& grid, double range_m = 15) {
  render::PingRequest request;
  request.settings.directions = grid;
  request.settings.aperture = direction_aperture(grid);
  request.settings.range.step_m = 0.01;
  request.settings.range.count = static_cast<int>(std::lround(range_m / request.settings.range.step_m));
  return request;
}

/// Range of a surface in a direction; nullopt: the direction misses it.
using Truth = std::function<std::optional<double>(double azimuth_rad, double elevation_rad)>;

glm::dvec3 unit(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

/// The plane of points p with normal . p = distance.
Truth plane(const glm::dvec3& normal, double distance_m) {
  return [=](double azimuth_rad, double elevation_rad) -> std::optional<double> {
    const double along = glm::dot(normal, unit(azimuth_rad, elevation_rad));
    return along * distance_m <= 0 ? std::nullopt : std::optional(distance_m / along);
  };
}

Truth sphere(const glm::dvec3& centre_m, double radius_m) {
  return [=](double azimuth_rad, double elevation_rad) -> std::optional<double> {
    const double along = glm::dot(centre_m, unit(azimuth_rad, elevation_rad));
    const double root = along * along - glm::dot(centre_m, centre_m) + radius_m * radius_m;
    return root <= 0 ? std::nullopt : std::optional(along - std::sqrt(root));
  };
}

struct Ranges {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  bool whole = true;  ///< every direction meets the surface
};

/// The ranges that a beam sees within `width` beamwidths.
Ranges within_beam(const Truth& truth, const DirectionGrid& grid, double azimuth_rad, double elevation_rad,
                   double width) {
  Ranges ranges;
  for (int i = -4; i <= 4; ++i) {
    for (int j = -4; j <= 4; ++j) {
      const auto range = truth(azimuth_rad + width * grid.azimuth_beamwidth_rad * i / 8,
                               elevation_rad + width * grid.elevation_beamwidth_rad * j / 8);
      ranges.whole = ranges.whole && range;
      ranges.low = std::min(ranges.low, range.value_or(ranges.low));
      ranges.high = std::max(ranges.high, range.value_or(ranges.high));
    }
  }
  return ranges;
}

class Directions : public EngineTest {
 protected:
  static DirectionEchoes render(const render::World& world, const render::PingRequest& request) {
    render::SonarRenderer renderer(world, options());
    return renderer.render_directions(request);
  }

  /// Tests beams that see nothing but this surface. The range of a beam must be the one on its axis, within a
  /// step of the wire and a fifth of the ranges within its -3 dB width.
  static void expect_ranges(const DirectionEchoes& echoes, const DirectionGrid& grid, const Truth& truth,
                            double range_m, int at_least) {
    int tested = 0;
    double worst = 0;
    for (int row = 0; row < grid.rows; ++row) {
      for (int column = 0; column < grid.columns; ++column) {
        const double azimuth = grid.azimuth_rad(column), elevation = grid.elevation_rad(row);
        const Ranges seen =
            within_beam(truth, grid, azimuth, elevation, 2 * render::direction_reach_beamwidths);
        if (!seen.whole || seen.high > range_m) {
          continue;
        }
        ++tested;
        const Ranges half = within_beam(truth, grid, azimuth, elevation, 1);
        const double allowed = wire_step_m + (half.high - half.low) / 5;
        const auto pixel = static_cast<std::size_t>(row * grid.columns + column);
        const double error = static_cast<double>(echoes.range_m[pixel]) - *truth(azimuth, elevation);
        worst = std::max(worst, std::abs(error) / allowed);
        ASSERT_LE(std::abs(error), allowed) << "column " << column << ", row " << row << ": "
                                            << echoes.range_m[pixel] << " m, spread " << half.high - half.low;
        ASSERT_GT(echoes.intensity[pixel], 0.0F);
      }
    }
    std::printf("%d beams, worst error %.2f of what is allowed\n", tested, worst);
    EXPECT_GE(tested, at_least);
  }
};

INSTANTIATE_TEST_SUITE_P(Engines, Directions, all_engines(), engine_name);

TEST_P(Directions, WallAcrossTheAxis) {
  const DirectionGrid grid = wide_grid();
  const auto echoes = render(
      make_world({make_body("wall", make_quad({6, -40, -40}, {0, 80, 0}, {0, 0, 80}))}), request_of(grid));
  expect_ranges(echoes, grid, plane({1, 0, 0}, 6), 15, 256 * 64);
}

TEST_P(Directions, ObliqueWall) {
  const DirectionGrid grid = wide_grid();
  const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 0.6, 0.3));
  const glm::dvec3 a = glm::normalize(glm::cross(normal, glm::dvec3(0, 0, 1))), b = glm::cross(normal, a);
  const auto echoes = render(
      make_world({make_body("wall", make_quad(5.0 * normal - 60.0 * a - 60.0 * b, 120.0 * a, 120.0 * b))}),
      request_of(grid));
  expect_ranges(echoes, grid, plane(normal, 5), 15, 10000);
}

TEST_P(Directions, BedBelow) {
  const DirectionGrid grid = wide_grid();
  const auto echoes =
      render(make_world({make_body("bed", make_quad({-60, -60, -1.5}, {120, 0, 0}, {0, 120, 0}))}),
             request_of(grid));
  expect_ranges(echoes, grid, plane({0, 0, -1}, 1.5), 14, 4000);
}

TEST_P(Directions, Sphere) {
  const DirectionGrid grid = wide_grid();
  render::Body ball = make_body("ball", make_sphere(1.5F, 160));
  ball.T_world_body.position_m = {6, 1, 0.4};
  const auto echoes = render(make_world({ball}), request_of(grid));
  expect_ranges(echoes, grid, sphere({6, 1, 0.4}, 1.5), 15, 1000);
}

TEST_P(Directions, BehindAnEdgeIsTheOneOrTheOther) {
  const DirectionGrid grid = wide_grid();
  const auto echoes = render(make_world({make_body("near", make_quad({5, 0, -20}, {0, 20, 0}, {0, 0, 40})),
                                         make_body("far", make_quad({9, -40, -40}, {0, 80, 0}, {0, 0, 80}))}),
                             request_of(grid));
  const Truth near = plane({1, 0, 0}, 5), far = plane({1, 0, 0}, 9);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const double azimuth = grid.azimuth_rad(column), elevation = grid.elevation_rad(row);
      const auto range =
          static_cast<double>(echoes.range_m[static_cast<std::size_t>(row * grid.columns + column)]);
      const auto is_of = [&](const Truth& truth) {
        const Ranges seen =
            within_beam(truth, grid, azimuth, elevation, 2 * render::direction_reach_beamwidths);
        return range > seen.low - wire_step_m && range < seen.high + wire_step_m;
      };
      ASSERT_TRUE(is_of(near) || is_of(far))
          << "column " << column << ", row " << row << ": " << range << " m";
      if (std::abs(azimuth) > grid.azimuth_beamwidth_rad) {
        ASSERT_TRUE(is_of(azimuth > 0 ? near : far)) << "column " << column << ", row " << row;
      }
    }
  }
}

TEST_P(Directions, ColumnsRunToStarboardAndRowsUp) {
  const DirectionGrid grid = wide_grid();
  render::Body ball = make_body("ball", make_sphere(0.2F, 40));
  ball.T_world_body.position_m = 8.0 * unit(-20 * degree, 10 * degree);
  const auto echoes = render(make_world({ball}), request_of(grid));
  const auto strongest =
      std::max_element(echoes.intensity.begin(), echoes.intensity.end()) - echoes.intensity.begin();
  EXPECT_NEAR(static_cast<double>(strongest % grid.columns), (20.0 + 45) / 90 * 255, 1.0);
  EXPECT_NEAR(static_cast<double>(strongest / grid.columns), (10.0 + 20) / 40 * 63, 1.0);
  // The echo of the ball begins at 7.8 m. Its strongest part is one range resolution long, two bins.
  EXPECT_NEAR(static_cast<double>(echoes.range_m[static_cast<std::size_t>(strongest)]), 7.8 + 0.01, 0.01);
}

TEST_P(Directions, NothingIsZeroInBothImages) {
  const DirectionGrid grid = wide_grid();
  render::Body ball = make_body("ball", make_sphere(0.5F, 40));
  ball.T_world_body.position_m = {6, 0, 0};
  const auto echoes = render(make_world({ball}), request_of(grid));
  int echoing = 0;
  for (std::size_t i = 0; i < echoes.range_m.size(); ++i) {
    ASSERT_EQ(echoes.range_m[i] > 0, echoes.intensity[i] > 0);
    echoing += echoes.range_m[i] > 0 ? 1 : 0;
  }
  EXPECT_GT(echoing, 100);
  EXPECT_LT(echoing, 2000);
}

TEST_P(Directions, EchoesBeforeTheNearestRangeAreLeftOut) {
  DirectionGrid grid = wide_grid();
  grid.nearest_m = 2;
  const render::World world =
      make_world({make_body("pane", make_quad({1.2, -0.1, -0.1}, {0, 0.2, 0}, {0, 0, 0.2})),
                  make_body("wall", make_quad({6, -40, -40}, {0, 80, 0}, {0, 0, 80}))});
  const auto echoes = render(world, request_of(grid));
  for (const float range_m : echoes.range_m) {
    ASSERT_TRUE(range_m == 0 || range_m > 2.0F) << range_m;
  }
}

TEST_P(Directions, RepeatsAreEqualToTheBit) {
  render::Body ball = make_body("ball", make_sphere(1.0F, 60));
  ball.T_world_body.position_m = {5, -1, 0};
  const render::World world =
      make_world({ball, make_body("bed", make_quad({-30, -30, -2}, {60, 0, 0}, {0, 60, 0}))});
  const auto first = render(world, request_of(wide_grid()));
  const auto second = render(world, request_of(wide_grid()));
  EXPECT_EQ(first.range_m, second.range_m);
  EXPECT_EQ(first.intensity, second.intensity);
}

TEST_P(Directions, APingHasTheImageOrTheDirectionsThatItAsksFor) {
  render::SonarRenderer renderer(
      make_world({make_body("wall", make_quad({6, -40, -40}, {0, 80, 0}, {0, 0, 80}))}), options());
  const render::PingRequest directions = request_of(wide_grid());
  render::PingRequest fan = directions;
  fan.settings.directions = {};
  EXPECT_FALSE(renderer.render_echo(fan).intensity.empty());
  EXPECT_TRUE(renderer.render_echo(directions).intensity.empty());
  EXPECT_FALSE(renderer.render_directions(directions).range_m.empty());
  EXPECT_TRUE(renderer.render_directions(fan).range_m.empty());
}

TEST_P(Directions, UnusableGridsAreRefused) {
  const render::World world = make_world({make_body("wall", make_quad({6, -1, -1}, {0, 2, 0}, {0, 0, 2}))});
  render::SonarRenderer renderer(world, options());
  for (const auto& spoil : std::initializer_list<std::function<void(DirectionGrid&)>>{
           [](DirectionGrid& grid) { grid.columns = 1; }, [](DirectionGrid& grid) { grid.rows = 5000; },
           [](DirectionGrid& grid) { grid.elevation_fov_rad = 170 * degree; },
           [](DirectionGrid& grid) { grid.azimuth_beamwidth_rad = 0; },
           [](DirectionGrid& grid) { grid.nearest_m = std::nan(""); }}) {
    render::PingRequest request = request_of(wide_grid());
    spoil(request.settings.directions);
    EXPECT_THROW(renderer.render_directions(request), render::RequestError);
  }
}

}  // namespace
}  // namespace sonard::test
