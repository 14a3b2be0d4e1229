// SPDX-License-Identifier: Apache-2.0
// Cuts the triangles of a beam with a slice, for see.comp. As SliceCutter::cut().

CutTriangle cut_ahead(FanTriangle t) {
  return cut_triangle(t.corners[0], t.corners[1], t.corners[2], slice.cosine, slice.sine, ping.tan_limit);
}

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
  CutTriangle cut;
  cut.fate = cut_misses;
  vec2 s[3], h[3], end_h[2], end_z[2];
  for (int k = 0; k < 3; ++k) {
    s[k] = add(two_product(of.corners[k].y, slice.cosine), -two_product(of.corners[k].x, slice.sine));
    h[k] = add(two_product(of.corners[k].x, slice.cosine), two_product(of.corners[k].y, slice.sine));
  }
  int ends = 0;
  for (int k = 0; k < 3 && ends < 2; ++k) {
    int j = (k + 1) % 3;
    if ((s[k].x >= 0.0) != (s[j].x >= 0.0)) {
      vec2 share = divide(s[k], add(s[k], -s[j]));
      end_h[ends] = add(h[k], multiply(add(h[j], -h[k]), share));
      end_z[ends++] =
          add(vec2(of.corners[k].z, 0.0), multiply(two_sum(of.corners[j].z, -of.corners[k].z), share));
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

// Puts the segments of the band into shared memory, as far as there is room, and their number into s_found.
void cut_triangles() {
  uint end = min(beams[slice.beam + 1].begin, ping.room.entries);
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
