// SPDX-License-Identifier: Apache-2.0
// Correlation of speckle and noise between neighbouring beams: the receive pattern as a filter across beams.
#pragma once

#include <vector>

#include "renderer/aperture.hpp"

namespace sonard::render {

/// Amplitude weights c_j, j = -half ... half, with sum c_j^2 = 1 (docs/physics.md 2.8). A white field
/// filtered with them has the correlation that a tapered receive array (LineArray), without element errors,
/// gives to independent element noise and to many scatterers. {1} if beams are too far apart to share
/// anything.
std::vector<float> receive_kernel(const Aperture& aperture);

/// A symmetric filter across beams.
class BeamFilter {
 public:
  BeamFilter() = default;
  /// @param kernel c_j, j = -half ... half, from receive_kernel(): an odd number of weights, c_j = c_-j
  BeamFilter(const std::vector<float>& kernel, int beams);

  int beams() const { return beams_; }
  /// True if beams share nothing: apply() then copies the middle of the row.
  bool copies() const { return copies_; }
  /// The numbers of a row that apply() copies if copies() is true.
  const float* middle(const float* row) const { return row + reach_; }
  /// Numbers that a row must hold to be filtered to `beams()`. Beyond the kernel's reach they have weight 0
  /// and must be finite.
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
