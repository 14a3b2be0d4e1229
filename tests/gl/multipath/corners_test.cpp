// SPDX-License-Identifier: Apache-2.0
// Corner reflectors (docs/physics.md 2.11; 3.2, T8).
#include <cmath>
#include <complex>
#include <glm/geometric.hpp>

#include "tests/gl/multipath/multipath_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

class Corners : public PathTest {};
INSTANTIATE_TEST_SUITE_P(Multipath, Corners, path_cases(), path_case_name);

struct Reflector {
  int beam = -1, line = -1;
  double intensity = 0.0;
};

/// The strongest bin.
Reflector strongest(const EchoImage& image) {
  Reflector reflector;
  for (int beam = 0; beam < image.beams; ++beam) {
    for (int line = 0; line < image.bins; ++line) {
      if (static_cast<double>(image.at(beam, line)) > reflector.intensity) {
        reflector = {beam, line, static_cast<double>(image.at(beam, line))};
      }
    }
  }
  return reflector;
}

/// Three triangles with edges of `edge_m` from a common corner at the origin, open towards -x.
TriangleMesh trihedral(float edge_m) {
  const float a = std::sqrt(1.0F / 3), b = std::sqrt(2.0F / 3), h = std::sqrt(0.5F);
  TriangleMesh mesh;
  mesh.positions = {{0, 0, 0},
                    edge_m * glm::vec3(-a, 0, b),
                    edge_m * glm::vec3(-a, -h, -b / 2),
                    edge_m * glm::vec3(-a, h, -b / 2)};
  mesh.indices = {0, 1, 2, 0, 2, 3, 0, 3, 1};
  return mesh;
}

TEST_P(Corners, TrihedralIsAGlintAtItsApex) {
  const double wavelength_m = 1500.0 / 720e3;
  for (const auto& [edge_m, range_m] : {std::pair{0.1F, 20.0}, {0.05F, 8.0}, {0.1F, 40.0}}) {
    World world = make_world({smooth_body("corner", trihedral(edge_m))});
    world.bodies[0].T_world_body.position_m = {range_m, 0, 0};
    PingRequest request = fan_request(255, 20, range_m + 5, 0.02);
    request.settings.physical.multipath.wavelength_m = wavelength_m;
    SonarRenderer renderer(world, options());
    const Reflector reflector = strongest(renderer.render_echo(request));
    EXPECT_EQ(reflector.beam, 127);
    EXPECT_NEAR(reflector.line, range_m / 0.02, 1);
    const double target_strength_db = decibels(reflector.intensity * std::pow(range_m, 4));
    const double truth_db =
        decibels(std::pow(static_cast<double>(edge_m), 4) / (3 * wavelength_m * wavelength_m));
    std::printf("trihedral %.2f m at %.0f m: %.2f dB, L^4/(3 lambda^2): %.2f dB\n",
                static_cast<double>(edge_m), range_m, target_strength_db, truth_db);
    EXPECT_NEAR(target_strength_db, truth_db, 1.0);
  }
}

