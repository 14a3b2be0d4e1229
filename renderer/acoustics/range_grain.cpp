#include "renderer/acoustics/range_grain.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/acoustics/sinc.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr int most_lines_each_side = 32;

using Pulse = PhysicalModel::Pulse;

/// Amplitude that is heard `lines` away from an echo, of any scale; 0 beyond the main lobe.
double pulse_amplitude(Pulse pulse, int lines, double line_cells) {
  const double cells = lines * line_cells;
  switch (pulse) {
    case Pulse::point:
      return lines == 0 ? 1.0 : 0.0;
    case Pulse::chirp:
      return cells < 1 ? sinc_at(cells) : 0.0;
    case Pulse::windowed_chirp:  // the transform of a Hann window
      return cells < 2 ? sinc_at(cells) + 0.5 * (sinc_at(cells - 1) + sinc_at(cells + 1)) : 0.0;
    case Pulse::tone:
      return std::max(0.0, std::min(0.5, cells + line_cells / 2) - std::max(-0.5, cells - line_cells / 2));
  }
  return 0.0;
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

RangeGrain::RangeGrain(Pulse pulse, double cell_m, double step_m) {
  if (!(cell_m > 0)) {
    return;
  }
  std::vector<double> amplitudes;
  double power = 0;
  for (int j = 0; j <= most_lines_each_side; ++j) {
    const double amplitude = pulse_amplitude(pulse, j, step_m / cell_m);
    if (!(amplitude > 0)) {
      break;
    }
    amplitudes.push_back(amplitude);
    power += (j == 0 ? 1 : 2) * amplitude * amplitude;
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
