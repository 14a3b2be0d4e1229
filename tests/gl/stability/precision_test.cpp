// SPDX-License-Identifier: Apache-2.0
// S1 to S3 of docs/physics.md 4.3: range of depths, large coordinates, grazing incidence.
#include "tests/gl/stability/stability_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

SONARD_STABILITY_SUITE(Precision);

/// One beam so narrow that a wall across it has one range, to 3e-8 of it.
PingRequest telescope(PingRequest request, double line_m, int lines) {
  request.settings.aperture.beam_edges_rad = equal_angle_edges(1, 0.02 * degree);
  request.settings.aperture.vertical_beamwidth_rad = 0.02 * degree;
  request.settings.range = {lines, line_m, 0, false};
  return request;
}

/// A wall across x, wide enough for the telescope.
Body wall_at(double x_m, double mu = full_mu) {
  const auto half = static_cast<float>(0.01 * x_m);
  Body wall = make_body("wall", make_quad({0, -half, -half}, {0, 2 * half, 0}, {0, 0, 2 * half}), mu);
  wall.T_world_body.position_m.x = x_m;
  return wall;
}

// A wall 0.002 bins behind the border of two bins echoes in the far bin, 0.002 bins before it in the near
// bin, from 3 cm to 10 km.
TEST_P(Precision, S1RangesAreExactFromThreeCentimetresToTenKilometres) {
  for (const double about_m : {0.03, 0.1, 1.0, 10.0, 100.0, 1e3, 9.9e3}) {
    const double line_m = about_m / 900;
    for (const double offset : {0.002, -0.002}) {
      SonarRenderer renderer(make_world({wall_at((900 + offset) * line_m)}), options());
      const EchoImage image = renderer.render_echo(telescope(level_request(), line_m, 1000));
      const double in_its_bin = static_cast<double>(image.at(0, offset > 0 ? 900 : 899));
      EXPECT_GT(sum(image), 0) << about_m << " m";
      EXPECT_GT(in_its_bin, 0.999 * sum(image)) << about_m << " m, " << offset;
    }
  }
}

// A wall hides one that is 1e-5 of the range behind it, in either order of the world's bodies.
TEST_P(Precision, S1NearerWallHidesTheOneRightBehindIt) {
  for (const double front_m : {0.03, 1.0, 100.0, 9e3}) {
    const PingRequest request = telescope(level_request(), front_m / 900, 1000);
    Body front = wall_at(front_m, 0.01);
    Body back = wall_at(front_m * (1 + 1e-5));
    back.name = "back";
    const double alone = sum(SonarRenderer(make_world({front}), options()).render_echo(request));
    for (const auto& bodies : {std::vector<Body>{front, back}, std::vector<Body>{back, front}}) {
      const double both = sum(SonarRenderer(make_world(bodies), options()).render_echo(request));
      EXPECT_NEAR(both / alone, 1.0, 1e-5) << front_m << " m, first " << bodies[0].name;
    }
  }
}

// The whole scene, sonar included, moved as far as geocentric coordinates go, and turned.
TEST_P(Precision, S2ImageStaysFarFromTheOriginAndRotated) {
  const PingRequest request = quiet_request();
  const EchoImage here = SonarRenderer(small_harbour(), options()).render_echo(request);
  for (const double shift_m : {1e5, 1e6, 1e7}) {
    for (const double turn_rad : {0.0, 0.7}) {
      const Pose T_far_world{{shift_m, -shift_m, shift_m / 3},
                             glm::angleAxis(turn_rad, glm::normalize(glm::dvec3(0.2, 0.3, 1)))};
      World world = small_harbour();
      for (Body& body : world.bodies) {
        body.T_world_body = T_far_world * body.T_world_body;
      }
      PingRequest far_request = request;
      far_request.T_world_sonar = T_far_world * request.T_world_sonar;
      const EchoImage there = SonarRenderer(world, options()).render_echo(far_request);
      const double share = different_share(here, there, 1e-4);
      RecordProperty("share", std::to_string(share));
      EXPECT_LE(share, silhouette_share) << shift_m << " m, turned by " << turn_rad;
      EXPECT_NEAR(sum(there) / sum(here), 1.0, 1e-4) << shift_m << " m, turned by " << turn_rad;
    }
  }
}

