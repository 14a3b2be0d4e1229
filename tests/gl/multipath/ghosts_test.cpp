// SPDX-License-Identifier: Apache-2.0
// Ghosts by one mirror: ranges, bearings and levels against sums computed here.
#include <cmath>
#include <glm/geometric.hpp>

#include "tests/gl/multipath/multipath_test.hpp"

namespace sonard::render {
namespace {

using namespace test;

class Ghosts : public PathTest {};
INSTANTIATE_TEST_SUITE_P(Multipath, Ghosts, path_cases(), path_case_name);

/// Echo of a small Lambert sphere from one direction into another at an angle of `beta`, rad (the phase law
/// of a moon): mu times the integral of the two cosines over the part visible from both.
double sphere_echo(double mu, double radius_m, double beta) {
  const double pi = std::numbers::pi;
  return mu * 2.0 / 3.0 * radius_m * radius_m * (std::sin(beta) + (pi - beta) * std::cos(beta));
}

// docs/physics.md 3.2, T9: zs = 2, zt = 3, X = 15.
TEST_P(Ghosts, SurfaceImageOfASphereIsWhereItBelongsAndAsStrong) {
  constexpr double radius_m = 0.08, mu = 0.1;
  World world = make_world({rough_body("ball", make_sphere(static_cast<float>(radius_m), 32), mu)});
  world.bodies[0].T_world_body.position_m = {15, 0, -3};
  world.water_surface_z_m = 0;
  PingRequest request = fan_request(256, 50, 20, 0.1);
  request.T_world_sonar.position_m = {0, 0, -2};
  SonarRenderer renderer(world, options());
  const EchoImage& image = renderer.render_echo(request);

  const double r0 = std::hypot(15, 1), r1 = std::hypot(15, 5);
  const double beta = std::atan2(5, 15) - std::atan2(1, 15);
  const struct {
    double range_m, level;
  } echoes[] = {
      {15.0333, sphere_echo(mu, radius_m, 0) / std::pow(r0, 4)},
      {15.4223, 4 * sphere_echo(mu, radius_m, beta) / (r0 * r0 * r1 * r1)},
      {15.8114, sphere_echo(mu, radius_m, 0) / std::pow(r1, 4)},
  };
  for (const auto& echo : echoes) {
    const double near_m = echo.range_m - 0.19, far_m = echo.range_m + 0.19;
    const int line = strongest_line(image, request.settings, near_m, far_m);
    EXPECT_NEAR(line, std::floor(echo.range_m / 0.1), 1) << echo.range_m;
    const double level_db = decibels(energy(image, request.settings, near_m, far_m, -1, 1) / echo.level);
    std::printf("sphere %.4f m: line %d, %+.3f dB\n", echo.range_m, line, level_db);
    EXPECT_NEAR(level_db, 0, 0.5) << echo.range_m;
  }
  EXPECT_EQ(renderer.last_statistics().skipped.of(SkipRule::multipath), 0u);
  // The image holds nothing else.
  EXPECT_NEAR(energy(image, request.settings, 0, 20) / energy(image, request.settings, 14.8, 16.0), 1, 1e-6);
}

TEST_P(Ghosts, RipplesOnTheWaterWeakenItsImages) {
  World world = make_world({rough_body("ball", make_sphere(0.08F, 32))});
  world.bodies[0].T_world_body.position_m = {15, 0, -3};
  world.water_surface_z_m = 0;
  PingRequest request = fan_request(256, 50, 20, 0.1);
  request.T_world_sonar.position_m = {0, 0, -2};
  SonarRenderer renderer(world, options());
  const double calm = energy(renderer.render_echo(request), request.settings, 15.25, 15.6);
  const double calm_twice = energy(renderer.render_echo(request), request.settings, 15.62, 16);
  request.settings.physical.multipath.water_surface_rms_height_m = 0.0006;
  const double rippled = energy(renderer.render_echo(request), request.settings, 15.25, 15.6);
  const double rippled_twice = energy(renderer.render_echo(request), request.settings, 15.62, 16);
  const double k = 2 * std::numbers::pi / request.settings.physical.multipath.wavelength_m;
  const double p = 2 * k * 0.0006 * 5 / std::hypot(15, 5);
  EXPECT_NEAR(decibels(rippled / calm), decibels(std::exp(-p * p)), 0.15);
  EXPECT_NEAR(decibels(rippled_twice / calm_twice), 2 * decibels(std::exp(-p * p)), 0.3);
}

struct SmallPlate {
  glm::dvec3 corner, a, b;
};

/// The integral of mu cos(in) cos(out) / (r_in^2 r_out^2) over a plate visible from both.
double plate_echo(const SmallPlate& plate, double mu, const glm::dvec3& source, const glm::dvec3& receiver) {
  constexpr int n = 64;
  const glm::dvec3 cross = glm::cross(plate.a, plate.b);
  const glm::dvec3 normal = glm::normalize(cross);
  double sum = 0.0;
  for (int i = 0; i < n * n; ++i) {
    const glm::dvec3 at = plate.corner + plate.a * ((i % n + 0.5) / n) + plate.b * ((i / n + 0.5) / n);
    const glm::dvec3 in = at - source, out = at - receiver;
    sum += std::abs(glm::dot(normal, in) * glm::dot(normal, out)) / std::pow(glm::length(in), 3) /
           std::pow(glm::length(out), 3);
  }
  return mu * sum * glm::length(cross) / (n * n);
}

TriangleMesh plate_mesh(const SmallPlate& plate) {
  return make_quad(glm::vec3(plate.corner), glm::vec3(plate.a), glm::vec3(plate.b));
}

// A box with a smooth side along y = 2, and a rough plate of 0.3 m, turned by 45 degrees, at (10, -1).
constexpr double mirror_y = 2, mu_plate = 0.1, reflection = 0.8, sigma_m = 0.0002;
const SmallPlate plate{{10 - 0.1, -1 - 0.1, -0.15}, {0.2, 0.2, 0}, {0, 0, 0.3}};
const glm::dvec3 plate_middle(10, -1, 0);

World mirror_and_plate() {
  return make_world(
      {smooth_body("mirror", make_quad({2, mirror_y, -2}, {8, 0, 0}, {0, 0, 4}), reflection, sigma_m),
       rough_body("plate", plate_mesh(plate), mu_plate)});
}

double mirror_gain(const PingRequest& request) {
  const double k = 2 * std::numbers::pi / request.settings.physical.multipath.wavelength_m;
  const double p = 2 * k * sigma_m * 5 / std::hypot(10, 5);  // sine of the grazing angle of the image
  return reflection * reflection * std::exp(-p * p);
}

// Second bounce (docs/physics.md 2.11, M2): the path and its reverse arrive in different beams, each at the
// mean of both ranges.
TEST_P(Ghosts, UprightMirrorGivesOneEchoInEachBearing) {
  const PingRequest request = fan_request(256, 20, 15, 0.02);
  SonarRenderer renderer(mirror_and_plate(), options());
  const EchoImage& image = renderer.render_echo(request);

  const glm::dvec3 sonar(0), sonar_image(0, 2 * mirror_y, 0);
  const double r0 = glm::length(plate_middle), r1 = glm::length(plate_middle - sonar_image);
  const double psi0 = std::atan2(-1, 10) / degree, psi1 = std::atan2(5, 10) / degree;
  const double gain = mirror_gain(request);
  const struct {
    const char* what;
    double range_m, bearing_deg, level;
  } echoes[] = {
      {"straight", r0, psi0, plate_echo(plate, mu_plate, sonar, sonar)},
      {"back straight", (r0 + r1) / 2, psi0, gain * plate_echo(plate, mu_plate, sonar_image, sonar)},
      {"back by the mirror", (r0 + r1) / 2, psi1, gain * plate_echo(plate, mu_plate, sonar, sonar_image)},
      {"both by the mirror", r1, psi1, gain * gain * plate_echo(plate, mu_plate, sonar_image, sonar_image)},
  };
  double all = 0.0;
  for (const auto& echo : echoes) {
    const double from_deg = echo.bearing_deg - 1.5, to_deg = echo.bearing_deg + 1.5;
    const double sum =
        energy(image, request.settings, echo.range_m - 0.25, echo.range_m + 0.25, from_deg, to_deg);
    const int line =
        strongest_line(image, request.settings, echo.range_m - 0.25, echo.range_m + 0.25, from_deg, to_deg);
    std::printf("%s: %.4f m, line %d of %.1f, %+.3f dB\n", echo.what, echo.range_m, line, echo.range_m / 0.02,
                decibels(sum / echo.level));
    EXPECT_NEAR(decibels(sum / echo.level), 0, 0.5) << echo.what;
    all += sum;
  }
  EXPECT_NEAR(energy(image, request.settings, 0, 15) / all, 1, 1e-5);
}

// The range alone, in lines of 0.1 m, a third of the plate's size.
TEST_P(Ghosts, SecondBounceIsAtTheClosedFormRange) {
  const PingRequest request = fan_request(256, 20, 15, 0.1);
  SonarRenderer renderer(mirror_and_plate(), options());
  const EchoImage& image = renderer.render_echo(request);
  const double r0 = std::hypot(10, 1), r1 = std::hypot(10, 5);
  for (const double bearing_deg : {std::atan2(-1, 10) / degree, std::atan2(5, 10) / degree}) {
    const int line =
        strongest_line(image, request.settings, 10.3, 10.9, bearing_deg - 1.5, bearing_deg + 1.5);
    EXPECT_NEAR(line, std::floor((r0 + r1) / 2 / 0.1), 1);
  }
}

TEST_P(Ghosts, AbsorptionActsOnTheWholeWay) {
  PingRequest request = fan_request(256, 20, 15, 0.02);
  SonarRenderer renderer(mirror_and_plate(), options());
  const double range_m = (std::hypot(10, 1) + std::hypot(10, 5)) / 2;
  const double without =
      energy(renderer.render_echo(request), request.settings, range_m - 0.2, range_m + 0.2, 20, 30);
  request.settings.physical.absorption_db_per_m = 0.5;
  const double with =
      energy(renderer.render_echo(request), request.settings, range_m - 0.2, range_m + 0.2, 20, 30);
  EXPECT_NEAR(decibels(with / without), -2 * 0.5 * range_m, 0.02);
}

// A target hidden from the sonar echoes by the mirror only: at the range of its image, nowhere else.
TEST_P(Ghosts, HiddenTargetIsHeardOnlyByTheMirror) {
  World world = mirror_and_plate();
  world.bodies.push_back(smooth_body("screen", make_quad({6, -1.4F, -2}, {0, 1.2F, 0}, {0, 0, 4})));
  const PingRequest request = fan_request(256, 20, 15, 0.02);
  SonarRenderer renderer(world, options());
  const EchoImage& image = renderer.render_echo(request);
  const double gain = mirror_gain(request);
  const glm::dvec3 sonar_image(0, 2 * mirror_y, 0);
  const double both = gain * gain * plate_echo(plate, mu_plate, sonar_image, sonar_image);
  const double r1 = std::hypot(10, 5);
  const double heard = energy(image, request.settings, r1 - 0.25, r1 + 0.25, 25, 28);
  EXPECT_NEAR(decibels(heard / both), 0, 0.5);
  EXPECT_LT(energy(image, request.settings, 8, r1 - 0.3), 1e-4 * both);
}

// A screen between mirror and plate: only the straight echo is left.
TEST_P(Ghosts, NothingIsMirroredThroughAWall) {
  World world = mirror_and_plate();
  world.bodies.push_back(smooth_body("screen", make_quad({3, 1, -2}, {9, 0, 0}, {0, 0, 4}), 0.0));
  const PingRequest request = fan_request(256, 20, 15, 0.02);
  SonarRenderer renderer(world, options());
  const EchoImage& image = renderer.render_echo(request);
  const double r0 = std::hypot(10, 1);
  const double straight = energy(image, request.settings, r0 - 0.25, r0 + 0.25, -8, -4);
  EXPECT_GT(straight, 0);
  EXPECT_LT(energy(image, request.settings, r0 + 0.3, 15), 1e-6 * straight);
}

TEST_P(Ghosts, MovedBodiesAreFollowed) {
  const PingRequest request = fan_request(256, 20, 15, 0.02);
  SonarRenderer renderer(mirror_and_plate(), options());
  renderer.render_echo(request);
  World moved = mirror_and_plate();
  const Pose there{{-1, 0.5, 0.1}, {1, 0, 0, 0}};
  moved.bodies[1].T_world_body = there;
  renderer.set_body_pose("plate", there);
  SonarRenderer anew(moved, options());
  EXPECT_EQ(renderer.render_echo(request).intensity, anew.render_echo(request).intensity);
  moved.bodies[0].T_world_body.position_m.y = 0.5;
  renderer.set_body_pose("mirror", moved.bodies[0].T_world_body);
  SonarRenderer anew_again(moved, options());
  EXPECT_EQ(renderer.render_echo(request).intensity, anew_again.render_echo(request).intensity);
}

TEST_P(Ghosts, AnyNumberOfThreadsGivesTheSameBytes) {
  const PingRequest request = fan_request(256, 20, 15, 0.02);
  SonarRenderer one(mirror_and_plate(), options(1));
  SonarRenderer three(mirror_and_plate(), options(3));
  EXPECT_EQ(one.render_echo(request).intensity, three.render_echo(request).intensity);
}

TEST_P(Ghosts, LegOutsideTheFanIsNotHeard) {
  PingRequest request = fan_request(256, 20, 15, 0.02);
  // If the sonar points 60 degrees to port, the image is ahead and the plate itself outside the fan.
  request.T_world_sonar.orientation = glm::angleAxis(60 * degree, glm::dvec3(0, 0, 1));
  SonarRenderer renderer(mirror_and_plate(), options());
  const EchoImage& image = renderer.render_echo(request);
  const glm::dvec3 sonar_image(0, 2 * mirror_y, 0);
  const double gain = mirror_gain(request);
  const double both = gain * gain * plate_echo(plate, mu_plate, sonar_image, sonar_image);
  EXPECT_NEAR(decibels(energy(image, request.settings, 8, 15) / both), 0, 0.5);
}

}  // namespace
}  // namespace sonard::render
