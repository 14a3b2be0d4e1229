// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/speckle_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

// exp(-40) is below the resolution of a float: nothing is left. The limit keeps the sum of decays small, so
// that it still resolves the slightest motion.
constexpr double all_gone = 40;

SONARD_SIMD_CLONES
void evolve_row(const float* __restrict innovation, float keep, float fresh, int count,
                float* __restrict row) {
  for (int i = 0; i < count; ++i) {
    row[i] = keep * row[i] + fresh * innovation[i];
  }
}

}  // namespace

SpeckleField::SpeckleField(int beams) : beams_(beams), stride_(aligned_stride(beams)) {}

void SpeckleField::ensure_lines(int lines) {
  const auto count = static_cast<std::size_t>(lines);
  // evolved_at_ grows last: if memory runs out before, the next call tries both again.
  if (count > evolved_at_.size()) {
    field_.resize(at(lines), 0.0F);
    evolved_at_.resize(count, -std::numeric_limits<double>::infinity());
  }
}

void SpeckleField::fade(double decay) {
  last_decay_ = decay_;
  decay_ += std::min(decay, all_gone);
  last_step_ = step_of(decay_ - last_decay_);
}

SpeckleField::Step SpeckleField::step_of(double decay) {
  return {static_cast<float>(std::exp(-decay)), static_cast<float>(std::sqrt(-std::expm1(-2 * decay)))};
}

void SpeckleField::evolve(int line, const float* innovation_re, const float* innovation_im) {
  double& evolved_at = evolved_at_[static_cast<std::size_t>(line)];
  const Step step = evolved_at == last_decay_ ? last_step_ : step_of(decay_ - evolved_at);
  float* row = &field_[at(line)];
  evolve_row(innovation_re, step.keep, step.fresh, beams_, row);
  evolve_row(innovation_im, step.keep, step.fresh, beams_, row + stride_);
  evolved_at = decay_;
}

}  // namespace sonard::render
