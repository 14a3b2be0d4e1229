// SPDX-License-Identifier: Apache-2.0
// The two integrators share the echo law only. For a bed that shadows itself, with objects on it, they must
// agree, and each must know its own error.
#include <vector>

#include <gtest/gtest.h>

#include "tests/oracle/bvh.hpp"
#include "tests/oracle/ray_integrator.hpp"
#include "tests/oracle/slice_integrator.hpp"
#include "tests/scenes/bed.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/degree.hpp"
#include "tests/unit/tests/oracle/small_worlds.hpp"

namespace sonard::oracle {

namespace {

/// 3 m above a rippled bed, with a ball, a block and a pole on it, looking 20 degrees down.
class OracleAgreement : public testing::Test {
 protected:
  render::World world_ = world_of({test::make_bed({2, 14, -3, 3}, 60, 30, test::ripple_height_m),
                                   test::make_ball({7, 0.3, 0.3}, 0.4, 24, 12),
                                   test::make_block({8.5, -0.6, 0.3}, {0.6, 0.5, 0.9}, 0.4),
                                   test::make_tube({6, -0.3, -0.5}, {6, -0.3, 1.0}, 0.03, 12, 2)});
  render::Pose T_world_sonar_{{0, 0, 3}, glm::angleAxis(20 * degree, glm::dvec3(0, 1, 0))};
  render::SonarSettings settings_ = ping(16, 12 * degree, 16 * degree, 300, 12);
  EchoLaw law_{settings_};
  Facets facets_{world_, T_world_sonar_, law_};
  EchoTruth exact_ = integrate_slices(facets_, law_, fine());

