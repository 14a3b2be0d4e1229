// SPDX-License-Identifier: Apache-2.0
// One group for each slice, one invocation for each end between two patches: adds them to the sums of their beam,
// as RangeProfile does. The macro WEIGHED is 1 if the weights are summed too.
//
// Sums are whole numbers (whole_numbers.glsl), so they depend on no order and are exactly 0 behind the last patch.
// Additions wrap around. Only the sum of a line must fit, and it is at most the echo of a beam, 2^51 units. A single
// number is at most 2^61: the whole echo of a beam in a thousandth of a line.
#include "gpu/echoes.glsl"
#include "gpu/whole_numbers.glsl"
layout(std430, binding = 0) readonly buffer Slices { Slice slices[]; };
layout(std430, binding = 1) readonly buffer PiecesOfSlices { SlicePieces of_slice[]; };
layout(std430, binding = 2) buffer Counts { PingCounts counts; };
layout(std430, binding = 3) readonly buffer Pieces { uvec4 pieces[]; };
// First differences between the lines, then second differences, of the echo; then of the weights: [beam][line].
layout(std430, binding = 4) buffer Sums { uint sums[]; };

const int profiles = WEIGHED + 1;
const float least_smear = 1e-3;     // lines; below, a step is sharp
const float least_spread = 1e-3;    // lines; narrower patches are widened to this
const float widest_smear = 512.0;   // lines; surfaces seen edge-on carry no energy

shared uint s_samples, s_invalid, s_additions;
uint additions;  // by this invocation, to words of the sums
uint beam, begin, end;  // of the patches of the slice

// ---- sums ----

// Other invocations may add to the words in between. Exactly one of them finds each carry out of the low word.
void add(int profile, int order, int line, uvec2 units) {
  if (line >= echo.lines) {
    return;
  }
  uint at = 2u * (uint((2 * profile + order) * ping.beams + int(beam)) * uint(echo.lines) + uint(max(line, 0)));
  uint carry = 0u;
  if (units.x != 0u) {
    uint before = atomicAdd(sums[at], units.x);
    ++additions;
    carry = before + units.x < before ? 1u : 0u;
  }
  if (units.y + carry != 0u) {
    atomicAdd(sums[at + 1u], units.y + carry);
    ++additions;
  }
}

// ---- places ----

// On the range axis. In line 16384 a single float would resolve only a thousandth of a line.
struct Place {
  int line;
  float part;  // of a line, from its beginning
};

Place place_from(int line, float part) {
  precise float whole = floor(part);
  precise float rest = part - whole;
  return Place(line + int(whole), rest);
}

// The product with lines per metre in parts of 12, 12 and 24 bits, so that all products that matter are exact.
Place place_of(float range_m) {
  precise float coarse = uintBitsToFloat(floatBitsToUint(range_m) & 0xfffff000u);
  precise float fine = range_m - coarse;
  precise float line = floor(coarse * echo.lines_per_m_0);
  precise float part = coarse * echo.lines_per_m_0 - line;
  part += coarse * echo.lines_per_m_1 + fine * echo.lines_per_m_0;
  part += coarse * echo.lines_per_m_2 + fine * echo.lines_per_m_1;
  return place_from(int(line), part);
}

float distance_of(Place from, Place to) {
  precise float distance = float(to.line - from.line) + (to.part - from.part);
  return distance;
}

// ---- amounts ----

// A patch in range lines.
struct Spread {
  Place a, b;
  float smear_a, smear_b;
  float extent;                  // before it is joined to the patch before
  float amount[2], gradient[2];  // echo and weight, in units
  bool is_finite;
  bool is_alone;  // shares no end: it lies beside others, or is widened
};

