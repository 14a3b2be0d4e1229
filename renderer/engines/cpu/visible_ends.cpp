// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/visible_ends.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/simd.hpp"

namespace sonard::render {

void VisibleEnds::run_straight(float width_rad, float tan_limit, VisibleArrays& seen) {
  limit(width_rad, tan_limit, seen);
  find_surfaces(seen);
  for (std::size_t first = 0; first < seen.count;) {
    std::size_t last = first;
    while (goes_on_[last] != 0) {
      ++last;
    }
    keep_from_crossing(first, last, width_rad, seen);
    first = last + 1;
  }
}

SONARD_SIMD_CLONES
void VisibleEnds::limit(float width_rad, float tan_limit, VisibleArrays& seen) {
  const std::size_t count = seen.count;
  const float* __restrict low = seen.low.data();
  const float* __restrict high = seen.high.data();
  float* __restrict low_slope = seen.low_slope.data();
  float* __restrict high_slope = seen.high_slope.data();
  const float* __restrict low_reach = seen.low_reach.data();
  const float* __restrict high_reach = seen.high_reach.data();
  for (std::size_t i = 0; i < count; ++i) {
    low_slope[i] = slices::slope_within(low_slope[i], low_reach[i], low[i], width_rad, tan_limit);
    high_slope[i] = slices::slope_within(high_slope[i], high_reach[i], high[i], width_rad, tan_limit);
  }
}

SONARD_SIMD_CLONES
void VisibleEnds::find_surfaces(const VisibleArrays& seen) {
  const std::size_t count = seen.count;
  if (count > goes_on_.size()) {
    goes_on_.resize(seen.size());
  }
  const std::uint32_t* __restrict part = seen.part.data();
  const float* __restrict low = seen.low.data();
  const float* __restrict high = seen.high.data();
  const float* __restrict w_at_0 = seen.w_at_0.data();
  const float* __restrict w_slope = seen.w_slope.data();
  std::int32_t* __restrict goes_on = goes_on_.data();
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const float t = high[i];
    const float w = w_at_0[i] + w_slope[i] * t, next = w_at_0[i + 1] + w_slope[i + 1] * t;
    goes_on[i] = ((t == low[i + 1]) & (part[i] == part[i + 1]) & slices::is_one_surface(w, next)) ? 1 : 0;
  }
  if (count > 0) {
    goes_on[count - 1] = 0;
  }
}

/// Prevents crossings in the segments first to last, one surface that ends at both: from its ends inwards, as
/// far as there are crossings.
void VisibleEnds::keep_from_crossing(std::size_t first, std::size_t last, float width_rad,
                                     VisibleArrays& seen) {
  const float whole = seen.high_slope[last] - seen.low_slope[first];
  const float most = 2 * (seen.high[last] - seen.low[first]) / width_rad;
  if (std::abs(whole) > most) {  // the whole surface ends within the wedge
    const float excess = 0.5F * (whole - std::copysign(most, whole));
    seen.low_slope[first] += excess;
    seen.high_slope[last] -= excess;
  }
  const auto excess_of = [&](std::size_t i) {
    return slices::crossing_excess(seen.low_slope[i], seen.high_slope[i], seen.high[i] - seen.low[i],
                                   width_rad);
  };
  for (std::size_t i = first; i < last; ++i) {
    const float excess = excess_of(i);
    if (excess == 0.0F) {
      break;
    }
    seen.high_slope[i] -= excess;
    seen.low_slope[i + 1] = seen.high_slope[i];
  }
  for (std::size_t i = last; i > first; --i) {
    const float excess = excess_of(i);
    if (excess == 0.0F) {
      break;
    }
    seen.low_slope[i] += excess;
    seen.high_slope[i - 1] = seen.low_slope[i];
  }
}

}  // namespace sonard::render
