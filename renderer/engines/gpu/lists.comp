// SPDX-License-Identifier: Apache-2.0
// The lists of triangles of each beam, in any order: SCAN makes room for them, in one group; otherwise they
// are filled.
layout(local_size_x = GROUP) in;
layout(std430, binding = 1) readonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 2) buffer Counts { PingCounts counts; };
layout(std430, binding = 3) buffer Beams { BeamList beams[]; };
layout(std430, binding = 0) writeonly buffer Lists { uint lists[]; };

#if SCAN
shared uint s_sum[GROUP];
void main() {
  uint lane = gl_LocalInvocationID.x, count = uint(ping.beams);
  uint each = (count + GROUP - 1u) / GROUP, begin = min(lane * each, count), end = min(begin + each, count);
  uint sum = 0u;
  for (uint beam = begin; beam < end; ++beam) {
    sum += beams[beam].count;
  }
  s_sum[lane] = sum;
  barrier();
  uint at = 0u;
  for (uint k = 0u; k < lane; ++k) {
    at += s_sum[k];
  }
  for (uint beam = begin; beam < end; ++beam) {
    beams[beam].begin = at;
    at += beams[beam].count;
  }
  if (lane == GROUP - 1u) {
    beams[count].begin = at;
    counts.entries = at;
  }
}
#else
void main() {
  if (!lists_have_room(counts)) {
    return;
  }
  uint stride = gl_NumWorkGroups.x * GROUP;
  for (uint i = gl_WorkGroupID.x * GROUP + gl_LocalInvocationID.x; i < counts.triangles; i += stride) {
    for (uint beam = fan[i].first_beam; beam <= fan[i].last_beam; ++beam) {
      lists[beams[beam].begin + atomicAdd(beams[beam].filled, 1u)] = i;
    }
  }
}
#endif
