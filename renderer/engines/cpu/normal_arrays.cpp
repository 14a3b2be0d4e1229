// SPDX-License-Identifier: Apache-2.0
#include "renderer/engines/cpu/normal_arrays.hpp"

namespace sonard::render {

void NormalArrays::lay_out(const std::vector<NormalRun>& runs, const std::vector<std::uint32_t>& original) {
  const std::size_t count = original.size();
  // at_h grows last: if memory runs out before, the next call tries all again.
  if (count > at_h.size()) {
    for (auto* array : {&at_s, &at_z, &h_per_x, &s_per_x, &z_per_x, &h_per_t, &s_per_t, &z_per_t, &at_h}) {
      array->resize(count + count / 2);
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const NormalRun& run = runs[original[i]];
    at_h[i] = run.at.x;
    at_s[i] = run.at.y;
    at_z[i] = run.at.z;
    h_per_x[i] = run.per_x.x;
    s_per_x[i] = run.per_x.y;
    z_per_x[i] = run.per_x.z;
    h_per_t[i] = run.per_t.x;
    s_per_t[i] = run.per_t.y;
    z_per_t[i] = run.per_t.z;
  }
}

}  // namespace sonard::render
