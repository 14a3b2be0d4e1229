// SPDX-License-Identifier: Apache-2.0
#include "tests/scenes/terrain.hpp"

#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace sonard::test {

namespace {

constexpr double longest_m = 100.0;
constexpr double shortest_m = 0.1;
constexpr double longest_amplitude_m = 1.0;
constexpr double roughness = 1.3;
constexpr double middle_m = ground_relief_m / 2;

/// height = amplitude * sin(kx * x + ky * y + phase)
struct Wave {
  double amplitude_m, kx, ky, phase;
};

const std::vector<Wave>& waves() {
  static const std::vector<Wave> all = [] {
    std::vector<Wave> made;
    for (double length_m = longest_m; length_m >= shortest_m; length_m /= 1.6) {
      const double k = 2 * std::numbers::pi / length_m;
      const double amplitude_m = longest_amplitude_m * std::pow(length_m / longest_m, roughness);
      const auto n = static_cast<double>(made.size());
      made.push_back({amplitude_m, k * std::cos(0.4 * n), k * std::sin(0.4 * n), 1.7 * n});
    }
    return made;
  }();
  return all;
}

/// By the addition theorem, a wave over a grid needs sines and cosines along two sides only.
struct Side {
  std::vector<double> sine, cosine;
};

}  // namespace

double ground_height_m(double x_m, double y_m) {
  double height = middle_m;
  for (const Wave& wave : waves()) {
    height += wave.amplitude_m * std::sin(wave.kx * x_m + wave.ky * y_m + wave.phase);
  }
  return height;
}

render::GreyImage ground_picture(int side_px) {
  const auto side = static_cast<std::size_t>(side_px);
  const double step_m = ground_side_m / (side_px - 1);
  std::vector<double> height(side * side, middle_m);
  for (const Wave& wave : waves()) {
    Side along_x{std::vector<double>(side), std::vector<double>(side)};
    for (std::size_t i = 0; i < side; ++i) {
      const double angle = wave.kx * (static_cast<double>(i) * step_m - ground_side_m / 2);
      along_x.sine[i] = std::sin(angle);
      along_x.cosine[i] = std::cos(angle);
    }
    for (std::size_t j = 0; j < side; ++j) {
      const double angle = wave.ky * (static_cast<double>(j) * step_m - ground_side_m / 2) + wave.phase;
      const double sine = wave.amplitude_m * std::sin(angle), cosine = wave.amplitude_m * std::cos(angle);
      for (std::size_t i = 0; i < side; ++i) {
        height[j * side + i] += along_x.sine[i] * cosine + along_x.cosine[i] * sine;
      }
    }
  }
  render::GreyImage picture{side_px, side_px, std::vector<std::uint16_t>(side * side)};
  for (std::size_t i = 0; i < height.size(); ++i) {
    picture.value[i] = static_cast<std::uint16_t>(std::lround(height[i] / ground_relief_m * 65535));
  }
  picture.value.back() = 65535;
  return picture;
}

}  // namespace sonard::test