Spread spread_at(uint i, bool is_beside) {
  vec4 ends = uintBitsToFloat(pieces[2u * i]), amounts = uintBitsToFloat(pieces[2u * i + 1u]);
  precise float lines_per_m = echo.lines_per_m_0 + echo.lines_per_m_1 + echo.lines_per_m_2;
  float furthest = 1e6 / lines_per_m;  // of places, which are whole numbers; nothing echoes there
  Spread s;
  float sum = ends.x + ends.y + ends.z + ends.w + amounts.x + amounts.y + amounts.z + amounts.w;
  s.is_finite = abs(sum) < 3.4e38;  // false for NaN
  s.a = place_of(clamp(ends.x, -furthest, furthest));
  s.b = place_of(clamp(ends.y, -furthest, furthest));
  precise float smear_a = ends.z * lines_per_m, smear_b = ends.w * lines_per_m;
  s.smear_a = smear_a;
  s.smear_b = smear_b;
  s.amount = float[2](amounts.x * echo.units_per_sr, amounts.y * echo.units_per_sr);
  s.gradient = float[2](amounts.z, amounts.w);
  s.extent = abs(distance_of(s.a, s.b));
  s.is_alone = is_beside || !s.is_finite || s.extent < 2.0 * least_spread;
  return s;
}

bool is_elsewhere_at(uint i) { return pieces[2u * i].x == is_elsewhere; }

// Whether a patch begins where the one before ends, with the same smear. The narrower a patch, the higher are its
// two steps, and the more would the smear of another patch displace its echo.
// `precise`: the invocations of both patches decide alike.
bool is_joined(Spread before, Spread s) {
  precise float off = abs(before.smear_b - s.smear_a) * (1.0 + s.smear_a);
  precise float most_off = min(0.02 * min(before.extent, s.extent), least_smear);
  return !before.is_alone && !s.is_alone && abs(distance_of(before.b, s.a)) < least_spread && off < most_off;
}

// ---- steps ----

// Adds a step of the density that rises evenly over the smear.
void add_step(Place place, float smear, uvec2 height[2]) {
  float wide = clamp(smear, least_smear, widest_smear), half_over_wide = 0.5 / wide;
  Place from = place_from(place.line, place.part - 0.5 * wide);
  uvec2 last[2] = uvec2[2](uvec2(0u), uvec2(0u));
  float before = 0.0;
  bool is_done = false;
  for (int line = from.line; !is_done && line < echo.lines; ++line) {
    // Integral of the step, from its beginning to the end of the line.
    float y = float(line - from.line) - from.part, begun = max(y + 1.0, 0.0), rising = min(begun, wide);
    float after = rising * rising * half_over_wide + (begun - rising);
    is_done = y >= wide;
    for (int k = 0; k < profiles; ++k) {
      uvec2 here = is_done ? height[k] : whole_of(float_of(height[k]) * (after - before));
      add(k, 0, line, minus(here, last[k]));
      last[k] = here;
    }
    before = after;
  }
}

// Offset c of a change of slope: the n-th line after the place's line gets slope * n + c.
struct SlopeChange {
  uvec2 in_line, in_next;
};
SlopeChange slope_change(Place place, float slope) {
  precise float left = 1.0 - place.part;
  precise float in_line = slope * (0.5 * left * left), in_next = slope * (left + 0.5);
  return SlopeChange(whole_of(in_line), whole_of(in_next));
}

void add_slope_change(int profile, Place place, float slope) {
  SlopeChange change = slope_change(place, slope);
  add(profile, 1, place.line, change.in_line);
  add(profile, 1, place.line + 1, minus(change.in_next, plus(change.in_line, change.in_line)));
  add(profile, 1, place.line + 2, plus(minus(whole_of(slope), change.in_next), change.in_line));
}

// The density of a patch at its first end, its slope, and its density at the other end.
struct Density {
  uvec2 at_a, at_b;
  float slope;
};

Density density_of(Spread s, int profile) {
  precise float spread = distance_of(s.a, s.b);
  // Negative if the far end comes first; the signs of the two steps then swap.
  precise float mean = s.amount[profile] / spread;
  bool has_slope = s.gradient[profile] != 0.0 && s.a.line >= 0 && s.b.line >= 0;
  precise float change = has_slope ? mean * s.gradient[profile] : 0.0;
  Density density;
  density.at_a = density.at_b = whole_of(mean - change);
  density.slope = has_slope ? float_of(whole_of(2.0 * change / spread)) : 0.0;
  if (has_slope) {
    // Offsets of both changes of slope, and the rise in between.
    SlopeChange from = slope_change(s.a, density.slope), to = slope_change(s.b, -density.slope);
    density.at_b = plus(density.at_b, plus(from.in_next, to.in_next));
    density.at_b = plus(density.at_b, times(whole_of(density.slope), s.b.line - s.a.line));
  }
  return density;
}

