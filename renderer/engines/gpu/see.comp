// SPDX-License-Identifier: Apache-2.0
// One group for each slice: cuts the triangles of its beam, finds what is visible by a sweep from the lowest
// elevation to the highest, and what it expects at the sides of its wedge. As SliceCutter, SliceSweep and
// SideExpectation.
//
// The sweep is divided into pieces, one for each invocation: piece k begins where the segment k n / GROUP of
// the n sorted ones begins, with all segments waiting that reach over this place. A slice with more segments
// than there is room for is seen in bands of elevation, one after the other.
#include "gpu/ping.glsl"
layout(std430, binding = 0) buffer Slices { Slice slices[]; };
layout(std430, binding = 1) coherent buffer VisibleSegments { Visible visible[]; };
layout(std430, binding = 2) coherent buffer Scratch { Seen scratch[]; };
layout(std430, binding = 3) readonly buffer Lists { uint lists[]; };
layout(std430, binding = 4) readonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 5) buffer Counts {
  PingCounts counts;
  Round rounds[most_rounds];
};
layout(std430, binding = 6) readonly buffer Beams { Beam beams[]; };
layout(std430, binding = 7) buffer Sides { float sides[]; };  // of each slice, port and starboard: 1 / h at the probes

const uint room = uint(ROOM);  // segments of a band
const uint none = 0xffffffffu;
const uint block = 16u;
shared float s_low[room], s_high[room], s_w_at_0[room], s_w_slope[room];
shared uint s_number[room], s_triangle[room];  // of the ping
shared uint s_order[room];
shared uint s_bucket[room > uint(side_probes) ? room : uint(side_probes)];
shared float s_block_high[room / block + 1u];  // largest high end of 16 segments
shared uint s_found, s_used, s_base, s_lost;

Slice slice;
float band_low, band_high;  // elevations of the band, as tangents
uint count;                 // of segments in the band

#include "gpu/cut_triangles.glsl"
#include "gpu/sort_segments.glsl"
#include "gpu/sweep_piece.glsl"
#include "gpu/visible_segments.glsl"
#include "gpu/sides_of_slice.glsl"

uint written_before;  // visible segments, by the invocations before this one

// Sees the band, and orders what is visible in it for write_band(). All invocations must call it.
// @return number of visible segments in the band
uint see_band() {
  seen_count = 0u;
  if (count == 0u) {
    return 0u;
  }
  sort_segments();
  most_seen = min(room, 2u * count + 16u);
  if (lane == 0u) {
    s_used = 0u;
    s_base = atomicAdd(counts.needed.scratch, most_seen);
    atomicAdd(counts.segments, count);
  }
  barrier();
  if (s_base + most_seen > ping.room.scratch || loops_are_cut()) {
    return 0u;
  }
  float from = border_of(lane), until = border_of(lane + 1u);
  emitted = 0u;
  if (from < until) {
    sweep(from, until);
  }
  barrier();
  order_seen();
  uint written = 0u, total;
  for (uint i = begin_of_share(seen_count, lane); i < begin_of_share(seen_count, lane + 1u); ++i) {
    written += is_written(i) ? 1u : 0u;
  }
  written_before = sum_before(written, total);
  return total;
}

void write_band(uint first) {
  uint to = first + written_before;
  for (uint i = begin_of_share(seen_count, lane); i < begin_of_share(seen_count, lane + 1u); ++i) {
    if (is_written(i)) {
      write_visible(i, to++);
    }
  }
}

// Cuts and sees the band. All invocations must call it. @return false: it has too many segments
bool try_band(out uint total) {
  barrier();
  if (lane == 0u) {
    s_found = s_lost = 0u;
  }
  barrier();
  cut_triangles();
  barrier();
  count = s_found;
  total = count > room ? 0u : see_band();
  barrier();
  return count <= room && s_lost == 0u;
}

// Sees the slice in one band, which is usual, or in several: a band with too many segments is halved. All
// invocations must call it.
void see_bands() {
  const int most_tries = 64;
  uint most_visible = 0u, written = 0u, of_band;
  band_low = -ping.tan_limit;
  band_high = ping.tan_limit;
  for (int tries = 0; band_low < ping.tan_limit && tries < most_tries; ++tries) {
    bool is_whole = try_band(of_band);
    if (tries == 0) {
      most_visible = is_whole ? of_band : 2u * count;
      if (lane == 0u) {
        atomicMax(counts.longest_slice, is_whole ? count : room + 1u);
        s_found = atomicAdd(counts.needed.visible, most_visible);
      }
      barrier();
      slice.first_visible = s_found;
      barrier();
      if (slice.first_visible + most_visible > ping.room.visible) {
        return;
      }
    }
    if (!is_whole) {
      band_high = band_low + 0.5 * (band_high - band_low);
      continue;
    }
    if (written + of_band > most_visible) {
      break;
    }
    write_band(slice.first_visible + written);
    written += of_band;
    band_low = band_high;
    band_high = ping.tan_limit;
  }
  slice.visible_count = written;
  if (lane == 0u && band_low < ping.tan_limit) {
    atomicAdd(counts.overflows, 1u);
  }
}

layout(location = 0) uniform int round_number;

void main() {
  Round of_round = rounds[round_number];
  uint number = of_round.first_slice + gl_WorkGroupID.x;
  if (number >= ping.room.slices || !lists_have_room(counts.needed)) {
    return;
  }
  slice = slices[number];
  if ((slice.state & is_seen) == 0u) {
    see_bands();
    slice.state |= is_seen;
  }
  memoryBarrierBuffer();
  barrier();
  if (ping.division.most_divisions > 1) {
    uint first = 2u * number * uint(side_probes);
    for (uint side = 0u; side < 2u; ++side) {
      find_side(first + side * uint(side_probes), (side == 0u ? 0.5 : -0.5) * slice.width_rad);
    }
    summarise_sides(first, first + uint(side_probes));
  }
  if (lane == 0u) {
    slices[number] = slice;
  }
  report_cut_loops();
}
