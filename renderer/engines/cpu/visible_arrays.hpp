// SPDX-License-Identifier: Apache-2.0
// Visible segments as arrays, for vectorised loops.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/slice_sweep.hpp"

namespace sonard::render {

/// The numbers of VisibleSegment, one array each. Arrays never shrink, so they may be longer than the number
/// of segments.
struct VisibleArrays {
  std::size_t count = 0;  ///< of segments
  std::vector<float> low, high, low_slope, high_slope, low_reach, high_reach;
  std::vector<float> w_at_0, w_slope, normal_h, normal_s, normal_z;
  std::vector<std::uint32_t> part;

  /// Length of the arrays, >= count.
  std::size_t size() const { return low.size(); }
  void lay_out(const std::vector<VisibleSegment>& visible);
};

}  // namespace sonard::render
