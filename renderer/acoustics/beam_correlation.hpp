// SPDX-License-Identifier: Apache-2.0
// What neighbouring beams share of speckle and noise: the receive pattern as a filter across beams.
#pragma once

#include <vector>

#include "renderer/sonar_settings.hpp"

namespace sonard::render {

/// Amplitude weights c_j, j = -half ... half, with sum c_j^2 = 1. A white field filtered with them is what a
/// tapered receive array of the aperture (LineArray), without element errors, makes of independent element
/// noise, and of many scatterers (docs/physics.md 2.8). {1} where beams are too far apart to share anything.
std::vector<float> receive_kernel(const Aperture& aperture);

/// A symmetric filter across beams.
class BeamFilter {
 public:
  BeamFilter() = default;
  /// @param kernel c_j, j = -half ... half, as receive_kernel() makes it: an odd number of weights, c_j =
  /// c_-j.
  BeamFilter(const std::vector<float>& kernel, int beams);

  int beams() const { return beams_; }
  /// True: beams do not share anything, so that apply() copies the middle of the row.
  bool copies() const { return copies_; }
  /// The numbers of a row that apply() copies where copies() is true.
  const float* middle(const float* row) const { return row + reach_; }
  /// Numbers that a row must hold to be filtered to `beams()`. Beyond the kernel's own reach they are read
  /// with weight 0, so they need to be finite.
  int row_width() const { return beams_ + 2 * reach_; }

  /// out[b] = sum_j c_j row[b + reach + j], for all beams.
  void apply(const float* row, float* out) const;

  bool operator==(const BeamFilter&) const = default;

 private:
  int beams_ = 0;
  int reach_ = 0;
  bool copies_ = false;
  std::vector<float> weights_;  ///< c_0 ... c_reach, zero beyond the kernel
};

}  // namespace sonard::render
