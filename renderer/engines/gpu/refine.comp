// SPDX-License-Identifier: Apache-2.0
// One group for each beam: compares its slices with their neighbours, and divides those that disagree too much
// or miss something. As slice_refinement.cpp. A slice is fresh in the round after it was made.
#include "gpu/ping.glsl"
layout(location = 0) uniform int round_number;
layout(std430, binding = 0) coherent buffer Slices { Slice slices[]; };
// Of each parity of the round and each beam: the number of its slices, then these from port to starboard.
layout(std430, binding = 1) buffer Order { uint order[]; };
layout(std430, binding = 2) readonly buffer Sides { float sides[]; };
layout(std430, binding = 3) readonly buffer Things { Thing things[]; };
layout(std430, binding = 4) readonly buffer Edges { Edge edges[]; };
layout(std430, binding = 5) buffer Counts {
  PingCounts counts;
  Round rounds[most_rounds];
};
layout(std430, binding = 6) buffer Beams { Beam beams[]; };
layout(std430, binding = 7) readonly buffer Ends { ThingEnd ends[]; };

const uint none = 0xffffffffu;
shared uint s_parts[most_slices_of_beam];  // of each slice
shared float s_sums[4][GROUP];

uint beam, count;
Beam of_beam;

uint order_begin(int parity, uint of) {
  return (uint(parity) * uint(ping.beams) + of) * (most_slices_of_beam + 1u);
}
// The n-th slice of a beam.
uint slice_at(uint of, uint n) {
  return round_number == 0 ? beams[of].first_slice + n : order[order_begin(round_number & 1, of) + 1u + n];
}
uint slices_of(uint of) { return round_number == 0 ? beams[of].slices : order[order_begin(round_number & 1, of)]; }

bool is_fresh(uint number) {
  return number != none && number >= rounds[round_number].first_slice;
}

// The slice before the n-th of this beam, or `none`.
uint port_of(uint n) {
  return n > 0u ? slice_at(beam, n - 1u) : beam > 0u ? slice_at(beam - 1u, slices_of(beam - 1u) - 1u) : none;
}
uint starboard_of(uint n) {
  return n + 1u < count                ? slice_at(beam, n + 1u)
         : beam + 1u < uint(ping.beams) ? slice_at(beam + 1u, 0u)
                                        : none;
}

float share_of_beam(Slice slice) { return slice.width_rad / beams[slice.beam].width_rad; }

#include "gpu/borders_of_slices.glsl"
#include "gpu/missed_things.glsl"
#include "gpu/division_of_slices.glsl"

// Share of elevations at which the beam receives an echo, and the effective number of slices that share its
// error: weighted by squares, so that one slice much worse than the others counts alone.
vec2 errors_of_beam() {
  vec3 sums = vec3(0.0);
  for (uint n = begin_of_share(count, lane); n < begin_of_share(count, lane + 1u); ++n) {
    Slice slice = slices[slice_at(beam, n)];
    float share = share_of_beam(slice), error = share * worse_border(n, slice).mismatch;
    sums += vec3(share * slice.ensonified, error * error, error * error * error * error);
  }
  barrier();
  for (int k = 0; k < 3; ++k) {
    s_sums[k][lane] = sums[k];
  }
  barrier();
  sums = vec3(0.0);
  for (uint k = 0u; k < GROUP; ++k) {
    sums += vec3(s_sums[0][k], s_sums[1][k], s_sums[2][k]);
  }
  return vec2(max(sums.x, least_ensonified), sums.z > 0.0 ? sums.y * sums.y / sums.z : 1.0);
}

// Writes the number of parts of each slice into s_parts.
void choose_parts(vec2 beam_errors) {
  for (uint n = lane; n < count; n += GROUP) {
    uint number = slice_at(beam, n);
    Slice slice = slices[number];
    if (is_fresh(number)) {
      slice.missed_share = missed_height(slice) / (2.0 * ping.tan_limit);
      slices[number].missed_share = slice.missed_share;
    }
    Border border = worse_border(n, slice);
    SliceErrors errors =
        SliceErrors(share_of_beam(slice), beam_errors.x, beam_errors.y, border.mismatch, border.curvature,
                    border.shift_lines, slice.ensonified, slice.one_sided, slice.missed_share);
    s_parts[n] = uint(parts_of_slice(errors, ping.division));
    uint edges_inside = s_parts[n] > 1u ? edges_in(slice).count : 0u;
    s_parts[n] = edges_inside > 0u ? edges_inside + 1u : s_parts[n];
  }
  memoryBarrierBuffer();
  barrier();
}

void main() {
  beam = group_number();
  Round of_round = rounds[round_number];
  if (of_round.slices == 0u || !visible_have_room(counts.needed) ||
      of_round.first_slice + of_round.slices > ping.room.slices) {
    return;
  }
  of_beam = beams[beam];
  count = slices_of(beam);
  if (!compare_borders()) {
    keep_order();
    return;
  }
  choose_parts(errors_of_beam());
  divide_slices();
  report_cut_loops();
}
