#include "renderer/acoustics/beam_filter.hpp"

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

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
