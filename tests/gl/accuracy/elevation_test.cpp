// SPDX-License-Identifier: Apache-2.0
// Elevation patterns (docs/physics.md 2.5) on a wall across the axis: each elevation has its own range.
#include <cmath>
#include <numbers>

#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/gl/accuracy/truth_image.hpp"
#include "tests/support/degree.hpp"
#include "tests/support/kink_quadrature.hpp"

namespace sonard::test {
namespace {

constexpr double wall_m = 8;

class ElevationAccuracy : public AccuracyTest {};

INSTANTIATE_TEST_SUITE_P(Accuracy, ElevationAccuracy, all_cases(), case_name);

double sinc_squared(double elevation_rad, double beamwidth_rad) {
  const double x = std::numbers::pi * 0.443 * std::sin(elevation_rad) / std::sin(beamwidth_rad / 2);
  return std::abs(x) < 1e-9 ? 1.0 : std::pow(std::sin(x) / x, 2);
}

/// Truth of the pattern to the power of 1 or 2.
render::EchoImage wall_truth(const Scene& scene, int power) {
  const double beamwidth = scene.settings.aperture.vertical_beamwidth_rad;
  const PlaneTruth wall{wall_m, 1, 0, 0, 1.25 * beamwidth};
  return image_of_beams(scene.settings, [&](double from, double to, double r1, double r2) {
    const auto density = [&](double psi) {
      const double nearest = wall_m / std::cos(psi);
      const auto weight = [&](double r) {
        return std::pow(sinc_squared(std::acos(nearest / r), beamwidth), power);
      };
      return weighted_echo([&](double a, double b) { return wall.density(psi, a, b); }, weight, nearest, r1,
                           r2, 24);
    };
    const double k1 = std::acos(wall_m / r1), k2 = std::acos(wall_m / r2);
    return kinked_integral(density, from, to, {k1, -k1, k2, -k2});
  });
}

TEST_P(ElevationAccuracy, PatternsOfALineArray) {
  using Elevation = render::Aperture::Elevation;
  for (const auto& [elevation, power] :
       {std::pair{Elevation::sinc, 1}, std::pair{Elevation::sinc_two_way, 2}}) {
    Scene scene = forward_looking_scene({make_body("wall", make_quad({8, -20, -20}, {0, 40, 0}, {0, 0, 40}))},
                                        {1150, 0.008, 0, false});
    scene.settings.aperture.beam_edges_rad = render::equal_angle_edges(16, 16 * 120.0 / 256 * degree);
    scene.settings.aperture.elevation = elevation;
    expect_within(targets(), measure(render(scene), wall_truth(scene, power)),
                  power == 1 ? "one-way" : "two-way");
  }
}

}  // namespace
}  // namespace sonard::test
