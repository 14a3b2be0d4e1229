// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/tone.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace sonard::render {
namespace {

/// Integral of the square of sin(pi x) / (pi x) from -1 to 1.
constexpr double lobe_length = 0.902823;

/// Integral of sin(pi x) / (pi x) from -1 to `x`, which is clamped to [-1, 1].
double lobe_integral(double x) {
  constexpr std::size_t steps = 1024;
  static const std::array<double, steps + 1> table = [] {
    std::array<double, steps + 1> sums{};
    for (std::size_t i = 0; i < steps; ++i) {
      const double y = std::numbers::pi * (2 * (static_cast<double>(i) + 0.5) / steps - 1);
      sums[i + 1] = sums[i] + std::sin(y) / y * 2 / steps;
    }
    return sums;
  }();
  const double at = (std::clamp(x, -1.0, 1.0) + 1) / 2 * steps;
  const auto below = std::min(static_cast<std::size_t>(at), steps - 1);
  return std::lerp(table[below], table[below + 1], at - static_cast<double>(below));
}

}  // namespace

double tone_length_m(double cell_m, double rounding_m) {
  return std::max(cell_m, lobe_length * rounding_m);
}

RoundedTone::RoundedTone(double cell_m, double rounding_m) : box_m_(0), rounding_m_(rounding_m) {
  constexpr int halvings = 30;
  const double wanted_m = tone_length_m(cell_m, rounding_m);
  double shorter_m = 1e-3 * rounding_m, longer_m = wanted_m + 2 * rounding_m;
  for (int i = 0; i < halvings; ++i) {
    box_m_ = (shorter_m + longer_m) / 2;
    (length_m() < wanted_m ? shorter_m : longer_m) = box_m_;
  }
}

double RoundedTone::overlap(double at_m) const {
  return lobe_integral((at_m + box_m_ / 2) / rounding_m_) - lobe_integral((at_m - box_m_ / 2) / rounding_m_);
}

double RoundedTone::length_m() const {
  constexpr int steps = 256;
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    const double at = amplitude((i + 0.5) / steps * reach_m());
    sum += at * at;
  }
  return 2 * sum / steps * reach_m();
}

}  // namespace sonard::render
