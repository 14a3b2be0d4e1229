// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/piece_arrays.hpp"

namespace sonard::render {

void PieceArrays::lay_out(const std::vector<VisiblePiece>& pieces) {
  count = pieces.size();
  if (count > size()) {
    for (auto* array : {&low, &high, &low_drift, &high_drift, &low_reach, &high_reach, &w_at_0, &w_slope,
                        &normal_h, &normal_s, &normal_z}) {
      array->resize(count + count / 2);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const VisiblePiece& piece = pieces[i];
    low[i] = piece.low;
    high[i] = piece.high;
    low_drift[i] = piece.low_run.drift;
    high_drift[i] = piece.high_run.drift;
    low_reach[i] = piece.low_run.reach;
    high_reach[i] = piece.high_run.reach;
    w_at_0[i] = piece.w_at_0;
    w_slope[i] = piece.w_slope;
    normal_h[i] = piece.normal_h;
    normal_s[i] = piece.normal_s;
    normal_z[i] = piece.normal_z;
  }
}

}  // namespace sonard::render
