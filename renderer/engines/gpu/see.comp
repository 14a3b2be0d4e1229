// SPDX-License-Identifier: Apache-2.0
// One group for each slice: cuts the triangles of its beam, finds what is visible by a sweep from the lowest
// elevation to the highest, and what it expects at the sides of its wedge. As SliceCutter, SliceSweep and
// SideExpectation.
//
// The sweep is divided into pieces, one for each invocation: piece k begins where the segment k n / GROUP of
// the n sorted ones begins, with all segments waiting that reach over this place. A slice with more segments
// than there is room for is seen in bands of elevation, one after the other.
layout(local_size_x = GROUP) in;

struct Seen {  // by one piece
  float low, high;
  uint segment, place;  // place: piece and number within it
};
layout(std430, binding = 0) buffer Slices { Slice slices[]; };
layout(std430, binding = 1) coherent buffer VisibleSegments { Visible visible[]; };
layout(std430, binding = 2) coherent buffer Scratch { Seen scratch[]; };
layout(std430, binding = 3) readonly buffer Lists { uint lists[]; };
layout(std430, binding = 4) readonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 5) buffer Counts {
  PingCounts counts;
  Round rounds[most_rounds];
};
layout(std430, binding = 6) readonly buffer Beams { BeamList beams[]; };
layout(std430, binding = 7) buffer Sides { float sides[]; };  // of each slice, port and starboard: 1 / h at the probes

const uint room = uint(ROOM);  // segments of a band
const uint none = 0xffffffffu;
const uint block = 16u;
shared float s_low[room], s_high[room], s_w_at_0[room], s_w_slope[room];
shared uint s_number[room], s_triangle[room];  // of the ping
shared uint s_order[room];
shared uint s_bucket[room > uint(side_probes) ? room : uint(side_probes)];
shared float s_block_high[room / block + 1u];  // largest high end of 16 segments
shared uint s_count[GROUP];
shared uint s_found, s_used, s_base, s_lost;

Slice slice;
float band_low, band_high;  // elevations of the band, as tangents
uint lane, count;           // of segments in the band

// ---- cut ----

// Numbers as unevaluated sums of two floats, with 48 bits: what a ground of a few large triangles needs.
vec2 two_sum(float a, float b) {
  precise float sum = a + b;
  precise float of_b = sum - a;
  precise float rest = (a - (sum - of_b)) + (b - of_b);
  return vec2(sum, rest);
}
vec2 two_product(float a, float b) {
  const float splitter = 4097.0;
  precise float a_big = splitter * a, b_big = splitter * b;
  precise float a_high = a_big - (a_big - a), b_high = b_big - (b_big - b);
  precise float a_low = a - a_high, b_low = b - b_high;
  precise float product = a * b;
  precise float rest = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
  return vec2(product, rest);
}
vec2 add(vec2 a, vec2 b) {
  vec2 sum = two_sum(a.x, b.x);
  precise float rest = sum.y + (a.y + b.y);
  return two_sum(sum.x, rest);
}
vec2 multiply(vec2 a, vec2 b) {
  vec2 product = two_product(a.x, b.x);
  precise float rest = product.y + (a.x * b.y + a.y * b.x);
  return two_sum(product.x, rest);
}
vec2 divide(vec2 a, vec2 b) {
  precise float first = a.x / b.x;
  vec2 left = add(a, -multiply(vec2(first, 0.0), b));
  precise float second = left.x / b.x;
  return two_sum(first, second);
}

