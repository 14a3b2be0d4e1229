// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <numbers>
#include <vector>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

// Tables reach to six standard deviations in steps of 1/16; between them sqrt(t) is nearly straight.
constexpr double reach = 6.0;
constexpr int steps_per_unit = 16;
constexpr int entries = static_cast<int>(2 * reach) * steps_per_unit + 1;
// There are eight tables per octave of nu, interpolated in log nu.
constexpr double least_log2_nu = -4.0;
constexpr double most_log2_nu = 10.0;
constexpr int tables_per_octave = 8;

/// std::lgamma() writes the sign into a global variable, which is a race.
double log_gamma(double a) {
  int sign = 0;
  return lgamma_r(a, &sign);
}

struct Tails {
  double below, above;
};

/// Regularised incomplete gamma functions P(a, x) and 1 - P by the series of P (Abramowitz & Stegun 6.5.29):
/// with double precision 1 - P keeps seven digits at six standard deviations.
Tails gamma_tails(double a, double x) {
  double term = 1.0;
  double sum = 1.0;
  for (int n = 1; n < 10'000 && term > 1e-17 * sum; ++n) {
    term *= x / (a + n);
    sum += term;
  }
  const double below = sum * std::exp(a * std::log(x) - x - log_gamma(a + 1));
  return {below, 1 - below};
}

/// The x at which the gamma distribution of shape a has the tails of a standard normal number. Newton's
/// method for the logarithm of the smaller tail as a function of ln x, which is nearly a straight line.
double gamma_quantile(double a, double normal, double first_guess) {
  const bool lower = normal < 0;
  const double wanted = std::log(0.5 * std::erfc(std::abs(normal) / std::numbers::sqrt2));
  double log_x = std::log(first_guess);
  for (int i = 0; i < 60; ++i) {
    const double x = std::exp(log_x);
    const Tails tails = gamma_tails(a, x);
    const double tail = std::max(lower ? tails.below : tails.above, 1e-300);
    const double density = std::exp(a * log_x - x - log_gamma(a));  // per ln x
    const double slope = (lower ? density : -density) / tail;
    const double change = std::clamp((wanted - std::log(tail)) / slope, -1.0, 1.0);
    log_x += change;
    if (std::abs(change) < 1e-9) {
      break;
    }
  }
  return std::exp(log_x);
}

std::vector<float> table_of(double nu) {
  std::vector<float> roots(static_cast<std::size_t>(entries));
  const int middle = entries / 2;
  for (const int direction : {1, -1}) {
    double x = nu;
    for (int i = middle; i >= 0 && i < entries; i += direction) {
      x = gamma_quantile(nu, static_cast<double>(i - middle) / steps_per_unit, x);
      roots[static_cast<std::size_t>(i)] = static_cast<float>(std::sqrt(x / nu));
    }
  }
  return roots;
}

constexpr std::size_t table_count =
    static_cast<std::size_t>(most_log2_nu - least_log2_nu) * tables_per_octave + 1;

/// Made on first use, by the first thread to call: all tables take tens of milliseconds, and a sonar needs
/// only a few.
const std::vector<float>& table(std::size_t number) {
  static std::array<std::once_flag, table_count> made;
  static std::array<std::vector<float>, table_count> tables;
  std::call_once(made[number], [&] {
    tables[number] = table_of(std::exp2(least_log2_nu + static_cast<double>(number) / tables_per_octave));
  });
  return tables[number];
}

SONARD_SIMD_CLONES
void apply_texture(const float* __restrict root, const float* __restrict intensity,
                   const float* __restrict gaussian, int count, float* __restrict out) {
  constexpr auto scale = static_cast<float>(std::numbers::sqrt2 * steps_per_unit);
  constexpr auto middle = static_cast<float>(entries / 2);
  constexpr auto last = static_cast<float>(entries - 2);
  for (int i = 0; i < count; ++i) {
    const float place = std::min(std::max(gaussian[i] * scale + middle, 0.0F), last);
    const auto entry = static_cast<std::int32_t>(place);
    const float rest = place - static_cast<float>(entry);
    const float value = root[entry] * (1 - rest) + root[entry + 1] * rest;
    out[i] = intensity[i] * (value * value);
  }
}

}  // namespace

void TextureRoot::set(double nu) {
  const double at =
      (std::clamp(std::log2(nu), least_log2_nu, most_log2_nu) - least_log2_nu) * tables_per_octave;
  const std::size_t below = std::min(static_cast<std::size_t>(at), table_count - 2);
  const auto share = static_cast<float>(at - static_cast<double>(below));
  const std::vector<float>& low = table(below);
  const std::vector<float>& high = table(below + 1);
  root_.resize(low.size());
  for (std::size_t i = 0; i < low.size(); ++i) {
    root_[i] = low[i] + share * (high[i] - low[i]);
  }
}

void TextureRoot::apply(const float* intensity, const float* gaussian, int count, float* out) const {
  apply_texture(root_.data(), intensity, gaussian, count, out);
}

double scatterers_at(const SpeckleSettings& speckle, double range_m) {
  return speckle.texture_nu * range_m / speckle.texture_range_m;
}

}  // namespace sonard::render
