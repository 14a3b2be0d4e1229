#include "renderer/acoustics/range_grain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr int most_lines_each_side = 32;

double pulse_amplitude(double cells) {
  const double x = std::numbers::pi * cells;
  return x == 0 ? 1.0 : std::sin(x) / x;
}

SONARD_SIMD_CLONES
void weigh_row(const float* __restrict row, float weight, int width, float* __restrict out) {
  for (int i = 0; i < width; ++i) {
    out[i] = weight * row[i];
  }
}

SONARD_SIMD_CLONES
void add_pair(const float* before, const float* after, float weight, int width, float* __restrict out) {
  for (int i = 0; i < width; ++i) {
    out[i] += weight * (before[i] + after[i]);
  }
}

}  // namespace

RangeGrain::RangeGrain(double cell_m, double step_m) {
  std::vector<double> amplitudes{1.0};
  double power = 1.0;
  for (int j = 1; j <= most_lines_each_side && j * step_m < cell_m; ++j) {
    amplitudes.push_back(pulse_amplitude(j * step_m / cell_m));
    power += 2 * amplitudes.back() * amplitudes.back();
  }
  weights_.clear();
  std::transform(amplitudes.begin(), amplitudes.end(), std::back_inserter(weights_),
                 [&](double amplitude) { return static_cast<float>(amplitude / std::sqrt(power)); });
}

void RangeGrain::apply(const std::vector<const float*>& rows, int width, float* out) const {
  const auto middle = weights_.size() - 1;
  weigh_row(rows[middle], weights_[0], width, out);
  for (std::size_t j = 1; j < weights_.size(); ++j) {
    add_pair(rows[middle - j], rows[middle + j], weights_[j], width, out);
  }
}

}  // namespace sonard::render