// A triangle that crosses the slice behind the vertical axis too (SliceCutter::clip_behind()).
CutTriangle clip_behind(FanTriangle of) {
  vec3 corners[3] =
      vec3[3](vec3(of.x0, of.y0, of.z0), vec3(of.x1, of.y1, of.z1), vec3(of.x2, of.y2, of.z2));
  CutTriangle cut;
  cut.fate = cut_misses;
  vec2 s[3], h[3], end_h[2], end_z[2];
  for (int k = 0; k < 3; ++k) {
    s[k] = add(two_product(corners[k].y, slice.cosine), -two_product(corners[k].x, slice.sine));
    h[k] = add(two_product(corners[k].x, slice.cosine), two_product(corners[k].y, slice.sine));
  }
  int ends = 0;
  for (int k = 0; k < 3 && ends < 2; ++k) {
    int j = (k + 1) % 3;
    if ((s[k].x >= 0.0) != (s[j].x >= 0.0)) {
      vec2 share = divide(s[k], add(s[k], -s[j]));
      end_h[ends] = add(h[k], multiply(add(h[j], -h[k]), share));
      end_z[ends++] = add(vec2(corners[k].z, 0.0), multiply(two_sum(corners[j].z, -corners[k].z), share));
    }
  }
  if (ends < 2 || max(end_h[0].x, end_h[1].x) <= nearest_m) {
    return cut;
  }
  int back = end_h[0].x < end_h[1].x ? 0 : 1;
  if (end_h[back].x < nearest_m) {
    vec2 share = divide(add(vec2(nearest_m, 0.0), -end_h[back]), add(end_h[1 - back], -end_h[back]));
    end_z[back] = add(end_z[back], multiply(add(end_z[1 - back], -end_z[back]), share));
    end_h[back] = vec2(nearest_m, 0.0);
  }
  vec2 t[2] = vec2[2](divide(end_z[0], end_h[0]), divide(end_z[1], end_h[1]));
  int lower = t[0].x < t[1].x ? 0 : 1;
  cut.low = t[lower].x;
  cut.high = t[1 - lower].x;
  if (!(cut.high - cut.low > shortest_rad * (1.0 + cut.low * cut.low)) || cut.high < -ping.tan_limit ||
      cut.low > ping.tan_limit) {
    return cut;
  }
  vec2 one = vec2(1.0, 0.0), w_low = divide(one, end_h[lower]);
  vec2 steepness = divide(add(divide(one, end_h[1 - lower]), -w_low), add(t[1 - lower], -t[lower]));
  cut.w_slope = steepness.x;
  cut.w_at_0 = add(w_low, -multiply(steepness, t[lower])).x;
  cut.low_slope = cut.high_slope = cut.low_reach = cut.high_reach = 0.0;
  cut.fate = cut_keeps;
  return cut;
}

CutTriangle cut_ahead(FanTriangle t) {
  return cut_triangle(Corner(t.x0, t.y0, t.z0), Corner(t.x1, t.y1, t.z1), Corner(t.x2, t.y2, t.z2), slice.cosine,
                      slice.sine, ping.tan_limit);
}

void cut_triangles() {
  uint end = min(beams[slice.beam + 1].begin, uint(ping.most_entries));
  for (uint i = beams[slice.beam].begin + lane; i < end; i += GROUP) {
    FanTriangle t = fan[lists[i]];
    if (ping.two_sided == 0 && (t.flags & is_back_face) != 0u) {
      continue;
    }
    CutTriangle cut = cut_ahead(t);
    if (cut.fate == cut_is_partly_behind) {
      cut = clip_behind(t);
    }
    if (cut.fate != cut_keeps || !(cut.high > band_low && cut.low < band_high)) {
      continue;
    }
    uint at = atomicAdd(s_found, 1u);
    if (at < room) {
      s_low[at] = cut.low;
      s_high[at] = cut.high;
      s_w_at_0[at] = cut.w_at_0;
      s_w_slope[at] = cut.w_slope;
      s_number[at] = t.number;
      s_triangle[at] = lists[i];
    }
  }
}

// ---- sort by low end, then by number ----

uint bucket_of(float low) {
  precise float at = (low - band_low) * (float(count) / (band_high - band_low));  // the same at each call
  return uint(clamp(at, 0.0, float(count - 1u)));
}

bool comes_before(uint a, uint b) {
  return s_low[a] < s_low[b] || (s_low[a] == s_low[b] && s_number[a] < s_number[b]);
}

// Exclusive sums of s_count in place. All invocations must call it.
void sum_counts() {
  barrier();
  uint before = 0u;
  for (uint k = 0u; k < lane; ++k) {
    before += s_count[k];
  }
  barrier();
  s_count[lane] = before;
  barrier();
}

