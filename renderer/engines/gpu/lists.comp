// SPDX-License-Identifier: Apache-2.0
// The lists of triangles of each beam, in any order: SCAN makes room for them, in one group; otherwise they
// are filled.
#include "gpu/ping.glsl"
layout(std430, binding = 0) writeonly buffer Lists { uint lists[]; };
layout(std430, binding = 1) readonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 2) buffer Counts { PingCounts counts; };
layout(std430, binding = 3) buffer Beams { Beam beams[]; };

#if SCAN
void main() {
  uint count = uint(ping.beams), begin = begin_of_share(count, lane), end = begin_of_share(count, lane + 1u), sum = 0u;
  for (uint beam = begin; beam < end; ++beam) {
    sum += beams[beam].count;
  }
  uint all, at = sum_before(sum, all);
  for (uint beam = begin; beam < end; ++beam) {
    beams[beam].begin = at;
    at += beams[beam].count;
  }
  if (lane == 0u) {
    beams[count].begin = all;
    counts.needed.entries = all;
  }
}
#else
void main() {
  if (!lists_have_room(counts.needed)) {
    return;
  }
  uint stride = gl_NumWorkGroups.x * GROUP;
  for (uint i = gl_WorkGroupID.x * GROUP + lane; i < counts.needed.triangles; i += stride) {
    for (uint beam = fan[i].first_beam; beam <= fan[i].last_beam; ++beam) {
      lists[beams[beam].begin + atomicAdd(beams[beam].filled, 1u)] = i;
    }
  }
  report_cut_loops();
}
#endif
