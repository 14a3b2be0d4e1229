// SPDX-License-Identifier: Apache-2.0
// T4 and T5: round bodies.
#include <cmath>
#include <numbers>

#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/gl/accuracy/truth_image.hpp"
#include "tests/support/degree.hpp"

namespace sonard::test {
namespace {

class SphereAccuracy : public AccuracyTest {};
class CylinderAccuracy : public AccuracyTest {};

INSTANTIATE_TEST_SUITE_P(Accuracy, SphereAccuracy, all_cases(), case_name);
INSTANTIATE_TEST_SUITE_P(Accuracy, CylinderAccuracy, all_cases(), case_name);

/// Corner radius, m, of a polygon whose mean width over all directions equals the circle's. An inscribed
/// polygon is too narrow for the beams that touch only a sliver of a body.
double corner_radius_m(double circle_radius_m, double corners) {
  return circle_radius_m * (std::numbers::pi / corners) / std::sin(std::numbers::pi / corners);
}

/// An upright tube without caps, with exact vertex normals and its axis at (x, y).
/// @param around, up numbers of facets
render::TriangleMesh make_column(double x, double y, double radius_m, double half_height_m,
                                 std::uint32_t around, std::uint32_t up) {
  render::TriangleMesh mesh;
  for (std::uint32_t i = 0; i <= around; ++i) {
    const double turn = 2 * std::numbers::pi * i / around;
    const glm::dvec3 normal(std::cos(turn), std::sin(turn), 0);
    for (std::uint32_t j = 0; j <= up; ++j) {
      const double z = half_height_m * (2.0 * j / up - 1);
      mesh.positions.emplace_back(glm::dvec3(x, y, z) + corner_radius_m(radius_m, around) * normal);
      mesh.normals.emplace_back(normal);
    }
  }
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j < up; ++j) {
      const std::uint32_t low = i * (up + 1) + j, next = low + up + 1;
      mesh.indices.insert(mesh.indices.end(), {low, next, low + 1, low + 1, next, next + 1});
    }
  }
  return mesh;
}

TEST_P(SphereAccuracy, T4Sphere) {
  render::Body sphere = make_body("sphere", make_sphere(static_cast<float>(corner_radius_m(0.5, 160)), 160));
  sphere.T_world_body.position_m = {8 * std::cos(20 * degree), 8 * std::sin(20 * degree), 0};
  const Scene scene = forward_looking_scene({sphere});
  const SphereTruth truth{0.5, 8, 20 * degree, 0};
  const render::EchoImage expected = image_of_beams(
      scene.settings,
      [&](double from, double to, double r1, double r2) { return truth.beam(from, to, r1, r2); });
  double total = 0;
  for (const float echo : expected.intensity) {
    total += static_cast<double>(echo);
  }
  ASSERT_NEAR(total / 1.411161e-4, 1, 1e-5);  // the total by T4
  expect_within(targets(), measure(render(scene), expected), "sphere");
}

TEST_P(CylinderAccuracy, T5UprightCylinder) {
  const double azimuth = -25 * degree, axis_m = 9, radius_m = 0.6;
  const Scene scene = forward_looking_scene({make_body(
      "column", make_column(axis_m * std::cos(azimuth), axis_m * std::sin(azimuth), radius_m, 2, 512, 64))});
  const CylinderTruth truth{radius_m, axis_m, azimuth, scene.settings.aperture.elevation_limit_rad()};
  const render::EchoImage expected = image_of_beams(
      scene.settings,
      [&](double from, double to, double r1, double r2) { return truth.beam(from, to, r1, r2); });
  expect_within(targets(), measure(render(scene), expected), "cylinder");
}

}  // namespace
}  // namespace sonard::test
