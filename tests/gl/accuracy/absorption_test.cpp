// SPDX-License-Identifier: Apache-2.0
// T14: T2 with absorption; nothing else changes.
#include <cmath>

#include "tests/bench/plane_quadrature.hpp"
#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/gl/accuracy/truth_image.hpp"

namespace sonard::test {
namespace {

constexpr double alpha_db_per_m = 0.2085;

class AbsorptionAccuracy : public AccuracyTest {};

INSTANTIATE_TEST_SUITE_P(Accuracy, AbsorptionAccuracy, all_cases(), case_name);

/// Level of one beam, dB, with the absorption beyond `wall_m` undone line by line.
double level_db(const render::EchoImage& image, int beam, double wall_m, double step_m) {
  double sum = 0;
  for (int k = 0; k < image.bins; ++k) {
    sum += static_cast<double>(image.at(beam, k)) *
           std::pow(10.0, alpha_db_per_m * ((k + 0.5) * step_m - wall_m) / 5);
  }
  return 10 * std::log10(sum);
}

TEST_P(AbsorptionAccuracy, T14WallAndOneTwiceAsFar) {
  std::vector<render::EchoImage> images;
  for (const double wall_m : {10.0, 20.0}) {
    Scene scene = forward_looking_scene(
        {make_body("wall", make_quad(glm::dvec3(wall_m, -160, -40), {0, 320, 0}, {0, 0, 80}))},
        {2100, 0.02, 0, false});
    scene.settings.physical.absorption_db_per_m = alpha_db_per_m;
    const PlaneTruth plane{wall_m, 1, 0, 0, scene.settings.aperture.elevation_limit_rad()};
    const auto echo = [&](double from, double to, double r1, double r2) {
      return bench::plane_beam_echo(plane, from, to, r1, r2) *
             std::pow(10.0, -alpha_db_per_m * (r1 + r2) / 2 / 5);
    };
    images.push_back(render(scene));
    expect_within(targets(), measure(images.back(), image_of_beams(scene.settings, echo)), "wall");
  }
  const double ratio =
      std::pow(10.0, (level_db(images[0], 127, 10, 0.02) - level_db(images[1], 127, 20, 0.02) -
                      20 * std::log10(2.0) - 2 * alpha_db_per_m * 10) /
                         10);
  std::printf("one against the other: %.6f\n", ratio - 1);
  EXPECT_NEAR(ratio, 1, targets().beam_total);
}

}  // namespace
}  // namespace sonard::test
