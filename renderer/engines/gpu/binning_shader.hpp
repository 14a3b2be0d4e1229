// SPDX-License-Identifier: Apache-2.0
// The GLSL of GpuBinner: what grid_binner and RangeProfile do, for one texture of samples, and the sums of
// it. Sums are whole units of 64 bits in two words. Adding whole numbers has no order, so the image is the
// same however the work is shared out (docs/physics.md 4.2).
#pragma once

namespace sonard::render {

/// What both shaders know of the sums.
inline constexpr char binning_shader_head[] = R"glsl(#version 430
// [echo, then weight][beam][line]: by how many units a line differs from the one before; low word first. As in
// RangeProfile, what is spread over many lines costs no more than its ends.
layout(std430, binding = 0) buffer Differences { uint differences[]; };
layout(location = 0) uniform int lines;
layout(location = 1) uniform int beams;
layout(location = 2) uniform bool weighed;  // the weights are summed too

uvec2 plus(uvec2 a, uvec2 b) {
  uint carry;
  uint low = uaddCarry(a.x, b.x, carry);
  return uvec2(low, a.y + b.y + carry);
}

uvec2 minus(uvec2 a, uvec2 b) {
  uint borrow;
  uint low = usubBorrow(a.x, b.x, borrow);
  return uvec2(low, a.y - b.y - borrow);
}
)glsl";

/// One work group per ColumnPart of a view.
inline constexpr char splat_shader[] = R"glsl(
layout(local_size_x = 64) in;

// ColumnPart, and the tangent of its column's centre.
struct Part {
  int column, row_begin, row_end, beam;
  uint weights;
  float x, x_offset, width, limit_slope;
  float first_y_offset, first_height, last_y_offset, last_height;
};
layout(std430, binding = 1) readonly buffer Parts { Part parts[]; };
layout(std430, binding = 2) readonly buffer Weights { float weights[]; };
layout(std430, binding = 3) buffer Counts { uint samples, invalid, saturated; };
layout(rgba32f, binding = 0) readonly uniform image2D view;  // SurfaceSample

layout(location = 3) uniform int first_part;       // of the view
layout(location = 4) uniform float bottom;         // tangent of the lowest row's centre
layout(location = 5) uniform float pixel_height;   // tangent units
layout(location = 6) uniform vec3 lines_per_m;     // in three parts, of 12, 12 and 24 bits
layout(location = 7) uniform float units_per_sr;
layout(location = 8) uniform float most_units;     // of one sample: so many of them cannot overflow
layout(location = 9) uniform bool footprint;

const float least_spread = 1e-3;   // lines
const float widest_smear = 512.0;  // lines

shared uint group_samples, group_invalid, group_saturated;

// A place on the range axis. A single float would say where in line 16384 no closer than to a thousandth.
struct Place {
  float line;  // a whole number
  float part;  // of a line, from its beginning
};

Place normalised(float line, float part) {
  float whole = floor(part);
  return Place(line + whole, part - whole);
}

// The product with lines_per_m from parts so short that all products that matter are exact.
Place place_of(float range_m) {
  precise float coarse = uintBitsToFloat(floatBitsToUint(range_m) & 0xfffff000u);
  precise float fine = range_m - coarse;
  precise float line = floor(coarse * lines_per_m.x);
  precise float part = coarse * lines_per_m.x - line;
  part += coarse * lines_per_m.y + fine * lines_per_m.x;
  part += coarse * lines_per_m.z + fine * lines_per_m.y;
  return normalised(line, part);
}

Place moved(Place place, float lines_on) {
  float whole = floor(lines_on);
  return normalised(place.line + whole, place.part + (lines_on - whole));
}

// RangePlane::move(): from the ray at `t` to that at `t + offset`. Of the range, by which part of it the plane is
// farther off there: as a difference of two ranges that would be lost in their rounding.
// Returns that, and the range derivatives there.
vec3 move_plane(vec3 plane, vec2 t, vec2 offset) {
  float qq = 1.0 + dot(t, t);
  vec2 slope = t / qq - plane.yz / plane.x;
  float fall = dot(slope, offset);  // of the inverse depth
  if (fall < -0.5) return vec3(0.0, plane.yz);
  float growth = dot(2.0 * t + offset, offset) / qq;  // of the ray's length, squared
  float farther = (growth / (1.0 + sqrt(1.0 + growth)) - fall) / (1.0 + fall);
  vec2 to = t + offset;
  float range = plane.x + plane.x * farther;
  return vec3(farther, range * (to / (qq + qq * growth) - slope / (1.0 + fall)));
}

uvec2 whole_units(float amount) {
  float high = floor(amount / 4294967296.0);
  return uvec2(uint(amount - high * 4294967296.0), uint(high));
}

