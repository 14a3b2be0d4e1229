// SPDX-License-Identifier: Apache-2.0
// Mode `paper` against its closed form and its documented readings (docs/physics.md 1, 3.2).
#include <cmath>
#include <numbers>

#include "tests/support/degree.hpp"
#include "tests/support/engine_test.hpp"

namespace sonard::render {
namespace {

using test::EngineTest;
using test::make_body;
using test::make_quad;
using test::make_world;

PingRequest paper_request(int lines, double step_m) {
  PingRequest request;
  request.settings.model = Model::paper;
  request.settings.aperture.beam_edges_rad = equal_angle_edges(256, 120 * degree);
  request.settings.range = {lines, step_m, 0, false};
  return request;
}

World wall_world(double reflectance) {
  World world = make_world({make_body("wall", make_quad({10, -80, -40}, {0, 160, 0}, {0, 0, 80}))});
  world.bodies[0].parts[0].material.reflectance = reflectance;
  return world;
}

double sigmoid(double x) {
  return 1 / (1 + std::exp(-18 * (x - 2.0 / 3)));
}

class Paper : public EngineTest {};

INSTANTIATE_TEST_SUITE_P(Engines, Paper, test::all_engines(), test::engine_name);

// I_bin is the mean of S over the bin. On a plane it is S(rho D / r) at any distance, without spreading or
// absorption.
TEST_P(Paper, PlaneFollowsTheSigmoid) {
  for (const double rho : {0.35, 0.8, 1.0}) {
    SonarRenderer renderer(wall_world(rho), options());
    const PingRequest request = paper_request(1000, 0.025);
    const EchoImage image = renderer.render_echo(request);
    int compared = 0;
    for (const int beam : {0, 40, 127, 200, 255}) {
      for (int k = 1; k + 1 < image.bins; ++k) {
        if (image.at(beam, k - 1) > 0 && image.at(beam, k + 1) > 0) {
          const double range_m = (k + 0.5) * 0.025;
          // The slope of S over one line bounds the effect of averaging inside the line.
          EXPECT_NEAR(image.at(beam, k), sigmoid(std::min(1.0, rho * 10 / range_m)), 0.006)
              << "beam " << beam << " line " << k;
          ++compared;
        }
      }
    }
    EXPECT_GT(compared, 20);
  }
}

TEST_P(Paper, ReflectanceAboveOneClamps) {
  SonarRenderer renderer(wall_world(2.12), options());
  const EchoImage image = renderer.render_echo(paper_request(1000, 0.025));
  EXPECT_NEAR(image.at(127, 402), sigmoid(1.0), 1e-4);
}

TEST_P(Paper, AttenuationOfTheLaterReleaseActsBeforeTheSigmoid) {
  SonarRenderer renderer(wall_world(1.0), options());
  PingRequest request = paper_request(1000, 0.025);
  request.settings.paper = PaperModel::release_2018();
  const EchoImage image = renderer.render_echo(request);
  const double range_m = 402.5 * 0.025;
  EXPECT_NEAR(image.at(127, 402), sigmoid(10 / range_m * std::exp(-2 * 0.024 * range_m)), 0.006);
}

TEST_P(Paper, BackFacesCanBeDropped) {
  SonarRenderer renderer(
      make_world({make_body("towards", make_quad({10, 80, -40}, {0, -160, 0}, {0, 0, 80}))}), options());
  PingRequest request = paper_request(1000, 0.025);
  const auto brightest = [](const EchoImage& image) {
    return *std::max_element(image.intensity.begin(), image.intensity.end());
  };
  const float two_sided = brightest(renderer.render_echo(request));
  request.settings.paper.two_sided = false;
  const float front_only = brightest(renderer.render_echo(request));
  ASSERT_TRUE(
      renderer.set_body_pose("towards", {{20, 0, 0}, glm::angleAxis(std::numbers::pi, glm::dvec3(0, 0, 1))}));
  const float turned = brightest(renderer.render_echo(request));
  EXPECT_GT(two_sided, 0);
  // The quad is wound so that its front faces the sonar; turned by 180 degrees, it shows its back.
  EXPECT_EQ(front_only, two_sided);
  EXPECT_EQ(turned, 0);
}

// A4: floor(r / R_max (N - 1)) puts a wall at 10 m of 25 m, in 1000 lines, into line 399 instead of 400.
TEST_P(Paper, LegacyBinIndexAndPointSamples) {
  SonarRenderer renderer(wall_world(1.0), options());
  PingRequest request = paper_request(1000, 0.025);
  request.settings.paper.footprint = false;
  const auto first_line = [](const EchoImage& image) {
    int k = 0;
    while (image.at(127, k) == 0) {
      ++k;
    }
    return k;
  };
  EXPECT_EQ(first_line(renderer.render_echo(request)), 400);
  request.settings.paper.legacy_bin_index = true;
  EXPECT_EQ(first_line(renderer.render_echo(request)), 399);
}

// docs/physics.md 1.3: one planar frustum clips elevation to atan(tan 10 cos psi); the mask over split views
// does not.
TEST_P(Paper, SingleFrustumClipsTheSidesOnlyWhenAskedTo) {
  SonarRenderer renderer(wall_world(1.0), options());
  PingRequest request = paper_request(2000, 0.0125);
  const auto extent = [&](int beam) {
    const EchoImage image = renderer.render_echo(request);
    int first = -1, last = -1;
    for (int k = 0; k < image.bins; ++k) {
      if (image.at(beam, k) > 0) {
        first = first < 0 ? k : first;
        last = k;
      }
    }
    return (last + 1 - first) * 0.0125;
  };
  const auto& edges = request.settings.aperture.beam_edges_rad;
  const double near_side = 10 / std::cos(edges[1]);
  const double far_side = 10 / std::cos(edges[0]);
  EXPECT_NEAR(extent(0), far_side / std::cos(10 * degree) - near_side, 0.03);
  request.settings.paper.elevation_mask = false;
  request.settings.sampling = Sampling::of_grid(1, 2048, 512);
  const double clipped = std::atan(std::tan(10 * degree) * std::cos(edges[0]));
  EXPECT_NEAR(extent(0), far_side / std::cos(clipped) - near_side, 0.04);
}

}  // namespace
}  // namespace sonard::render