// The steps of own patches: the end before, if no patch is joined to it; the first end; the other end, if no other
// invocation adds it.
void add_steps(Spread last, uvec2 open_height[2], bool is_open, bool joined, Spread s, Density density[2]) {
  for (int step = 0; step < 3; ++step) {
    uvec2 height[2];
    for (int p = 0; p < profiles; ++p) {
      uvec2 joined_height = is_open && joined ? open_height[p] : uvec2(0u);
      height[p] = step == 0   ? open_height[p]
                  : step == 1 ? plus(density[p].at_a, joined_height)
                              : negative(density[p].at_b);
    }
    if (step == 0 ? is_open && !joined : s.is_finite && (step == 1 || s.is_alone)) {
      Place place = step == 0 ? last.b : step == 1 ? s.a : s.b;
      add_step(place, step == 0 ? last.smear_b : step == 1 ? s.smear_a : s.smear_b, height);
    }
  }
  for (int p = 0; p < profiles && s.is_finite; ++p) {
    for (int of_end = 0; of_end < 2 && density[p].slope != 0.0; ++of_end) {
      add_slope_change(p, of_end == 0 ? s.a : s.b, of_end == 0 ? density[p].slope : -density[p].slope);
    }
  }
}

// Adds the end before patch i, or after the last one; and all of patch i if it shares no end.
void add_end(uint i) {
  bool has_before = i > begin && !is_elsewhere_at(i - 1u);
  bool is_beside = i < end && is_elsewhere_at(i);
  uint first = is_beside ? pieces[2u * i].y : i, count = is_beside ? pieces[2u * i].z : i < end ? 1u : 0u;
  Spread last;
  last.is_alone = true;
  bool is_open = false;  // the other end of `last` is not yet added
  uvec2 open_height[2] = uvec2[2](uvec2(0u), uvec2(0u));
  // Patch i - 2, which may move the first end of patch i - 1; patch i - 1; patch i or those in its place.
  uint back = has_before ? (i > begin + 1u && !is_elsewhere_at(i - 2u) ? 2u : 1u) : 0u;
  for (uint k = 0u; k < back + max(count, 1u); ++k) {
    bool is_own = k >= back, exists = k < back + count;
    Spread s = spread_at(!exists ? i - 1u : is_own ? first + (k - back) : i - back + k, is_beside && is_own);
    s.is_alone = s.is_alone || !exists;
    s.is_finite = s.is_finite && exists;
    bool joined = is_joined(last, s);
    if (joined) {
      s.a = last.b;
      s.smear_a = last.smear_b;
    }
    float spread = distance_of(s.a, s.b);
    if (abs(spread) < least_spread) {
      s.b = place_from(s.a.line, s.a.part + with_sign_of(least_spread, spread));
    }
    Density density[2];
    for (int p = 0; p < profiles; ++p) {
      density[p] = density_of(s, p);
    }
    if (is_own) {
      add_steps(last, open_height, is_open, joined, s, density);
      atomicAdd(s_samples, s.is_finite ? 1u : 0u);
      atomicAdd(s_invalid, exists && !s.is_finite ? 1u : 0u);
    }
    for (int p = 0; p < profiles; ++p) {
      open_height[p] = negative(density[p].at_b);
    }
    is_open = !is_own && !s.is_alone;
    last = s;
  }
}

void main() {
  uint number = group_number();
  if (!has_slice(number, counts.needed)) {
    return;
  }
  begin = of_slice[number].first;
  end = begin + of_slice[number].count;
  if (begin == end || counts.needed.pieces > ping.room.pieces) {
    return;
  }
  beam = uint(slices[number].beam);
  if (lane == 0u) {
    s_samples = s_invalid = s_additions = 0u;
  }
  additions = 0u;
  barrier();
  for (uint i = begin + lane; i <= end; i += GROUP) {
    add_end(i);
  }
  atomicAdd(s_additions, additions);
  barrier();
  if (lane == 0u) {
    atomicAdd(counts.samples, s_samples);
    atomicAdd(counts.invalid, s_invalid);
    atomicAdd(counts.additions, s_additions);
  }
  report_cut_loops();
}
