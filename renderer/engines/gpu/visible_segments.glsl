// SPDX-License-Identifier: Apache-2.0
// From what the pieces of the sweep have seen to visible segments, for see.comp.

uint seen_count;  // by all pieces

shared uint s_before[GROUP];  // seen before each piece

// Puts what all pieces have seen in order into s_bucket. All invocations must call it.
void order_seen() {
  seen_count = s_lost != 0u ? 0u : min(s_used, most_seen);
  memoryBarrierBuffer();
  uint all, before = sum_before(emitted, all);
  s_before[lane] = before;
  barrier();
  for (uint k = lane; k < seen_count; k += GROUP) {
    uint place_of = scratch[s_base + k].place;
    s_bucket[s_before[place_of >> 16] + (place_of & 0xffffu)] = k;
  }
  barrier();
}

Seen seen_at(uint i) {
  return scratch[s_base + s_bucket[i]];
}

// True if a segment goes on from the piece before.
bool continues(uint i) {
  Seen seen = seen_at(i);
  return i > 0u && seen.segment == seen_at(i - 1u).segment && seen.low == seen_at(i - 1u).high;
}

// First index after i of what does not continue it.
uint next_after(uint i) {
  do {
    ++i;
  } while (i < seen_count && continues(i));
  return i;
}

float end_of(uint i) {
  return seen_at(next_after(i) - 1u).high;
}

// True if a segment is visible only through a gap in a surface, which a dropped segment left
// (SliceSweep::close_gaps()).
bool is_gap(uint i, float high) {
  Seen seen = seen_at(i);
  if (i == 0u || !(high - seen.low < 2.0 * shortest_rad * (1.0 + seen.low * seen.low))) {
    return false;
  }
  uint next = next_after(i);
  if (next == seen_count) {
    return false;
  }
  Seen before = seen_at(i - 1u), behind = seen_at(next);
  float w = s_w_at_0[seen.segment] + s_w_slope[seen.segment] * seen.low;
  return before.high == seen.low && high == behind.low &&
         s_w_at_0[before.segment] + s_w_slope[before.segment] * seen.low > w * (1.0 + touching) &&
         s_w_at_0[behind.segment] + s_w_slope[behind.segment] * high > w * (1.0 + touching);
}

vec3 normal_of(uint segment) {
  Corner corners[3] = fan[s_triangle[segment]].corners, a = corners[0];
  vec3 b = vec3(corners[1].x - a.x, corners[1].y - a.y, corners[1].z - a.z);
  vec3 c = vec3(corners[2].x - a.x, corners[2].y - a.y, corners[2].z - a.z);
  precise vec3 n = vec3(b.y * c.z - b.z * c.y, b.z * c.x - b.x * c.z, b.x * c.y - b.y * c.x);
  precise float scale = 1.0 / sqrt(n.x * n.x + n.y * n.y + n.z * n.z + 1e-36);
  n *= scale;
  precise vec3 turned =
      vec3(n.x * slice.cosine + n.y * slice.sine, n.y * slice.cosine - n.x * slice.sine, n.z);
  return turned;
}

// Motion of the common end of two visible segments at a crossing, along the line in which their planes
// intersect: slope and reach (SliceSweep::follow_crossings()).
vec2 run_of_crossing(uint before, float before_low, uint after, float after_high, float at) {
  vec3 along = cross(normal_of(before), normal_of(after));
  float slope = (along.z - at * along.x) / along.y;
  bool finite = abs(slope) < never;
  return finite ? vec2(slope, max(at - before_low, after_high - at)) : vec2(0.0);
}

// Motion of the place `at` where `before` gives way to `after`, each the index of what was seen, or `none`.
vec2 run_between(uint before, uint after, float at) {
  if (at == band_low || at == band_high) {
    return vec2(0.0);
  }
  bool before_ends = before != none && at == s_high[seen_at(before).segment];
  if (before_ends || (after != none && at == s_low[seen_at(after).segment])) {
    CutTriangle cut = cut_ahead(fan[s_triangle[seen_at(before_ends ? before : after).segment]]);
    vec2 run = before_ends ? vec2(cut.high_slope, cut.high_reach) : vec2(cut.low_slope, cut.low_reach);
    return cut.fate == cut_keeps ? run : vec2(0.0);  // no motion where clip_behind() has cut
  }
  if (before == none || after == none) {
    return vec2(0.0);
  }
  return run_of_crossing(seen_at(before).segment, seen_at(before).low, seen_at(after).segment, end_of(after),
                         at);
}

// First index of what continues until i.
uint begin_of(uint i) {
  while (continues(i)) {
    --i;
  }
  return i;
}

void write_visible(uint i, uint to) {
  Seen seen = seen_at(i);
  float high = end_of(i);
  uint before = i > 0u && seen_at(i - 1u).high == seen.low ? begin_of(i - 1u) : none;
  uint next = next_after(i);
  next = next < seen_count && seen_at(next).low == high ? next : none;
  vec2 ends[2];
  for (int end = 0; end < 2; ++end) {
    ends[end] = run_between(end == 0 ? before : i, end == 0 ? i : next, end == 0 ? seen.low : high);
  }
  vec3 normal = normal_of(seen.segment);
  visible[to] = Visible(seen.low, high, s_w_at_0[seen.segment], s_w_slope[seen.segment], ends[0].x, ends[0].y,
                        ends[1].x, ends[1].y, normal.x, normal.y, normal.z, s_triangle[seen.segment]);
}

bool is_written(uint i) {
  return !continues(i) && !is_gap(i, end_of(i));
}