// Sets s_order: a counting sort into as many buckets as there are segments, then ranks within each bucket.
void sort_segments() {
  for (uint k = lane; k < count; k += GROUP) {
    s_bucket[k] = 0u;
  }
  barrier();
  for (uint k = lane; k < count; k += GROUP) {
    atomicAdd(s_bucket[bucket_of(s_low[k])], 1u);
  }
  barrier();
  uint each = (count + GROUP - 1u) / GROUP, begin = min(lane * each, count), end = min(begin + each, count);
  uint sum = 0u;
  for (uint k = begin; k < end; ++k) {
    sum += s_bucket[k];
  }
  s_count[lane] = sum;
  sum_counts();
  uint before = s_count[lane];
  for (uint k = begin; k < end; ++k) {
    uint here = s_bucket[k];
    s_bucket[k] = before;
    before += here;
  }
  barrier();
  for (uint k = lane; k < count; k += GROUP) {
    s_order[atomicAdd(s_bucket[bucket_of(s_low[k])], 1u)] = k;  // s_bucket then has the ends
  }
  barrier();
  const uint most = (room + GROUP - 1u) / GROUP;
  uint rank[most], element[most], n = 0u;
  for (uint at = lane; at < count; at += GROUP, ++n) {
    uint k = s_order[at], bucket = bucket_of(s_low[k]);
    uint from = bucket == 0u ? 0u : s_bucket[max(bucket, 1u) - 1u], to = s_bucket[bucket];
    rank[n] = from;
    element[n] = k;
    for (uint j = from; j < to; ++j) {
      rank[n] += comes_before(s_order[j], k) ? 1u : 0u;
    }
  }
  barrier();
  n = 0u;
  for (uint at = lane; at < count; at += GROUP, ++n) {
    s_order[rank[n]] = element[n];
  }
  barrier();
  for (uint b = lane; b * block < count; b += GROUP) {
    float highest = -never;
    for (uint k = b * block; k < min(count, b * block + block); ++k) {
      highest = max(highest, s_high[s_order[k]]);
    }
    s_block_high[b] = highest;
  }
  barrier();
}

// ---- sweep ----

const uint most_waiting = uint(WAITING);
uint waiting[most_waiting];
uint waits, current, crosser, next, emitted;
float crossing, t;
uint seen_count, most_seen;  // by all pieces; most_seen: room in `scratch`

Line line_of(uint k) { return Line(int(s_number[k]), s_high[k], s_w_at_0[k], s_w_slope[k]); }

float start_of(uint k) { return k < count ? max(band_low, s_low[s_order[k]]) : never; }

void wait_for(uint segment) {
  if (waits < most_waiting) {
    waiting[waits++] = segment;
  } else {
    s_lost = 1u;
  }
}

void find_next_crossing() {
  crossing = never;
  for (uint k = 0u; k < waits; ++k) {
    float at = s_high[waiting[k]] > t ? crossing_of(line_of(current), line_of(waiting[k]), t) : never;
    if (at < crossing) {
      crossing = at;
      crosser = k;
    }
  }
}

// Makes the nearest of all segments at t the current one.
void take_nearest() {
  while (next < count && start_of(next) <= t) {
    wait_for(s_order[next++]);
  }
  uint kept = 0u, best = 0u;
  for (uint k = 0u; k < waits; ++k) {
    uint candidate = waiting[k];
    if (!(s_high[candidate] > t)) {
      continue;
    }
    waiting[kept] = candidate;
    if (kept > 0u) {
      Line a = line_of(candidate), b = line_of(waiting[best]);
      if (is_seen_first(a, b, t, crossing_of(a, b, t))) {
        best = kept;
      }
    }
    ++kept;
  }
  waits = kept;
  if (kept > 0u) {
    current = waiting[best];
    waiting[best] = waiting[--waits];
  }
}

void emit(float until) {
  if (!(until > t)) {
    return;
  }
  uint at = atomicAdd(s_used, 1u);
  if (at < most_seen) {
    scratch[s_base + at] = Seen(t, until, current, lane << 16 | emitted);
  } else {
    s_lost = 1u;
  }
  ++emitted;
  t = until;
}

// Number of segments that begin before `from`.
uint count_before(float from) {
  uint begin = 0u, end = count;
  while (begin < end) {
    uint middle = (begin + end) / 2u;
    if (start_of(middle) < from) {
      begin = middle + 1u;
    } else {
      end = middle;
    }
  }
  return begin;
}

// The next segment that began before the piece and reaches over its begin, or `none`. Then next is `earlier`.
uint take_earlier(uint earlier) {
  while (next < earlier) {
    if (next % block == 0u && !(s_block_high[next / block] > t)) {
      next = min(next + block, earlier);
    } else if (s_high[s_order[next]] > t) {
      return s_order[next++];
    } else {
      ++next;
    }
  }
  return none;
}

