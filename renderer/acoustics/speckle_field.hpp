// SPDX-License-Identifier: Apache-2.0
// The field under the speckle of one sonar, kept from ping to ping.
#pragma once

#include <vector>

#include "renderer/aligned_vector.hpp"

namespace sonard::render {

/// Complex Gaussians CN(0, 1) per range bin and beam, correlated across beams by the array, that fade as the
/// sonar moves: an Ornstein-Uhlenbeck process (docs/physics.md 2.8). The kernel across beams is linear and
/// the same for every ping, so the filtered field is kept and fades just as the white field would.
///
/// Fading is lazy. A line stores the motion up to which it was evolved; later steps are made up for in one.
/// This is exact in distribution: exp(-d1) and then exp(-d2), each with a fresh innovation, is one step of
/// exp(-d1 - d2). Lines are independent, so threads may evolve different lines at the same time; only one
/// thread may call the other functions.
class SpeckleField {
 public:
  explicit SpeckleField(int beams = 0);

  /// Provides at least `lines` lines; new lines are empty and take the first innovation whole.
  void ensure_lines(int lines);
  /// All lines lose correlation: exp(-decay) of the field is left. @param decay >= 0
  void fade(double decay);

  /// True if the line has not faded since it was last evolved, so that evolve() is not needed.
  bool is_current(int line) const { return evolved_at_[static_cast<std::size_t>(line)] == decay_; }
  /// Brings the line up to date. @param innovation_re, innovation_im filtered CN(0, 1), `beams` numbers each,
  /// independent of all earlier ones of this line
  void evolve(int line, const float* innovation_re, const float* innovation_im);

  const float* real(int line) const { return &field_[at(line)]; }
  const float* imaginary(int line) const { return &field_[at(line)] + stride_; }

 private:
  /// Weights of the old field and of the innovation; the sum of their squares is 1.
  struct Step {
    float keep, fresh;
  };
  static Step step_of(double decay);

  std::size_t at(int line) const {
    return 2 * static_cast<std::size_t>(line) * static_cast<std::size_t>(stride_);
  }

  int beams_;
  int stride_;
  double decay_ = 0;                ///< sum of all fading so far
  double last_decay_ = 0;           ///< `decay_` before the last fading: the state of most lines
  Step last_step_{1.0F, 0.0F};      ///< from `last_decay_` to `decay_`
  std::vector<double> evolved_at_;  ///< per line: `decay_` when it was last evolved; -inf: never
  AlignedVector<float> field_;      ///< per line: a row of real and a row of imaginary parts
};

}  // namespace sonard::render