// A plane through (8, 0, 0) that every ray meets at a grazing angle between gamma / 2 and 3 gamma / 2; the
// fan is gamma high. With x = gamma - theta: cos phi = x and r = 8 gamma / x, so per azimuth the echo is mu /
// (64 gamma^2) times the integral of x^3, or 5 mu gamma^2 / 256.
TEST_P(Precision, S3GrazingIncidence) {
  double before = INFINITY;
  for (const double gamma_deg : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    const double gamma = gamma_deg * degree;
    const auto half = static_cast<float>(20 * std::sin(gamma));
    const auto along = static_cast<float>(20 * std::cos(gamma));
    const Body plane =
        make_body("plane", make_quad({8 - along, -2, half}, {0, 4, 0}, {2 * along, 0, -2 * half}), full_mu);
    PingRequest request = level_request();
    request.settings.aperture.beam_edges_rad = equal_angle_edges(4, 1 * degree);
    request.settings.aperture.vertical_beamwidth_rad = gamma;
    request.settings.range = {2000, 0.01, 0, false};
    SonarRenderer renderer(make_world({plane}), options());
    const EchoImage image = renderer.render_echo(request);
    ASSERT_TRUE(is_sane(image)) << gamma_deg;
    EXPECT_LT(sum(image), before) << gamma_deg;
    before = sum(image);
    if (gamma_deg > 5e-5) {  // weaker echoes are less than a unit of the sums, 2^-40 of a beam's maximum
      EXPECT_NEAR(sum(image) / (full_mu * gamma * gamma * 5 / 256 * degree), 1.0, 0.02) << gamma_deg;
    }
  }
}

// Fewer rows than the range cells they cross: the footprint is cut, and the image stays finite and has an
// echo.
TEST_P(Precision, S3FootprintIsCutWhereOneSampleSeesHundredsOfBins) {
  const Body bed = make_body("bed", make_quad({-100, -100, -0.01F}, {200, 0, 0}, {0, 200, 0}), full_mu);
  PingRequest request = level_request();
  request.settings.range = {8000, 0.002, 0, false};
  if (request.settings.sampling.preset == Sampling::Preset::grid) {
    request.settings.sampling = sampling(64, 4);
  }
  SonarRenderer renderer(make_world({bed}), options());
  const EchoImage image = renderer.render_echo(request);
  EXPECT_TRUE(is_sane(image));
  EXPECT_GT(sum(image), 0);
}

TEST_P(Precision, S3SonarInAPlaneTouchingItOrInsideABodyStaysFinite) {
  SonarRenderer bed(make_world({make_body("bed", make_quad({-50, -50, 0}, {100, 0, 0}, {0, 100, 0}))}),
                    options());
  PingRequest request = level_request();
  for (const double height_m : {0.0, 1e-12, 1e-9, 1e-6, 1e-3, -1e-9, -1e-3}) {
    request.T_world_sonar.position_m.z = height_m;
    const EchoImage image = bed.render_echo(request);
    EXPECT_TRUE(is_sane(image)) << height_m;
    if (height_m == 0.0) {
      EXPECT_EQ(sum(image), 0) << "a plane seen edge-on has no echo";
    }
  }
}

// A closed ball around the sonar: the image holds its echo only. If the ball is nearer than the near limit,
// the image may be empty.
TEST_P(Precision, S3InsideABallOnlyTheBallIsHeard) {
  for (const float radius_m : {0.005F, 0.5F, 5.0F}) {
    World world =
        make_world({make_body("ball", make_sphere(radius_m, 64), full_mu),
                    make_body("wall", make_quad({8, -80, -80}, {0, 160, 0}, {0, 0, 160}), full_mu)});
    SonarRenderer renderer(world, options());
    const EchoImage image = renderer.render_echo(level_request());
    ASSERT_TRUE(is_sane(image)) << radius_m;
    if (radius_m < 0.02F) {
      continue;  // its echo is optional
    }
    for (int beam = 0; beam < image.beams; ++beam) {
      for (int k = 0; k < image.bins; ++k) {
        const double far_m = k * 0.02;
        if (far_m > static_cast<double>(radius_m) + 0.02 || far_m + 0.06 < static_cast<double>(radius_m)) {
          ASSERT_EQ(image.at(beam, k), 0) << "beam " << beam << ", " << far_m << " m";
        }
      }
    }
    EXPECT_GT(sum(image), 0) << radius_m;
  }
}

}  // namespace
}  // namespace sonard::render