// The two words may be added to by others in between: every carry out of the low word is seen by exactly one
// of them, so that in the end all are in the high one.
void add(uint line, uvec2 units) {
  uint high = units.y;
  if (units.x != 0u) {
    uint before = atomicAdd(differences[2u * line], units.x);
    high += before + units.x < before ? 1u : 0u;
  }
  if (high != 0u) atomicAdd(differences[2u * line + 1u], high);
}

float echo_units, weight_units;  // of the sample at hand
uint echo_lines, weight_lines;   // where those of its beam begin

// To the line `k` the units of `here` that the line before did not have.
void step_to(int k, float share, inout uvec2 echo_before, inout uvec2 weight_before) {
  uvec2 here = whole_units(echo_units * share);
  add(echo_lines + uint(k), minus(here, echo_before));
  echo_before = here;
  if (weighed) {
    here = whole_units(weight_units * share);
    add(weight_lines + uint(k), minus(here, weight_before));
    weight_before = here;
  }
}

void add_point(Place place) {
  if (!(place.line >= 0.0 && place.line < float(lines))) return;
  int k = int(place.line);
  uvec2 echo_before = uvec2(0u), weight_before = uvec2(0u);
  step_to(k, 1.0, echo_before, weight_before);
  if (k + 1 < lines) step_to(k + 1, 0.0, echo_before, weight_before);
}

float overlap_of_ramp(float from, float to, float ramp) {
  float a = clamp(from, 0.0, ramp), b = clamp(to, 0.0, ramp);
  return (b - a) * (a + b) / (2.0 * ramp);
}

// Two independent even spreads of widths `spread` >= `smear`, in lines: a trapezoid.
void add_trapezoid(Place centre, float spread, float smear) {
  spread = max(spread, least_spread);
  smear = clamp(smear, least_spread, widest_smear);
  float half_width = 0.5 * (spread + smear);
  Place start = moved(centre, -half_width), end = moved(centre, half_width);
  if (!(start.line < float(lines) && end.line >= 0.0)) return;
  int first = int(max(start.line, 0.0));
  int last = int(min(end.line, float(lines - 1)));
  // Lines up to here lie wholly within the even middle, if one before them does.
  int last_even = int(min(float(last), end.line - ceil(smear) - 1.0));
  uvec2 echo_before = uvec2(0u), weight_before = uvec2(0u);
  for (int k = first; k <= last; ++k) {
    // From the start on to the two sides of the line, and back from the end.
    float x0 = (float(k) - start.line) - start.part;
    float x1 = x0 + 1.0;
    float y0 = (end.line - float(k)) + end.part;
    float y1 = y0 - 1.0;
    bool even = x0 >= smear && y1 >= smear;
    float held = 1.0;  // in lines of the even middle
    if (!even) {
      float middle = min(min(1.0, spread - smear), min(x1 - smear, y0 - smear));
      held = overlap_of_ramp(x0, x1, smear) + max(0.0, middle) + overlap_of_ramp(y1, y0, smear);
    }
    step_to(k, held / spread, echo_before, weight_before);
    if (even) k = max(k, last_even);
  }
  if (last + 1 < lines) step_to(last + 1, 0.0, echo_before, weight_before);
}

void bin(Part part, int row) {
  vec4 seen = imageLoad(view, ivec2(part.column, row));  // range, response, range derivatives
  if (!(seen.x > 0.0)) {
    if (seen.x < 0.0) atomicAdd(group_invalid, 1u);
    return;
  }
  // What of the pixel counts: a parallelogram (Cell in grid_binner).
  vec2 offset = vec2(part.x_offset, 0.0);
  float height = pixel_height, slope = 0.0;
  if (row == part.row_begin) {
    offset.y = part.first_y_offset;
    height = part.first_height;
    slope = -part.limit_slope;
  } else if (row + 1 == part.row_end) {
    offset.y = part.last_y_offset;
    height = part.last_height;
    slope = part.limit_slope;
  }
  vec3 plane = vec3(0.0, seen.zw);
  if (footprint && offset != vec2(0.0)) {
    plane = move_plane(seen.xzw, vec2(part.x, bottom + float(row) * pixel_height), offset);
  }
  float per_m = lines_per_m.x + lines_per_m.y + lines_per_m.z;
  float across = abs(plane.y + slope * plane.z) * part.width * per_m;
  float along = abs(plane.z) * height * per_m;
  float weight = weights[part.weights + uint(row - part.row_begin)];
  float echo = weight * seen.y;
  float all = seen.x + plane.x + across + along + echo;
  if (isnan(all) || isinf(all)) {
    atomicAdd(group_invalid, 1u);
    return;
  }
  atomicAdd(group_samples, 1u);
  echo_units = max(0.0, echo * units_per_sr);
  weight_units = weight * units_per_sr;
  if (echo_units > most_units) {
    echo_units = most_units;
    atomicAdd(group_saturated, 1u);
  }
  if (footprint) {
    Place centre = moved(place_of(seen.x), seen.x * plane.x * per_m);
    add_trapezoid(centre, max(across, along), min(across, along));
  } else {
    add_point(place_of(seen.x));
  }
}

