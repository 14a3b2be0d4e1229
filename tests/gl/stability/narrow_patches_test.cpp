// SPDX-License-Identifier: Apache-2.0
// Tests of former defects of binning and slices: patches narrower than their neighbours' distance or than
// float resolves at their range, edges along a slice, surfaces through the sonar.
#include <random>

#include "tests/gl/stability/stability_test.hpp"
#include "tests/scenes/shapes.hpp"

namespace sonard::render {
namespace {

using namespace test;

SONARD_STABILITY_SUITE(NarrowPatches);

// Both ends of the range in one image: a plate at 5 cm in front of half of the fan, a wall at 9 km behind all
// of it.
TEST_P(NarrowPatches, S1NearPlateAndFarWallInOneImage) {
  Body plate = make_body("plate", make_quad({0, 0.005F, -0.1F}, {0, 0.2F, 0}, {0, 0, 0.2F}), full_mu);
  plate.T_world_body.position_m.x = 0.05;
  Body wall = make_body("wall", make_quad({0, -3e4F, -3e4F}, {0, 6e4F, 0}, {0, 0, 6e4F}), full_mu);
  wall.T_world_body.position_m.x = 9000.06;
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(8, 90 * degree);
  request.settings.aperture.vertical_beamwidth_rad = 0.1 * degree;
  request.settings.range = {65000, 0.3, 0, false};
  SonarRenderer renderer(make_world({plate, wall}), options());
  const EchoImage image = renderer.render_echo(request);
  EXPECT_TRUE(is_sane(image));
  for (int beam = 0; beam < 8; ++beam) {
    const double near = static_cast<double>(image.at(beam, 0));
    const double far = beam_sum(image, beam) - near;
    if (beam < 3) {  // the plate reaches from 5.7 to 76 degrees
      EXPECT_GT(near, 0) << beam;
      EXPECT_EQ(far, 0) << beam;
    } else if (beam > 3) {
      EXPECT_EQ(near, 0) << beam;
      // The wall's first echo: 9000 m over the cosine of the beam's inner edge.
      const double inner =
          std::min(std::abs(request.settings.aperture.beam_edges_rad[static_cast<std::size_t>(beam)]),
                   std::abs(request.settings.aperture.beam_edges_rad[static_cast<std::size_t>(beam) + 1]));
      const int first = static_cast<int>(9000.06 / std::cos(inner) / 0.3);
      int k = 0;
      while (k < image.bins && !(image.at(beam, k) > 0)) {
        ++k;
      }
      EXPECT_NEAR(k, first, 1) << beam;
    }
  }
}

// A curtain in the upright plane of the fan's axis is seen edge-on: it has no echo.
TEST_P(NarrowPatches, S3CurtainThatHoldsTheSonar) {
  SonarRenderer curtain(make_world({make_body("curtain", make_quad({-5, 0, -5}, {20, 0, 0}, {0, 0, 10}))}),
                        options());
  const EchoImage edge_on = curtain.render_echo(level_request());
  EXPECT_TRUE(is_sane(edge_on));
  EXPECT_LT(sum(edge_on), 1e-6);
}

// Inside a ball of radius a, every ray meets it at a with cos phi = 1. The echo of a beam of width w is
// 2 w sin(theta_m) mu / a^2.
TEST_P(NarrowPatches, S9EveryFanHearsTheSameFromInsideABall) {
  SonarRenderer renderer(make_world({make_body("ball", make_sphere(4.99F, 128), full_mu)}), options());
  for (const double width_deg : {0.01, 120.0, 179.0, 180.0, 360.0}) {
    for (const double height_deg : {0.01, 20.0, 120.0, 170.0}) {
      PingRequest request = level_request();
      constexpr int beams = 12;
      Aperture& aperture = request.settings.aperture;
      aperture.beam_edges_rad = equal_angle_edges(beams, width_deg * degree);
      aperture.vertical_beamwidth_rad = height_deg * degree;
      request.settings.range = {400, 0.02, 0, false};
      if (request.settings.sampling.preset == Sampling::Preset::grid) {
        request.settings.sampling = sampling(128, 256);
      }
      const EchoImage image = renderer.render_echo(request);
      const double truth =
          width_deg * degree / beams * 2 * std::sin(height_deg / 2 * degree) * full_mu / (4.99 * 4.99);
      for (int beam = 0; beam < beams; ++beam) {
        EXPECT_NEAR(beam_sum(image, beam) / truth, 1.0, 0.01)
            << width_deg << " x " << height_deg << " deg, beam " << beam;
      }
    }
  }
}

// 2^18 samples of the strongest possible surface in the only bin of the only beam. With cos phi = cos theta
// cos psi the integral over the fan is 2 sin(psi_m) (theta_m + sin(theta_m) cos(theta_m)).
TEST_P(NarrowPatches, S19AQuarterOfAMillionSamplesInOneBin) {
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(1, 60 * degree);
  request.settings.range = {1, 100.0, 0, false};
  if (request.settings.sampling.preset == Sampling::Preset::grid) {
    request.settings.sampling = Sampling::of_grid(1, 512, 512);
  } else {
    request.settings.sampling.preset = Sampling::Preset::reference;
  }
  const World world =
      make_world({make_body("wall", make_quad({9, -50, -50}, {0, 100, 0}, {0, 0, 100}), full_mu)});
  const double limit = request.settings.aperture.elevation_limit_rad();
  const double truth =
      full_mu * 2 * std::sin(30 * degree) * (limit + std::sin(limit) * std::cos(limit)) / (50.0 * 50.0);
  SonarRenderer renderer(world, options());
  for (const bool footprint : {true, false}) {
    request.settings.sampling.footprint = footprint;
    if (!footprint && request.settings.sampling.preset != Sampling::Preset::grid) {
      request.settings.sampling = Sampling::of_grid(1, 512, 512);
    }
    const EchoImage image = renderer.render_echo(request);
    // A slice takes one cos phi for the part of a triangle in one line, here the whole triangle.
    const double allowed = GetParam() == Way::cpu_slices && footprint ? 1e-2 : 1e-3;
    EXPECT_NEAR(static_cast<double>(image.at(0, 0)) / truth, 1.0, allowed) << footprint;
    if (GetParam() != Way::cpu_slices) {
      EXPECT_GE(renderer.last_statistics().samples,
                200'000U);  // the corners of the view are out of the fan
    }
  }
  request.settings.sampling.footprint = true;
  request.settings.model = Model::paper;
  request.settings.paper.sigmoid_centre = 0;
  const float mean = renderer.render_echo(request).at(0, 0);
  EXPECT_GT(mean, 0.99F);
  EXPECT_LE(mean, 1.0F);
}

// Thin upright objects divide slices, so that slices miss no strip at any place.
TEST_P(NarrowPatches, S14SlicesMissNoThinStrip) {
  if (GetParam() != Way::cpu_slices) {
    return;  // grids find them by their width (geometry_test.cpp)
  }
  PingRequest request = level_request();
  request.settings.aperture.beam_edges_rad = equal_angle_edges(64, 40 * degree);
  for (const double width_m : {0.01, 0.05, 0.1}) {
    SonarRenderer renderer(strip(width_m, 0, true), options());
    for (int i = 0; i < 60; ++i) {
      ASSERT_TRUE(renderer.set_body_pose("strip", {{10, 0.3 + i * 0.01, 0}, {1, 0, 0, 0}}));
      EXPECT_GT(sum(renderer.render_echo(request)), 0) << width_m << ", place " << i;
    }
  }
}

// A face of a box whose range hardly changes along a slice ends at a steep edge. Its whole echo lies within a
// part of a line, wherever its ends are across the wedge. The truth is a fine grid of rays.
TEST_P(NarrowPatches, S3FacesAlongASliceStayInTheirLines) {
  if (GetParam() != Way::cpu_slices) {
    return;
  }
  Body box = make_body("box", make_block({0, 0, 0}, {1, 1, 1}, 0));
  box.T_world_body = {{8, 1, 0.5}, glm::angleAxis(0.6, glm::normalize(glm::dvec3(0.2, 0.1, 1)))};
  SonarRenderer renderer(
      make_world({make_body("bed", make_quad({2, -20, 0}, {18, 0, 0}, {0, 40, 0}), 0.3), box}), options());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> some(-1, 1);
  for (int i = 0; i < 130; ++i) {
    PingRequest request = quiet_request();
    request.settings.range = {400, 0.04, 0, false};
    request.T_world_sonar.position_m += glm::dvec3(some(random), some(random), 0.5 * some(random));
    request.T_world_sonar.orientation *= glm::angleAxis(0.2 * some(random), glm::dvec3(0, 0, 1)) *
                                         glm::angleAxis(0.1 * some(random), glm::dvec3(1, 0, 0));
    const EchoImage image = renderer.render_echo(request);
    request.settings.sampling = Sampling::of_grid(3, 512, 512);
    const EchoImage grid = renderer.render_echo(request);
    const double largest =
        static_cast<double>(*std::max_element(grid.intensity.begin(), grid.intensity.end()));
    double worst = 0.0;
    for (std::size_t k = 0; k < grid.intensity.size(); ++k) {
      worst = std::max(worst, static_cast<double>(std::abs(image.intensity[k] - grid.intensity[k])));
    }
    EXPECT_LT(worst / largest, 0.1) << "pose " << i;
  }
}

}  // namespace
}  // namespace sonard::render
