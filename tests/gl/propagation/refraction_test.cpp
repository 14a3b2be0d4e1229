// SPDX-License-Identifier: Apache-2.0
// Refraction (docs/physics.md 2.12) against the parabola z = x tan(theta) - k x^2, k = g / 2c: the nearest
// point of a flat bed, its echo, and the shadow of a wall.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

constexpr double altitude_m = 5.0;
constexpr double curvature_per_m = 1.2e-3;  // 1.8 m/s per metre at 1500 m/s: a strong thermocline
constexpr double bend_per_m = curvature_per_m / 2;
constexpr double limit_rad = 4 * degree;

TriangleMesh bed_mesh(bool with_normals) {
  TriangleMesh mesh = make_quad({-20, -110, 0}, {150, 0, 0}, {0, 220, 0});
  if (with_normals) {
    mesh.normals.assign(4, {0, 0, 1});
  }
  return mesh;
}

World bed(bool with_normals = false) {
  return make_world({make_body("bed", bed_mesh(with_normals))});
}

/// 5 m above the bed; beam 10 is the middle one.
PingRequest request_of(double pitch_down_rad = 0.0) {
  PingRequest request;
  request.T_world_sonar = {{0, 0, altitude_m}, glm::angleAxis(pitch_down_rad, glm::dvec3(0, 1, 0))};
  request.settings.aperture.beam_edges_rad = equal_angle_edges(21, 21 * degree);
  request.settings.aperture.vertical_beamwidth_rad = 2 * limit_rad;
  request.settings.aperture.azimuth = Aperture::Azimuth::ideal;
  request.settings.aperture.elevation = Aperture::Elevation::top_hat;
  request.settings.range = {2000, 0.05, 0, false};
  request.settings.physical.absorption_db_per_m = 0;
  return request;
}

/// Horizontal distance, m, at which a ray that leaves downwards at the slope `tan_down` has sunk by
/// `depth_m`.
double reach_m(double tan_down, double depth_m, double bend = bend_per_m) {
  return bend == 0 ? depth_m / tan_down
                   : (std::sqrt(tan_down * tan_down + 4 * bend * depth_m) - tan_down) / (2 * bend);
}

double first_range_m(double down_rad, double bend = bend_per_m) {
  return std::hypot(reach_m(std::tan(down_rad), altitude_m, bend), altitude_m);
}

int first_line(const EchoImage& image, int beam) {
  int line = 0;
  while (line < image.bins && image.at(beam, line) == 0.0F) {
    ++line;
  }
  return line;
}

class Refraction : public EngineTest {
 protected:
  static RendererOptions bent(double curvature = curvature_per_m) {
    RendererOptions with = options();
    with.ray_curvature_per_m = curvature;
    return with;
  }
};
INSTANTIATE_TEST_SUITE_P(Propagation, Refraction, all_engines(), engine_name);

TEST_P(Refraction, LowestRayMeetsTheBedWhereItsParabolaDoes) {
  SonarRenderer renderer(bed(), bent());
  const PingRequest request = request_of();
  const EchoImage& image = renderer.render_echo(request);
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::straight_rays), 0u);
  EXPECT_NEAR(first_range_m(limit_rad), 50.28, 0.01) << "and 71.7 m if rays were straight";
  for (const int beam : {0, 10, 20}) {
    EXPECT_NEAR(first_line(image, beam) * 0.05, first_range_m(limit_rad), 0.05) << beam;
  }
}

// Rays bend in the world's vertical at any tilt of the sonar.
TEST_P(Refraction, WorldsVerticalCountsAndNotTheSonars) {
  for (const double pitch : {2.0, 6.0}) {
    SonarRenderer renderer(bed(), bent());
    const EchoImage& image = renderer.render_echo(request_of(pitch * degree));
    EXPECT_NEAR(first_line(image, 10) * 0.05, first_range_m(limit_rad + pitch * degree), 0.05) << pitch;
  }
}

// If the sound speed increases with depth, rays rise.
TEST_P(Refraction, WithTheOtherSignRaysRise) {
  SonarRenderer renderer(bed(), bent(-curvature_per_m));
  PingRequest request = request_of(3 * degree);
  const EchoImage& image = renderer.render_echo(request);
  const double tan_down = std::tan(limit_rad + 3 * degree);
  EXPECT_NEAR(first_line(image, 10) * 0.05,
              std::hypot(reach_m(tan_down, altitude_m, -bend_per_m), altitude_m), 0.05);
}

// On fixed grids, the triangles in Embree's trees and the corners in the shader bend.
TEST_P(Refraction, FixedGridsBendAsWell) {
  SonarRenderer renderer(bed(), bent());
  PingRequest request = request_of();
  request.settings.sampling = Sampling::of_grid(1, 64, 512);
  const EchoImage& image = renderer.render_echo(request);
  EXPECT_NEAR(first_line(image, 10) * 0.05, first_range_m(limit_rad), 0.1);
}