// As SliceSweep::run(), from the begin of a piece to its end. At the begin it meets all segments that began
// earlier.
void sweep(float from, float until) {
  waits = next = 0u;
  current = none;
  t = from;
  bool crossing_is_known = false;
  uint earlier = lane > 0u ? count_before(from) : 0u;
  while (t < until && s_lost == 0u) {
    float start = t;
    uint met;
    if (next < earlier) {
      met = take_earlier(earlier);
      if (met == none) {
        continue;
      }
      crossing_is_known = false;
      if (current == none) {
        current = met;
        continue;
      }
    } else {
      if (current == none) {
        take_nearest();
        if (current == none) {
          if (next == count || start_of(next) >= until) {
            break;
          }
          t = start_of(next);
          continue;
        }
        crossing_is_known = false;
      }
      if (!crossing_is_known) {
        find_next_crossing();
        crossing_is_known = true;
      }
      float end = min(s_high[current], until);
      start = start_of(next);
      if (crossing < start && crossing < end) {
        emit(crossing);
        uint before = current;
        current = waiting[crosser];
        waiting[crosser] = before;
        crossing_is_known = false;
        continue;
      }
      if (!(start < end)) {
        emit(end);
        current = none;
        continue;
      }
      met = s_order[next++];
    }
    Line a = line_of(met), b = line_of(current);
    float at = crossing_of(a, b, start);
    bool cross = at < never;
    if (is_seen_first(a, b, start, at)) {
      emit(start);
      if (cross || b.high > a.high) {
        wait_for(current);
      }
      current = met;
      crossing_is_known = false;
    } else if (cross || a.high > b.high) {
      wait_for(met);
      if (at < crossing) {
        crossing = at;
        crosser = waits - 1u;
      }
    }
  }
}

float border_of(uint piece) {
  return piece == 0u ? band_low
                     : piece == GROUP ? band_high
                                      : clamp(s_low[s_order[piece * count / GROUP]], band_low, band_high);
}

// ---- visible segments ----

uint first_of_mine() { return min(lane * ((seen_count + GROUP - 1u) / GROUP), seen_count); }
uint end_of_mine() { return min((lane + 1u) * ((seen_count + GROUP - 1u) / GROUP), seen_count); }

Seen seen_at(uint i) { return scratch[s_base + s_bucket[i]]; }

// True if a segment goes on from the piece before.
bool continues(uint i) {
  Seen seen = seen_at(i);
  return i > 0u && seen.segment == seen_at(i - 1u).segment && seen.low == seen_at(i - 1u).high;
}

float end_of(uint i) {
  float high = seen_at(i).high;
  for (uint k = i + 1u; k < seen_count && continues(k); ++k) {
    high = seen_at(k).high;
  }
  return high;
}

// True if a segment is visible only through a gap in a surface, which a dropped segment left
// (SliceSweep::close_gaps()).
bool is_gap(uint i, float high) {
  Seen seen = seen_at(i);
  if (i == 0u || !(high - seen.low < 2.0 * shortest_rad * (1.0 + seen.low * seen.low))) {
    return false;
  }
  uint after = i + 1u;
  while (after < seen_count && continues(after)) {
    ++after;
  }
  if (after == seen_count) {
    return false;
  }
  Seen before = seen_at(i - 1u), behind = seen_at(after);
  float w = s_w_at_0[seen.segment] + s_w_slope[seen.segment] * seen.low;
  return before.high == seen.low && high == behind.low &&
         s_w_at_0[before.segment] + s_w_slope[before.segment] * seen.low > w * (1.0 + touching) &&
         s_w_at_0[behind.segment] + s_w_slope[behind.segment] * high > w * (1.0 + touching);
}

vec3 normal_of(uint segment) {
  FanTriangle a = fan[s_triangle[segment]];
  vec3 b = vec3(a.x1 - a.x0, a.y1 - a.y0, a.z1 - a.z0), c = vec3(a.x2 - a.x0, a.y2 - a.y0, a.z2 - a.z0);
  precise vec3 n = vec3(b.y * c.z - b.z * c.y, b.z * c.x - b.x * c.z, b.x * c.y - b.y * c.x);
  precise float scale = 1.0 / sqrt(n.x * n.x + n.y * n.y + n.z * n.z + 1e-36);
  n *= scale;
  precise vec3 turned = vec3(n.x * slice.cosine + n.y * slice.sine, n.y * slice.cosine - n.x * slice.sine, n.z);
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
  return run_of_crossing(seen_at(before).segment, seen_at(before).low, seen_at(after).segment, end_of(after), at);
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
  uint after = i + 1u;
  while (after < seen_count && continues(after)) {
    ++after;
  }
  after = after < seen_count && seen_at(after).low == high ? after : none;
  vec2 ends[2];
  for (int end = 0; end < 2; ++end) {
    ends[end] = run_between(end == 0 ? before : i, end == 0 ? i : after, end == 0 ? seen.low : high);
  }
  vec3 normal = normal_of(seen.segment);
  visible[to] = Visible(seen.low, high, s_w_at_0[seen.segment], s_w_slope[seen.segment], ends[0].x, ends[0].y,
                        ends[1].x, ends[1].y, normal.x, normal.y, normal.z, s_triangle[seen.segment]);
}

bool is_written(uint i) { return !continues(i) && !is_gap(i, end_of(i)); }

