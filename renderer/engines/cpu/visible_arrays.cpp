// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/visible_arrays.hpp"

namespace sonard::render {

void VisibleArrays::lay_out(const std::vector<VisibleSegment>& visible) {
  count = visible.size();
  // low grows last: if memory runs out before, the next call tries all again.
  if (count > size()) {
    part.resize(count + count / 2);
    for (auto* array : {&high, &low_slope, &high_slope, &low_reach, &high_reach, &w_at_0, &w_slope, &normal_h,
                        &normal_s, &normal_z, &low}) {
      array->resize(count + count / 2);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const VisibleSegment& segment = visible[i];
    low[i] = segment.low;
    high[i] = segment.high;
    low_slope[i] = segment.low_run.slope;
    high_slope[i] = segment.high_run.slope;
    low_reach[i] = segment.low_run.reach;
    high_reach[i] = segment.high_run.reach;
    w_at_0[i] = segment.w_at_0;
    w_slope[i] = segment.w_slope;
    normal_h[i] = segment.normal_h;
    normal_s[i] = segment.normal_s;
    normal_z[i] = segment.normal_z;
    part[i] = segment.part;
  }
}

}  // namespace sonard::render
