// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/piece_ends.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/simd.hpp"

namespace sonard::render {

namespace {

// Relative difference of 1 / h below which surfaces touch: a millimetre or two, less than any line is long.
constexpr float touching = 1e-4F;

}  // namespace

void PieceEnds::run_straight(const std::vector<VisiblePiece>& pieces, float width_rad, float tan_limit,
                             PieceArrays& seen) {
  limit(width_rad, tan_limit, seen);
  find_surfaces(pieces, seen);
  for (std::size_t first = 0; first < seen.count;) {
    std::size_t last = first;
    while (goes_on_[last] != 0) {
      ++last;
    }
    keep_apart(first, last, width_rad, seen);
    first = last + 1;
  }
}

SONARD_SIMD_CLONES
void PieceEnds::limit(float width_rad, float tan_limit, PieceArrays& seen) {
  const std::size_t count = seen.count;
  const float* __restrict low = seen.low.data();
  const float* __restrict high = seen.high.data();
  float* __restrict low_drift = seen.low_drift.data();
  float* __restrict high_drift = seen.high_drift.data();
  const float* __restrict low_reach = seen.low_reach.data();
  const float* __restrict high_reach = seen.high_reach.data();
  for (std::size_t i = 0; i < count; ++i) {
    low_drift[i] = EdgeRun{low_drift[i], low_reach[i]}.drift_within(low[i], width_rad, tan_limit);
    high_drift[i] = EdgeRun{high_drift[i], high_reach[i]}.drift_within(high[i], width_rad, tan_limit);
  }
}

SONARD_SIMD_CLONES
void PieceEnds::find_surfaces(const std::vector<VisiblePiece>& pieces, const PieceArrays& seen) {
  const std::size_t count = seen.count;
  if (count > part_.size()) {
    part_.resize(seen.size());
    goes_on_.resize(seen.size());
  }
  for (std::size_t i = 0; i < count; ++i) {
    part_[i] = pieces[i].triangle->part;
  }
  const std::uint32_t* __restrict part = part_.data();
  const float* __restrict low = seen.low.data();
  const float* __restrict high = seen.high.data();
  const float* __restrict w_at_0 = seen.w_at_0.data();
  const float* __restrict w_slope = seen.w_slope.data();
  std::int32_t* __restrict goes_on = goes_on_.data();
  for (std::size_t i = 0; i + 1 < count; ++i) {
    const float t = high[i];
    const float w = w_at_0[i] + w_slope[i] * t, next = w_at_0[i + 1] + w_slope[i + 1] * t;
    goes_on[i] = ((t == low[i + 1]) & (part[i] == part[i + 1]) & (std::abs(w - next) < touching * w)) ? 1 : 0;
  }
  if (count > 0) {
    goes_on[count - 1] = 0;
  }
}

/// Of pieces first to last, which make up a surface that ends at both: from its ends inwards as far as pieces
/// cross.
void PieceEnds::keep_apart(std::size_t first, std::size_t last, float width_rad, PieceArrays& seen) {
  const auto most_of = [&](float length) { return 2 * length / width_rad; };
  const float whole = seen.high_drift[last] - seen.low_drift[first];
  const float most = most_of(seen.high[last] - seen.low[first]);
  if (std::abs(whole) > most) {  // all of it ends within the wedge
    const float excess = 0.5F * (whole - std::copysign(most, whole));
    seen.low_drift[first] += excess;
    seen.high_drift[last] -= excess;
  }
  const auto excess_of = [&](std::size_t i) {
    const float apart = seen.high_drift[i] - seen.low_drift[i];
    const float allowed = most_of(seen.high[i] - seen.low[i]);
    return apart > allowed ? apart - allowed : apart < -allowed ? apart + allowed : 0.0F;
  };
  for (std::size_t i = first; i < last; ++i) {
    const float excess = excess_of(i);
    if (excess == 0.0F) {
      break;
    }
    seen.high_drift[i] -= excess;
    seen.low_drift[i + 1] = seen.high_drift[i];
  }
  for (std::size_t i = last; i > first; --i) {
    const float excess = excess_of(i);
    if (excess == 0.0F) {
      break;
    }
    seen.low_drift[i] += excess;
    seen.high_drift[i - 1] = seen.low_drift[i];
  }
}

}  // namespace sonard::render
