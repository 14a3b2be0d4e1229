// SPDX-License-Identifier: Apache-2.0
// What a slice expects at the sides of its wedge, for see.comp. As SideExpectation.

// Writes what the slice expects at one side of its wedge, `offset_rad` from its middle, into `sides`.
void find_side(uint out_begin, float offset_rad) {
  for (uint k = lane; k < uint(side_probes); k += GROUP) {
    s_bucket[k] = 0u;
  }
  barrier();
  for (uint i = lane; i < slice.visible_count; i += GROUP) {
    Visible v = visible[slice.first_visible + i];
    float low_slope = slope_within(v.low_slope, v.low_reach, v.low, slice.width_rad, ping.tan_limit);
    float high_slope = slope_within(v.high_slope, v.high_reach, v.high, slice.width_rad, ping.tan_limit);
    int first = probe_above(v.low + low_slope * offset_rad, ping.tan_limit);
    int last = probe_above(v.high + high_slope * offset_rad, ping.tan_limit);
    for (int k = first; k < last; ++k) {
      atomicMax(s_bucket[k], i + 1u);
    }
  }
  barrier();
  float probes = probe_step(ping.tan_limit);
  for (uint k = lane; k < uint(side_probes); k += GROUP) {
    float w = 0.0;
    if (s_bucket[k] > 0u) {
      Visible v = visible[slice.first_visible + s_bucket[k] - 1u];
      float low_slope = slope_within(v.low_slope, v.low_reach, v.low, slice.width_rad, ping.tan_limit);
      int first = probe_above(v.low + low_slope * offset_rad, ping.tan_limit);
      float per_azimuth =
          w_per_azimuth(v.w_at_0, v.w_slope, v.normal_h, v.normal_s, v.normal_z, 0.5 * (v.low + v.high));
      precise float at_first = v.w_at_0 + per_azimuth * offset_rad +
                               v.w_slope * (first_probe(ping.tan_limit) + float(first) * probes);
      precise float here = at_first + v.w_slope * probes * float(int(k) - first);
      w = here;
    }
    sides[out_begin + k] = w;
  }
  barrier();
}

shared int s_in_range[2];
shared uint s_nearest, s_furthest;  // bits of ranges, which have the order of the ranges

// As summarise() of SideExpectation.
void summarise_sides(uint port, uint starboard) {
  if (lane == 0u) {
    s_in_range[0] = s_in_range[1] = 0;
    s_nearest = floatBitsToUint(ping.bins_end_m);
    s_furthest = 0u;
  }
  barrier();
  for (uint k = lane; k < uint(side_probes); k += GROUP) {  // those that find_side() wrote in this invocation
    float t = probe_at(ping.tan_limit, int(k)), secant = sqrt(1.0 + t * t);
    for (uint side = 0u; side < 2u; ++side) {
      float w = sides[(side == 0u ? port : starboard) + k];
      if (secant < ping.bins_end_m * w) {
        atomicAdd(s_in_range[side], probe_weight(k));
        atomicMin(s_nearest, floatBitsToUint(secant / w));
        atomicMax(s_furthest, floatBitsToUint(secant / w));
      }
    }
  }
  barrier();
  float all = float(side_probes) * probe_weight_unit;
  slice.ensonified = float(s_in_range[0] + s_in_range[1]) / (2.0 * all);
  slice.one_sided = float(abs(s_in_range[0] - s_in_range[1])) / all;
  slice.lines = max(0.0, uintBitsToFloat(s_furthest) - uintBitsToFloat(s_nearest)) / ping.line_m;
}