// Puts what all pieces have seen in order into s_bucket, and counts it for each invocation in s_count.
// All invocations must call it.
void order_seen() {
  seen_count = s_lost != 0u ? 0u : min(s_used, most_seen);
  s_count[lane] = emitted;
  memoryBarrierBuffer();
  sum_counts();
  for (uint k = lane; k < seen_count; k += GROUP) {
    uint place_of = scratch[s_base + k].place;
    s_bucket[s_count[place_of >> 16] + (place_of & 0xffffu)] = k;
  }
  barrier();
}

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
    s_base = atomicAdd(counts.scratch, most_seen);
    atomicAdd(counts.segments, count);
  }
  barrier();
  if (s_base + most_seen > uint(ping.most_scratch)) {
    return 0u;
  }
  float from = border_of(lane), until = border_of(lane + 1u);
  emitted = 0u;
  if (from < until) {
    sweep(from, until);
  }
  barrier();
  order_seen();
  uint written = 0u;
  for (uint i = first_of_mine(); i < end_of_mine(); ++i) {
    written += is_written(i) ? 1u : 0u;
  }
  barrier();
  s_count[lane] = written;
  barrier();
  uint total = 0u;
  for (uint k = 0u; k < GROUP; ++k) {
    total += s_count[k];
  }
  sum_counts();
  return total;
}

void write_band(uint first) {
  uint to = first + s_count[lane];
  for (uint i = first_of_mine(); i < end_of_mine(); ++i) {
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

// Sees all bands, twice: to count what is visible, and to write it. If there is one band, which is usual, it is
// still in place the second time. A band with too many segments is halved. All invocations must call it.
void see_bands() {
  const int most_tries = 64;
  uint of_band = 0u;
  int bands = 0;
  for (int writing = 0; writing < 2; ++writing) {
    uint written = 0u;
    band_low = -ping.tan_limit;
    band_high = ping.tan_limit;
    for (int tries = 0; band_low < ping.tan_limit && tries < most_tries; ++tries) {
      if (!(writing == 1 && bands == 1) && !try_band(of_band)) {
        band_high = band_low + 0.5 * (band_high - band_low);
        continue;
      }
      if (writing == 1) {
        write_band(slice.first_visible + written);
      } else {
        ++bands;
      }
      written += of_band;
      band_low = band_high;
      band_high = ping.tan_limit;
    }
    if (writing == 0) {
      if (lane == 0u) {
        atomicMax(counts.longest_slice, bands == 1 ? count : room + 1u);
        atomicAdd(counts.overflows, band_low < ping.tan_limit ? 1u : 0u);
        s_found = atomicAdd(counts.visible, written);
      }
      barrier();
      slice.first_visible = s_found;
      slice.visible_count = s_found + written <= uint(ping.most_visible) ? written : 0u;
      barrier();
      if (slice.visible_count == 0u) {
        return;
      }
    }
  }
}

// ---- sides ----

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
      float per_azimuth = w_per_azimuth(v.w_at_0, v.w_slope, v.normal_h, v.normal_s, v.normal_z, 0.5 * (v.low + v.high));
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
    s_nearest = floatBitsToUint(refinement.max_range_m);
    s_furthest = 0u;
  }
  barrier();
  for (uint k = lane; k < uint(side_probes); k += GROUP) {  // those that find_side() wrote in this invocation
    float t = probe_at(ping.tan_limit, int(k)), secant = sqrt(1.0 + t * t);
    for (uint side = 0u; side < 2u; ++side) {
      float w = sides[(side == 0u ? port : starboard) + k];
      if (secant < refinement.max_range_m * w) {
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
  slice.lines = max(0.0, uintBitsToFloat(s_furthest) - uintBitsToFloat(s_nearest)) / refinement.line_m;
}

layout(location = 0) uniform int round_number;

void main() {
  lane = gl_LocalInvocationID.x;
  Round of_round = rounds[round_number];
  uint number = of_round.first_slice + gl_WorkGroupID.x;
  if (number >= uint(ping.most_slices) || !lists_have_room(counts)) {
    return;
  }
  slice = slices[number];
  if ((slice.state & is_seen) == 0u) {
    see_bands();
    slice.state |= is_seen;
  }
  memoryBarrierBuffer();
  barrier();
  if (refinement.division.most_divisions > 1) {
    uint first = 2u * number * uint(side_probes);
    for (uint side = 0u; side < 2u; ++side) {
      find_side(first + side * uint(side_probes), (side == 0u ? 0.5 : -0.5) * slice.width_rad);
    }
    summarise_sides(first, first + uint(side_probes));
  }
  if (lane == 0u) {
    slices[number] = slice;
  }
}