/// Lambert echo of the bed per unit azimuth from [r1, r2), with the spreading of the middle range. The ray to
/// x leaves at tan(theta) = h / x - k x and meets the bed at the slope h / x + k x.
double bed_density(double r1, double r2) {
  constexpr int nodes = 64;
  double sum = 0;
  for (int i = 0; i < nodes; ++i) {
    const double r = r1 + (r2 - r1) * (i + 0.5) / nodes;
    const double x = std::sqrt(r * r - altitude_m * altitude_m);
    const double tan_down = altitude_m / x - bend_per_m * x;
    if (std::abs(std::atan(tan_down)) > limit_rad) {
      continue;
    }
    const double slope = altitude_m / x + bend_per_m * x;
    const double cos_phi = slope / std::hypot(1.0, slope);
    const double cos_theta = 1 / std::hypot(1.0, tan_down);
    // d theta / dx = cos^2 theta d tan / dx, dx / dr = r / x
    const double dtheta_dr = cos_theta * cos_theta * (altitude_m / (x * x) + bend_per_m) * r / x;
    sum += cos_phi * cos_theta * dtheta_dr * (r2 - r1) / nodes;
  }
  const double middle = (r1 + r2) / 2;
  return sum / (middle * middle);
}

// With vertex normals and with facet normals, which bend with the facets.
TEST_P(Refraction, EchoOfTheBedIsThatOfTheBentRays) {
  for (const bool with_normals : {false, true}) {
    RendererOptions with = bent();
    with.skip.turn_off(SkipRule::geometric_normals);
    SonarRenderer renderer(bed(with_normals), with);
    const EchoImage& image = renderer.render_echo(request_of());
    double error = 0;
    int lines = 0;
    for (int line = first_line(image, 10) + 2; line < 1990; ++line) {
      const double truth = bed_density(line * 0.05, (line + 1) * 0.05) * degree;
      error += std::pow(static_cast<double>(image.at(10, line)) / truth - 1, 2);
      ++lines;
    }
    EXPECT_GT(lines, 900);
    EXPECT_LT(std::sqrt(error / lines), 0.01) << with_normals;
  }
}

// A wall of height H at x shadows the bed up to the point where the ray over its top lands.
TEST_P(Refraction, ShadowOfAWallEndsWhereTheRayOverItsTopLands) {
  constexpr double x = 60.0;
  constexpr double height = 1.0;
  World world = bed();
  world.bodies.push_back(make_body("wall", make_quad({x, -40, 0}, {0, 80, 0}, {0, 0, height})));
  SonarRenderer renderer(world, bent());
  const EchoImage& image = renderer.render_echo(request_of());
  const double tan_over = (altitude_m - height) / x - bend_per_m * x;
  const double end_m = std::hypot(reach_m(tan_over, altitude_m), altitude_m);
  EXPECT_NEAR(end_m, 69.4, 0.1) << "and 75.2 m if rays were straight";
  const double base_m = std::hypot(x, altitude_m);
  const int after = static_cast<int>(end_m / 0.05) + 3;
  const float behind = image.at(10, after);
  EXPECT_NEAR(static_cast<double>(behind) / (bed_density(after * 0.05, (after + 1) * 0.05) * degree), 1,
              0.05);
  // The edge lies at half of `behind`, to one line (docs/accuracy.md). The four lines before it may hold up
  // to 3 %.
  const float early = 0.03F;
  const int edge = static_cast<int>(end_m / 0.05);
  EXPECT_GT(image.at(10, edge + 1), 0.5F * behind);
  for (int line = static_cast<int>(base_m / 0.05) + 2; line < edge; ++line) {
    ASSERT_LT(image.at(10, line), (line < edge - 4 ? 1e-3F : early) * behind) << line * 0.05;
  }
}

// SkipRule::straight_rays: on against off.
using StraightRays = Refraction;
INSTANTIATE_TEST_SUITE_P(Skipping, StraightRays, all_engines(), engine_name);

TEST_P(StraightRays, SkipsBendsOfLessThanAQuarterOfTheBeamWithinItsBound) {
  // k R = 0.24 theta3 at 100 m, just below the limit of 0.25.
  const double curvature = 2 * 0.24 * (2 * limit_rad) / 100;
  RendererOptions off_options = bent(curvature);
  off_options.skip.turn_off(SkipRule::straight_rays);
  SonarRenderer renderer(bed(), bent(curvature));
  SonarRenderer off(bed(), off_options);
  const PingRequest request = request_of();
  const double on_m = first_line(renderer.render_echo(request), 10) * 0.05;
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::straight_rays), 1u);
  const double off_m = first_line(off.render_echo(request), 10) * 0.05;
  EXPECT_EQ(off.last_statistics().skipped.of(SkipRule::straight_rays), 0u);
  EXPECT_NEAR(on_m, first_range_m(limit_rad, 0), 0.05);
  EXPECT_NEAR(off_m, first_range_m(limit_rad, curvature / 2), 0.05);
  // Both are the lowest ray; the rule's error is the difference of their elevations.
  const double apart_rad =
      limit_rad - std::asin(altitude_m / on_m) + std::asin(altitude_m / off_m) - limit_rad;
  EXPECT_GT(apart_rad, 0);
  EXPECT_LE(apart_rad / (2 * limit_rad), entry_of(SkipRule::straight_rays).bound);
}

TEST_P(StraightRays, AreAllThereIsWithoutAGradientAndInModePaper) {
  SonarRenderer straight(bed(), options());
  const double expected = first_range_m(limit_rad, 0);
  EXPECT_NEAR(first_line(straight.render_echo(request_of()), 10) * 0.05, expected, 0.05);
  EXPECT_EQ(straight.last_statistics().skipped.of(SkipRule::straight_rays), 0u);
  SonarRenderer renderer(bed(), bent());
  PingRequest request = request_of();
  request.settings.model = Model::paper;
  request.settings.paper.sigmoid_centre = 0.05;
  EXPECT_NEAR(first_line(renderer.render_echo(request), 10) * 0.05, expected, 0.05);
}

}  // namespace
}  // namespace sonard::render
