// SPDX-License-Identifier: Apache-2.0
// Visible segments as arrays, because loops over them are vectorised.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "renderer/engines/cpu/slice_sweep.hpp"

namespace sonard::render {

/// What VisibleSegment says, an array for each number. Arrays never shrink: they may be longer than there are
/// segments.
struct VisibleArrays {
  std::size_t count = 0;  ///< of segments
  std::vector<float> low, high, low_slope, high_slope, low_reach, high_reach;
  std::vector<float> w_at_0, w_slope, normal_h, normal_s, normal_z;
  std::vector<std::uint32_t> part;

  /// How long the arrays are.
  std::size_t size() const { return low.size(); }
  void lay_out(const std::vector<VisibleSegment>& visible);
};

}  // namespace sonard::render
