// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/beam_correlation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "renderer/acoustics/line_array.hpp"
#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

constexpr int most_taps_each_side = 16;

// Weights are taken four at a time, so that one pass over the row does the usual kernel of seven.
constexpr int weights_per_pass = 4;

/// The middle weight and the three pairs beside it.
SONARD_SIMD_CLONES
void begin_sum(const float* __restrict middle, const float* weights, int beams, float* __restrict out) {
  const float c0 = weights[0];
  const float c1 = weights[1];
  const float c2 = weights[2];
  const float c3 = weights[3];
  for (int b = 0; b < beams; ++b) {
    out[b] = (c0 * middle[b] + c1 * (middle[b - 1] + middle[b + 1])) +
             (c2 * (middle[b - 2] + middle[b + 2]) + c3 * (middle[b - 3] + middle[b + 3]));
  }
}

/// Four more pairs, `offset` and farther from the middle.
SONARD_SIMD_CLONES
void add_pairs(const float* __restrict middle, int offset, const float* weights, int beams,
               float* __restrict out) {
  const float* left = middle - offset;
  const float* right = middle + offset;
  const float c0 = weights[0];
  const float c1 = weights[1];
  const float c2 = weights[2];
  const float c3 = weights[3];
  for (int b = 0; b < beams; ++b) {
    out[b] += (c0 * (left[b] + right[b]) + c1 * (left[b - 1] + right[b + 1])) +
              (c2 * (left[b - 2] + right[b + 2]) + c3 * (left[b - 3] + right[b + 3]));
  }
}

}  // namespace

std::vector<float> receive_kernel(const Aperture& aperture) {
  const int beams = aperture.beam_count();
  if (beams < 2) {
    return {1.0F};
  }
  const LineArray array(aperture);
  const auto middle = static_cast<std::size_t>(beams / 2);
  const double spacing =
      std::sin(aperture.beam_edges_rad[middle]) - std::sin(aperture.beam_edges_rad[middle + 1]);
  // The main lobe of a Hamming taper ends at 4 / elements in sine.
  const int half = std::clamp(static_cast<int>(4.0 / array.elements() / spacing), 0, most_taps_each_side);
  std::vector<double> taps;
  double power = 0;
  for (int j = -half; j <= half; ++j) {
    taps.push_back(array.amplitude(j * spacing).real());
    power += taps.back() * taps.back();
  }
  std::vector<float> kernel;
  std::transform(taps.begin(), taps.end(), std::back_inserter(kernel),
                 [&](double tap) { return static_cast<float>(tap / std::sqrt(power)); });
  return kernel;
}

BeamFilter::BeamFilter(const std::vector<float>& kernel, int beams) : beams_(beams) {
  const std::size_t half = kernel.size() / 2;
  copies_ = half == 0 && kernel[0] == 1.0F;
  weights_.assign(kernel.begin() + static_cast<std::ptrdiff_t>(half), kernel.end());
  const std::size_t passes = half / weights_per_pass + 1;
  weights_.resize(passes * weights_per_pass, 0.0F);
  reach_ = static_cast<int>(weights_.size()) - 1;
}

void BeamFilter::apply(const float* row, float* out) const {
  const float* middle = row + reach_;
  begin_sum(middle, weights_.data(), beams_, out);
  for (int offset = weights_per_pass; offset <= reach_; offset += weights_per_pass) {
    add_pairs(middle, offset, &weights_[static_cast<std::size_t>(offset)], beams_, out);
  }
}

}  // namespace sonard::render