// Wall and floor (T8): the echo of a mirror across the way, at the foot of the perpendicular on their edge.
TEST_P(Corners, EdgeOfWallAndFloorIsAGlintAtItsRange) {
  constexpr double wall_m = 8, altitude_m = 1, reflection = 0.94, sigma_m = 0.0001;
  for (const double yaw_deg : {0.0, 20.0, -35.0}) {
    World world = make_world(
        {smooth_body("floor", make_quad({-20, -20, -1}, {40, 0, 0}, {0, 40, 0}), reflection, sigma_m, 1e-4),
         smooth_body("wall", make_quad({8, -20, -1}, {0, 40, 0}, {0, 0, 10}), reflection, sigma_m, 1e-4)});
    PingRequest request = fan_request(255, 20, 12, 0.02);
    request.T_world_sonar.orientation = glm::angleAxis(yaw_deg * degree, glm::dvec3(0, 0, 1));
    SonarRenderer renderer(world, options());
    const Reflector reflector = strongest(renderer.render_echo(request));
    const double range_m = std::hypot(wall_m, altitude_m);
    EXPECT_NEAR(reflector.line, std::floor(range_m / 0.02), 1);
    EXPECT_NEAR(reflector.beam, 127 + yaw_deg / 120 * 255, 1);
    // The two grazing angles add up to a right angle, so the squares of their sines add up to 1.
    const double p = 2 * 2 * std::numbers::pi / request.settings.physical.multipath.wavelength_m * sigma_m;
    const double truth = std::pow(reflection, 4) * std::exp(-p * p) / (4 * range_m * range_m);
    std::printf("dihedral, yaw %.0f: line %d (%.1f), %+.3f dB\n", yaw_deg, reflector.line, range_m / 0.02,
                decibels(reflector.intensity / truth));
    EXPECT_NEAR(decibels(reflector.intensity / truth), 0, 0.5);

    request.settings.physical.multipath.level = MultipathSettings::Level::off;
    const EchoImage& single = renderer.render_echo(request);
    EXPECT_LT(static_cast<double>(single.at(reflector.beam, reflector.line)), 1e-2 * reflector.intensity);
  }
}

// An edge of length b returns the share of a full edge's echo that a slit of length b passes:
// 2 |C(u) + i S(u)|^2 with u = b / sqrt(lambda r), here by direct summation.
TEST_P(Corners, ShortEdgeIsWeaker) {
  constexpr double length_m = 0.08;
  World world = make_world({smooth_body("floor", make_quad({4, -0.04F, -1}, {4, 0, 0}, {0, 0.08F, 0})),
                            smooth_body("wall", make_quad({8, -0.04F, -1}, {0, 0.08F, 0}, {0, 0, 2}))});
  const PingRequest request = fan_request(255, 20, 12, 0.02);
  SonarRenderer renderer(world, options());
  const Reflector reflector = strongest(renderer.render_echo(request));
  const double range_m = std::hypot(8, 1);
  const double wavelength_m = request.settings.physical.multipath.wavelength_m;
  std::complex<double> slit = 0.0;
  constexpr int steps = 10000;
  for (int i = 0; i < steps; ++i) {
    const double x = length_m * ((i + 0.5) / steps - 0.5);
    slit += std::polar(length_m / steps, 2 * std::numbers::pi / wavelength_m * x * x / range_m);
  }
  const double share = std::norm(slit) / (wavelength_m * range_m / 2);
  const double truth = share / (4 * range_m * range_m);
  std::printf("short edge: %+.3f dB\n", decibels(reflector.intensity / truth));
  EXPECT_NEAR(decibels(reflector.intensity / truth), 0, 1.0);
}

// One degree off a right angle, the corner reflects sound past the sonar: 2 degrees at 8 m, 0.28 m.
TEST_P(Corners, SlantedWallGivesNoGlint) {
  const float lean = std::tan(1 * static_cast<float>(degree));
  World world = make_world({smooth_body("floor", make_quad({-20, -20, -1}, {40, 0, 0}, {0, 40, 0})),
                            smooth_body("wall", make_quad({8, -20, -1}, {0, 40, 0}, {10 * lean, 0, 10}))});
  const PingRequest request = fan_request(255, 20, 12, 0.02);
  SonarRenderer renderer(world, options());
  const double range_m = std::hypot(8, 1);
  EXPECT_LT(strongest(renderer.render_echo(request)).intensity, 1e-2 / (4 * range_m * range_m));
}

TEST_P(Corners, HiddenCornerIsNotHeard) {
  World world =
      make_world({smooth_body("corner", trihedral(0.1F)),
                  smooth_body("screen", make_quad({15, -0.3F, -0.3F}, {0, 0.6F, 0}, {0, 0, 0.6F}), 0)});
  world.bodies[0].T_world_body.position_m = {20, 0, 0};
  const PingRequest request = fan_request(255, 20, 25, 0.02);
  SonarRenderer renderer(world, options());
  EXPECT_EQ(strongest(renderer.render_echo(request)).intensity, 0.0);
}

}  // namespace
}  // namespace sonard::render