void main() {
  if (gl_LocalInvocationIndex == 0u) {
    group_samples = 0u;
    group_invalid = 0u;
    group_saturated = 0u;
  }
  barrier();
  Part part = parts[first_part + int(gl_WorkGroupID.x)];
  echo_lines = uint(part.beam) * uint(lines);
  weight_lines = uint(beams + part.beam) * uint(lines);
  for (int row = part.row_begin + int(gl_LocalInvocationIndex); row < part.row_end; row += 64) {
    bin(part, row);
  }
  barrier();
  if (gl_LocalInvocationIndex == 0u) {
    atomicAdd(samples, group_samples);
    if (group_invalid != 0u) atomicAdd(invalid, group_invalid);
    if (group_saturated != 0u) atomicAdd(saturated, group_saturated);
  }
}
)glsl";

/// One work group per beam: from differences to lines. Leaves zeros behind for the next ping.
inline constexpr char sum_shader[] = R"glsl(
layout(local_size_x = 256) in;

// [beam][line], as in BinningResult.
layout(std430, binding = 4) writeonly buffer Echo { float echo[]; };
layout(std430, binding = 5) writeonly buffer Open { float open_sr[]; };
layout(std430, binding = 6) readonly buffer SolidAngles { float solid_angle[]; };  // of beams
layout(location = 3) uniform float sr_per_unit;
layout(location = 4) uniform bool mean;
layout(location = 5) uniform bool open_water;
layout(location = 6) uniform float least_share;
layout(location = 7) uniform float least_open;

shared uvec2 up_to[2][256];

// What the invocations before this one hold together.
uvec2 sum_before(uvec2 own) {
  uint me = gl_LocalInvocationIndex;
  int from = 0;
  up_to[from][me] = own;
  barrier();
  for (uint distance = 1u; distance < 256u; distance *= 2u) {
    uvec2 sum = up_to[from][me];
    if (me >= distance) sum = plus(sum, up_to[from][me - distance]);
    from = 1 - from;
    up_to[from][me] = sum;
    barrier();
  }
  uvec2 before = minus(up_to[from][me], own);
  barrier();
  return before;
}

uvec2 difference(uint line) {
  return uvec2(differences[2u * line], differences[2u * line + 1u]);
}

uvec2 sum_of_differences(uint first, uint count) {
  uvec2 sum = uvec2(0u);
  for (uint i = 0u; i < count; ++i) sum = plus(sum, difference(first + i));
  return sum;
}

uvec2 take(uint line) {
  uvec2 units = difference(line);
  differences[2u * line] = 0u;
  differences[2u * line + 1u] = 0u;
  return units;
}

float steradians(uvec2 units) {
  return (float(units.y) * 4294967296.0 + float(units.x)) * sr_per_unit;
}

void main() {
  int each = (lines + 255) / 256;
  int begin = min(int(gl_LocalInvocationIndex) * each, lines);
  uint count = uint(min(each, lines - begin));
  uint first = gl_WorkGroupID.x * uint(lines) + uint(begin);
  uint first_weight = first + uint(beams) * uint(lines);
  float whole = solid_angle[gl_WorkGroupID.x];

  uvec2 echo_units = sum_before(sum_of_differences(first, count));
  uvec2 weight_units = uvec2(0u), blocked = uvec2(0u);
  if (weighed) weight_units = sum_before(sum_of_differences(first_weight, count));
  if (open_water) {
    uvec2 here = weight_units;
    for (uint i = 0u; i < count; ++i) {
      here = plus(here, difference(first_weight + i));
      blocked = plus(blocked, here);
    }
    blocked = sum_before(blocked);
  }
  for (uint i = 0u; i < count; ++i) {
    echo_units = plus(echo_units, take(first + i));
    float value = steradians(echo_units);
    if (weighed) {
      weight_units = plus(weight_units, take(first_weight + i));
      float weight = steradians(weight_units);
      if (mean) value = weight > least_share * whole ? min(1.0, value / weight) : 0.0;
      if (open_water) {
        float open = whole - steradians(blocked) - 0.5 * weight;
        open_sr[first + i] = open > least_open * whole ? open : 0.0;
        blocked = plus(blocked, weight_units);
      }
    }
    echo[first + i] = value;
  }
}
)glsl";

}  // namespace sonard::render
