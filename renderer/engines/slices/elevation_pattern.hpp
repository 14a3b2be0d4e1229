// SPDX-License-Identifier: Apache-2.0
// The elevation pattern of a sonar, for slices.
#pragma once

#include <vector>

#include "renderer/aperture.hpp"

namespace sonard::render {

/// Table of the elevation pattern as a function of t.
class ElevationPattern {
 public:
  /// @param tabled_if_flat also tables a pattern that is 1 everywhere (SkipRule::flat_elevation off)
  explicit ElevationPattern(const Aperture& aperture, bool tabled_if_flat = false);
  bool flat() const { return weight_.empty(); }
  bool varies() const { return varies_; }

  /// Weights at steps + 1 even places of t from -tan_limit to tan_limit; the index of t is
  /// step_at_0() + t * steps_per_t().
  static constexpr int steps = 1024;
  const float* table() const { return weight_.data(); }
  float steps_per_t() const { return 0.5F * static_cast<float>(weight_.size() - 1) / tan_limit_; }
  float step_at_0() const { return 0.5F * static_cast<float>(weight_.size() - 1); }

 private:
  float tan_limit_;
  bool varies_;
  std::vector<float> weight_;  ///< empty: 1 everywhere
};

}  // namespace sonard::render
