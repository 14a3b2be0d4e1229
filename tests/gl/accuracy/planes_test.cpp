// SPDX-License-Identifier: Apache-2.0
// T1, T2 and T3: planes.
#include <cmath>

#include "tests/bench/plane_quadrature.hpp"
#include "tests/bench/reference.hpp"
#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/gl/accuracy/truth_image.hpp"

namespace sonard::test {
namespace {

class SlopeAccuracy : public AccuracyTest {};
class PlaneAccuracy : public AccuracyTest {
 protected:
  void expect_closed_form(const std::string& scene_name, const AccuracyLimits& allowed) const {
    const Scene scene = make_scene(scene_name);
    expect_within(allowed, measure(render(scene), bench::plane_image(scene)), scene_name);
  }
};

INSTANTIATE_TEST_SUITE_P(Accuracy, SlopeAccuracy, all_cases(), case_name);
INSTANTIATE_TEST_SUITE_P(Accuracy, PlaneAccuracy, all_cases(), case_name);

TEST_P(SlopeAccuracy, T1ObliqueSlope) {
  // A plane through (9, 0, 0) whose normal points away, to port and up.
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.8, 0.35, -0.5));
  const glm::dvec3 a = glm::normalize(glm::cross(n, glm::dvec3(0, 0, 1)));
  const glm::dvec3 b = glm::cross(n, a);
  // Just beyond the range: corners are floats, and the last beam's echo is only a few centimetres deep.
  const glm::dvec3 corner = glm::dvec3(9, 0, 0) - 32.0 * a - 32.0 * b;
  const Scene scene = forward_looking_scene({make_body("slope", make_quad(corner, 64.0 * a, 64.0 * b))});
  const PlaneTruth truth{9 * n.x, n.x, n.y, n.z, scene.settings.aperture.elevation_limit_rad()};
  const auto echo = [&](double from, double to, double r1, double r2) {
    return bench::plane_beam_echo(truth, from, to, r1, r2);
  };
  expect_within(targets(), measure(render(scene), image_of_beams(scene.settings, echo)), "slope");
}

TEST_P(PlaneAccuracy, T1BedUnderATiltedSonar) {
  expect_closed_form("plane", targets());
}

TEST_P(PlaneAccuracy, T2PerpendicularWall) {
  expect_closed_form("b1_wall", targets());
}

TEST_P(PlaneAccuracy, T3FlatSeabed) {
  for (const char* scene : {"b2_seabed_2m", "b2_seabed_5m"}) {
    expect_closed_form(scene, targets());
  }
}

}  // namespace
}  // namespace sonard::test
