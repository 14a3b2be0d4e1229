// SPDX-License-Identifier: Apache-2.0
// A pipe of 5 cm at 30 m is found at any place between two samples, upright or lying.
#include <cmath>
#include <numbers>

#include "tests/gl/accuracy/accuracy_case.hpp"
#include "tests/scenes/shapes.hpp"
#include "tests/support/degree.hpp"

namespace sonard::test {
namespace {

constexpr double range_m = 30, radius_m = 0.025, half_length_m = 0.4;
constexpr int pipes = 50;

class ThinPipe : public AccuracyTest {
 protected:
  /// Share of the pipes whose echo, within a third of a metre of its place, exceeds half of the closed form.
  double detected(bool upright) const {
    std::vector<render::Body> bodies;
    std::vector<double> bearings;
    for (int i = 0; i < pipes; ++i) {
      // One every 2.3 degrees, off any regular grid: by the golden ratio in bearing, by sqrt 2 in height.
      const double offset = std::fmod(i * std::numbers::phi, 1.0);
      const double bearing = (2.3 * (i - (pipes - 1) / 2.0) + 0.8 * (offset - 0.5)) * degree;
      const double z = 4 * (std::fmod(i * std::numbers::sqrt2, 1.0) - 0.5);
      const glm::dvec3 centre(range_m * std::cos(bearing), range_m * std::sin(bearing), z);
      const glm::dvec3 half =
          half_length_m *
          (upright ? glm::dvec3(0, 0, 1) : glm::dvec3(-std::sin(bearing), std::cos(bearing), 0));
      bodies.push_back(
          make_body("pipe" + std::to_string(i), make_tube(centre - half, centre + half, radius_m, 32, 1)));
      bearings.push_back(bearing);
    }
    const Scene scene = forward_looking_scene(std::move(bodies), {1000, 0.032, 0, false});
    const render::EchoImage image = render(scene);
    int found = 0;
    for (const double bearing : bearings) {
      found += heard(image, scene.settings, bearing) > 0.5 * expected() ? 1 : 0;
    }
    return static_cast<double>(found) / pipes;
  }

 private:
  static double heard(const render::EchoImage& image, const render::SonarSettings& settings, double bearing) {
    const double aside = (half_length_m + 0.2) / range_m;
    double sum = 0;
    for (int beam = 0; beam < image.beams; ++beam) {
      const auto b = static_cast<std::size_t>(beam);
      if (settings.aperture.beam_edges_rad[b] < bearing - aside ||
          settings.aperture.beam_edges_rad[b + 1] > bearing + aside) {
        continue;
      }
      for (int k = static_cast<int>((range_m - 0.33) / 0.032); k < static_cast<int>((range_m + 0.33) / 0.032);
           ++k) {
        sum += static_cast<double>(image.at(beam, k));
      }
    }
    return sum;
  }

  /// T5 of an upright pipe whose middle is nearest; lying pipes have the same echo.
  static double expected() {
    const double aside = std::asin(radius_m / range_m);
    return azimuth_integral(
        [](double psi) {
          return cylinder_density(radius_m, range_m, std::atan(half_length_m / range_m), psi, 0, 2 * range_m);
        },
        -aside, aside, 1000);
  }
};

INSTANTIATE_TEST_SUITE_P(Accuracy, ThinPipe, all_cases(), case_name);

TEST_P(ThinPipe, Upright) {
  const double share = detected(true);
  std::printf("detected %.3f\n", share);
  EXPECT_GE(share, targets().pipes_detected);
}

TEST_P(ThinPipe, Lying) {
  const double share = detected(false);
  std::printf("detected %.3f\n", share);
  EXPECT_GE(share, targets().pipes_detected);
}

}  // namespace
}  // namespace sonard::test