  static SliceOptions fine() {
    SliceOptions options;
    options.error_rms = 2e-5;
    options.error_max = 4e-4;
    return options;
  }
};

TEST_F(OracleAgreement, RaysWithFootprints) {
  RayOptions options;
  options.rows = 256;
  options.doublings = 2;
  const EchoTruth rays = integrate_rays(Bvh(facets_), law_, options);
  const RelativeError apart = difference(rays, exact_);
  EXPECT_LT(apart.rms, 2e-3);
  EXPECT_LT(apart.rms, estimated_error(rays).rms + estimated_error(exact_).rms);
  EXPECT_NEAR(total(rays) / total(exact_), 1.0, 2e-5);
}

TEST_F(OracleAgreement, PointsInRangeWithoutAnyFootprint) {
  // Some 130 rows cross a line of 40 mm, so one point more or less is a percent in each of 16 columns.
  RayOptions options;
  options.footprint = false;
  options.refinements = 0;
  options.doublings = 0;
  options.columns = 16;
  options.rows = 16384;
  options.beams = {3, 8};
  const EchoTruth points = integrate_rays(Bvh(facets_), law_, options);
  EchoTruth exact = exact_;
  for (int beam = 0; beam < exact.beams; ++beam) {
    if (beam != 3 && beam != 8) {
      std::fill_n(exact.echo.begin() + beam * exact.lines, exact.lines, 0.0);
    }
  }
  EXPECT_LT(difference(points, exact).rms, 1e-2);
  EXPECT_NEAR(total(points) / total(exact), 1.0, 5e-4);
}

TEST_F(OracleAgreement, EstimateOfACoarseRunHoldsAgainstAFineOne) {
  for (const double bound : {1e-2, 1e-3, 1e-4}) {
    SliceOptions options;
    options.error_rms = bound;
    options.error_max = 20 * bound;
    options.first_intervals = 4;
    const EchoTruth coarse = integrate_slices(facets_, law_, options);
    EXPECT_LE(estimated_error(coarse).rms, bound);
    EXPECT_LT(difference(coarse, exact_).rms, estimated_error(coarse).rms + estimated_error(exact_).rms);
  }
}

TEST_F(OracleAgreement, AnotherDivisionOfTheBeams) {
  SliceOptions options = fine();
  options.first_intervals = 7;
  const EchoTruth other = integrate_slices(facets_, law_, options);
  EXPECT_LT(difference(other, exact_).rms, 4e-5);

  RayOptions grid;
  grid.rows = 256;
  grid.doublings = 1;
  RayOptions shifted = grid;
  shifted.rows = 277;
  shifted.columns = 5;
  const Bvh bvh(facets_);
  const EchoTruth a = integrate_rays(bvh, law_, grid);
  const EchoTruth b = integrate_rays(bvh, law_, shifted);
  EXPECT_LT(difference(a, b).rms, estimated_error(a).rms + estimated_error(b).rms);
}

TEST_F(OracleAgreement, HalvesOfABeamAddUp) {
  const EchoLaw halves(ping(32, 12 * degree, 16 * degree, 300, 12));
  const EchoTruth split = integrate_slices(facets_, halves, fine());
  EchoTruth joined = exact_;
  for (int beam = 0; beam < joined.beams; ++beam) {
    for (int k = 0; k < joined.lines; ++k) {
      joined.echo[static_cast<std::size_t>(beam * joined.lines + k)] =
          split.at(2 * beam, k) + split.at(2 * beam + 1, k);
    }
  }
  EXPECT_LT(difference(joined, exact_).rms, 5e-5);
}

TEST_F(OracleAgreement, SameBitsForAnyNumberOfThreads) {
  SliceOptions slices;
  slices.error_rms = 1e-3;
  RayOptions rays;
  rays.rows = 64;
  rays.doublings = 0;
  const Bvh bvh(facets_);
  slices.threads = 1;
  rays.threads = 1;
  const EchoTruth slices_1 = integrate_slices(facets_, law_, slices);
  const EchoTruth rays_1 = integrate_rays(bvh, law_, rays);
  for (const unsigned threads : {2U, 5U}) {
    slices.threads = threads;
    rays.threads = threads;
    EXPECT_EQ(integrate_slices(facets_, law_, slices).echo, slices_1.echo);
    EXPECT_EQ(integrate_rays(bvh, law_, rays).echo, rays_1.echo);
  }
}

TEST(OracleCorners, ThinPipeThatStandsInTheHalfPlanesOfTheSlices) {
  // 1 cm wide at 40 m, a thirtieth of a beam, upright: its sides are jumps in azimuth, and two slices of a
  // coarse division can miss it on either side. A beam divided at its corners finds it at once.
  render::World world = world_of({test::make_tube({0, 0, -1}, {0, 0, 1}, 0.005, 12, 1)});
  world.bodies[0].T_world_body.position_m = {40, 0.05, 0};
  const EchoLaw law(ping(1, 0.47 * degree, 4 * degree, 20, 60));
  const Facets facets(world, {}, law);
  SliceOptions options;
  options.error_rms = 1e-6;
  options.error_max = 1e-5;
  const EchoTruth fine = integrate_slices(facets, law, options);
  options.max_slices_per_beam = 400;
  options.first_intervals = 1;
  options.max_corners = 100;
  const EchoTruth by_corners = integrate_slices(facets, law, options);
  EXPECT_LT(by_corners.rays, fine.rays);
  EXPECT_LT(difference(by_corners, fine).rms, 1e-4);
  // Far away each facet reflects its area times cos^2 / r^4; their normals are 30 degrees apart.
  double truth = 0;
  for (const double turned : {-75, -45, -15, 15, 45, 75}) {
    const double area = 2 * 0.005 * std::sin(15 * degree) * 2.0;
    truth += area * std::pow(std::cos(turned * degree), 2) / std::pow(40.0, 4);
  }
  EXPECT_NEAR(total(by_corners) / truth, 1.0, 2e-3);
}

TEST_F(OracleAgreement, FarFromTheOriginOfTheWorldAndTurned) {
  const render::Pose far{{1e6, -2e6, 3e5}, glm::normalize(glm::dquat(0.3, -0.5, 0.2, 0.78))};
  render::World moved = world_;
  for (render::Body& body : moved.bodies) {
    body.T_world_body = far * body.T_world_body;
  }
  const Facets facets(moved, far * T_world_sonar_, law_);
  EXPECT_LT(difference(integrate_slices(facets, law_, fine()), exact_).rms, 1e-6);
}

}  // namespace

}  // namespace sonard::oracle
