// SPDX-License-Identifier: Apache-2.0
// The GLSL of GpuBinner: grid_binner and RangeProfile for the samples of a grid, and its sums. Sums are whole
// units of 64 bits in two words. Sums of whole numbers do not depend on the order, so the image is the same
// for any distribution of the work (docs/physics.md 4.2). Floating-point sums, for error estimates, have a
// fixed order.
#pragma once

namespace sonard::render {

/// Locations of the uniforms of all these shaders.
enum BinningUniform : int {
  at_lines,
  at_lines_per_m,
  at_pattern_scale,
  at_units_per_sr,
  at_most_units,
  at_most_rows,
  at_tan_limit,
  at_part_count,
  at_image_beams,
  at_sr_per_unit,
  at_mean,
  at_open_water,
  at_least_share,
  at_least_open,
  at_estimating,
  at_least_level,
  at_first_estimate,
  at_most_error,
  at_most_rest,
  at_first_beam,
  at_paired_rows,
};

/// Begin of all shaders.
inline constexpr char binning_shader_head[] = R"glsl(
layout(location = 0) uniform int lines;
// What the shaders read lies in textures, by unit (GpuBinner knows them): a software OpenGL fetches every word of a
// buffer by itself.
layout(binding = 12) uniform samplerBuffer line_weight;
layout(binding = 13) uniform isamplerBuffer parts;

// ColumnPart, the tangent of its column's centre, and its neighbours: parts of the next columns, even in another beam,
// with the distances of the centres in radians. A part without a neighbour is its own neighbour.
struct Part {
  int column, row_begin, row_end, beam;
  float x, x_offset, width, limit_slope;
  float first_y_offset, first_height, last_y_offset, last_height;
  int before, after;
  float to_before, to_after, width_rad;
  int view;
};

Part part_at(int p) {
  ivec4 place = texelFetch(parts, 5 * p);
  vec4 across = intBitsToFloat(texelFetch(parts, 5 * p + 1));
  vec4 ends = intBitsToFloat(texelFetch(parts, 5 * p + 2));
  ivec4 beside = texelFetch(parts, 5 * p + 3);
  ivec4 rest = texelFetch(parts, 5 * p + 4);
  return Part(place.x, place.y, place.z, place.w, across.x, across.y, across.z, across.w, ends.x, ends.y, ends.z, ends.w,
              beside.x, beside.y, intBitsToFloat(beside.z), intBitsToFloat(beside.w),
              intBitsToFloat(rest.x), rest.y);
}

// A beam of the grid.
struct Beam {
  int in_image;
  float solid_angle;
  int part_begin, part_end;
  int segment_begin, segment_end;
  int rows;
};

// BeamEstimate.
struct Estimate {
  float columns_total, columns_centroid_lines, rows_total, rows_centroid_lines;
  float bin_squares;
  uint bins;
  uint thin;
  int zone_begin, zone_end;
  float zone_miss;
};

// A sum begins here: small numbers that come and go then hardly ever reach the high word.
const uint start_of_sum = 0x80000000u;  // GpuBinner knows it

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

/// Begin of shaders that read samples.
inline constexpr char sample_shader_head[] = R"glsl(
layout(binding = 7) uniform sampler2DArray surface_samples;  // SurfaceSample
layout(binding = 14) uniform isamplerBuffer views;

// The view at hand: its lower left pixel, its rows, the tangents of that pixel's centre and of the size of one.
ivec3 corner;
int view_rows;
float left, bottom;
vec2 pixel;

void look_at(int view) {
  ivec4 place = texelFetch(views, 2 * view);
  vec4 tangents = intBitsToFloat(texelFetch(views, 2 * view + 1));
  corner = place.xyz;
  view_rows = place.w;
  left = tangents.x;
  bottom = tangents.y;
  pixel = tangents.zw;
}

vec4 sample_at(ivec2 at) {
  return texelFetch(surface_samples, corner + ivec3(at.yx, 0), 0);
}

layout(location = 1) uniform vec3 lines_per_m;    // in three parts, of 12, 12 and 24 bits
layout(location = 2) uniform float pattern_scale; // of the elevation pattern: sinc(this * sine of the elevation)

// Of a pixel what lies in the part: a parallelogram (Cell in grid_binner).
struct Cell {
  vec2 offset;  // of its centre from the pixel's
  float height, slope;
};

Cell cell_of(Part part, int row) {
  if (row == part.row_begin) {
    return Cell(vec2(part.x_offset, part.first_y_offset), part.first_height, -part.limit_slope);
  }
  if (row + 1 == part.row_end) {
    return Cell(vec2(part.x_offset, part.last_y_offset), part.last_height, part.limit_slope);
  }
  return Cell(vec2(part.x_offset, 0.0), pixel.y, 0.0);
}

vec2 tangents_of(Part part, int row) {
  return vec2(part.x, bottom + float(row) * pixel.y);
}

// SampleGrid::weight(), Aperture::elevation_weight().
float weight_of(vec2 t, float width, float height) {
  float qq = 1.0 + dot(t, t);
  float weight = width * height / (qq * sqrt(qq));
#if PATTERN != 0
    float y = pattern_scale * t.y * inversesqrt(qq);
    float amplitude = abs(y) < 1e-3 ? 1.0 - y * y / 6.0 : sin(y) / y;
    float one_way = amplitude * amplitude;
    weight *= PATTERN == 2 ? one_way * one_way : one_way;
#endif
  return weight;
}
)glsl";

/// One work group per ColumnPart.
inline constexpr char splat_shader[] = R"glsl(
layout(local_size_x = COLUMN_GROUP) in;

// [beam][line]: by how many units a line differs from the one before; low word first. As in RangeProfile, what is
// spread over many lines costs no more than its ends.
layout(std430, binding = 0) buffer EchoDifferences { uint echo_differences[]; };
layout(std430, binding = 1) buffer WeightDifferences { uint weight_differences[]; };
layout(std430, binding = 4) buffer Image { uint samples, invalid, saturated, additions, pairs; };
#if ESTIMATE
layout(std430, binding = 5) writeonly buffer PartialColumns { vec2 partial_columns[]; };  // [part][invocation]
vec2 own_echo = vec2(0.0);
#endif

layout(location = 7) uniform int part_count;
layout(location = 3) uniform float units_per_sr;
layout(location = 4) uniform float most_units;    // of one sample: so many of them cannot overflow
layout(location = 20) uniform int paired_rows;    // ImageRequest::paired_rows

const float least_spread = 1e-3;        // lines
const float widest_smear = 512.0;       // lines
const float most_off_plane = 0.02;      // lines, of two samples that are binned as one
const float most_response_step = 0.05;  // of the sum of their responses

uint own_samples = 0u, own_invalid = 0u, own_saturated = 0u, own_additions = 0u, own_pairs = 0u;

// A place on the range axis. In line 16384 a single float would resolve only a thousandth of a line.
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

// Rounded, not cut off: of the weakest echoes a line holds few.
uvec2 whole_units(float amount) {
  float high = floor(amount / 4294967296.0);
  float low = floor(amount - high * 4294967296.0 + 0.5);
  return low < 4294967296.0 ? uvec2(uint(low), uint(high)) : uvec2(0u, uint(high) + 1u);
}

float echo_units, weight_units;  // of the sample at hand
uint first_line;                 // of its beam

// The additions of a sample to the differences, line after line. A sum is two words. The high word is added in a step of
// its own: it is nearly always 0, and a software OpenGL makes every addition that a step may make.
// Other invocations may add to the words in between: each carry out of the low word is seen by exactly one of them, so
// that all carries reach the high word.
struct Steps {
  uvec2 echo_before, weight_before;  // of the line before
  uint echo_high, weight_high;       // rest to add to the line that was added last
  uint at;                           // its low word
};

bool carrying(Steps steps) {
  return (steps.echo_high | steps.weight_high) != 0u;
}

#define ADD(differences, units_of_sample, before_it, high)                                \
  {                                                                                       \
    uvec2 here = whole_units(units_of_sample * share);                                    \
    uvec2 units = minus(here, steps.before_it);                                           \
    uint amount = carry ? steps.high : units.x;                                           \
    uint left = 0u;                                                                       \
    if (amount != 0u) {                                                                   \
      uint before = atomicAdd(differences[at], amount);                                   \
      left = before + amount < before ? 1u : 0u;                                          \
      ++own_additions;                                                                    \
    }                                                                                     \
    steps.high = carry ? 0u : units.y + left;                                             \
    if (!carry) steps.before_it = here;                                                   \
  }

// Adds the rest of the previous line, or to line `k` the units of its share that the previous line did not get. Returns
// whether it added to line `k`.
bool step_to(int k, float share, inout Steps steps) {
  bool carry = carrying(steps);
  uint at = carry ? steps.at + 1u : 2u * (first_line + uint(k));
  ADD(echo_differences, echo_units, echo_before, echo_high)
#if WEIGHED
  ADD(weight_differences, weight_units, weight_before, weight_high)
#endif
  steps.at = at;
  return !carry;
}

const Steps no_steps = Steps(uvec2(0u), uvec2(0u), 0u, 0u, 0u);

void add_point(Place place) {
  if (!(place.line >= 0.0 && place.line < float(lines))) return;
  int k = int(place.line);
  int end = min(k + 1, lines - 1);
  float share = 1.0;
  for (Steps steps = no_steps; k <= end || carrying(steps);) {
    if (step_to(k, share, steps)) {
      ++k;
      share = 0.0;
    }
  }
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
  int end_of_steps = min(last + 1, lines - 1);
  Steps steps = no_steps;
  for (int k = first; k <= end_of_steps || carrying(steps);) {
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
    if (step_to(k, k <= last ? held / spread : 0.0, steps)) {
      k = even ? max(k, last_even) + 1 : k + 1;
    }
  }
}

// Whether two samples, one above the other, see one plane that echoes evenly (SkipRule::coplanar_samples).
bool coplanar(vec4 below, vec4 above, float width, float per_m) {
  vec4 more = above - below;
  float off = abs(more.x - 0.5 * (below.w + above.w) * pixel.y) + abs(more.w) * pixel.y + abs(more.z) * width;
  return above.x > 0.0 && off * per_m < most_off_plane && abs(more.y) <= most_response_step * (below.y + above.y);
}

// Returns the number of finished rows: two if the sample above was merged with this one, or if both are empty; otherwise
// one.
int bin(Part part, int row, bool may_pair) {
  vec4 seen = sample_at((THINNED + 1) * ivec2(part.column, row));  // range, response, range derivatives
  vec4 above = PAIRED == 1 ? sample_at((THINNED + 1) * ivec2(part.column, min(row + 1, part.row_end - 1))) : vec4(-1.0);
  if (!(seen.x > 0.0)) {
    if (seen.x < 0.0) ++own_invalid;
    return may_pair && above.x == 0.0 ? 2 : 1;
  }
  float per_m = lines_per_m.x + lines_per_m.y + lines_per_m.z;
  bool paired = may_pair && coplanar(seen, above, part.width, per_m);
  if (paired) seen.y = 0.5 * (seen.y + above.y);
  vec2 t = tangents_of(part, row);
#if THINNED  // a larger pixel, sampled off its middle
  vec3 middle = move_plane(seen.xzw, t - 0.25 * pixel, 0.25 * pixel);
  seen.xzw = vec3(seen.x + seen.x * middle.x, middle.yz);
#endif
  Cell cell = paired ? Cell(vec2(part.x_offset, 0.5 * pixel.y), 2.0 * pixel.y, 0.0) : cell_of(part, row);
  vec3 plane = vec3(0.0, seen.zw);
  if (FOOTPRINT == 1 && cell.offset != vec2(0.0)) plane = move_plane(seen.xzw, t, cell.offset);
  float across = abs(plane.y + cell.slope * plane.z) * part.width * per_m;
  float along = abs(plane.z) * cell.height * per_m;
  float weight = weight_of(t + cell.offset, part.width, cell.height);
#if ESTIMATE
  own_echo += echo_of(seen, part.width, cell.height, weight).xy;
#endif
  float echo = weight * seen.y;
  float all = seen.x + plane.x + across + along + echo;
  if (isnan(all) || isinf(all)) {
    ++own_invalid;
    return 1;
  }
  own_samples += paired ? 2u : 1u;
  own_pairs += paired ? 1u : 0u;
  echo_units = max(0.0, echo * units_per_sr);
  weight_units = weight * units_per_sr;
  if (echo_units > most_units) {
    echo_units = most_units;
    ++own_saturated;
  }
#if FOOTPRINT
    Place centre = moved(place_of(seen.x), seen.x * plane.x * per_m);
    add_trapezoid(centre, max(across, along), min(across, along));
#else
    add_point(place_of(seen.x));
#endif
  return paired ? 2 : 1;
}

void main() {
  int p = int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
  if (p >= part_count) return;
  Part part = part_at(p);
  look_at(part.view);
  first_line = uint(part.beam) * uint(lines);
  const int at_once = PAIRED + 1;  // rows
  bool fine = PAIRED == 1 && view_rows >= paired_rows;
  for (int row = part.row_begin + at_once * int(gl_LocalInvocationIndex); row < part.row_end;) {
    bool lower = (row - part.row_begin) % at_once == 0;
    // The first and the last row of a part are cut as the elevation limit cuts them.
    row += bin(part, row, fine && lower && row > part.row_begin && row + 2 < part.row_end);
    if ((row - part.row_begin) % at_once == 0) row += at_once * (COLUMN_GROUP - 1);
  }
#if ESTIMATE
  partial_columns[COLUMN_GROUP * p + int(gl_LocalInvocationIndex)] = own_echo;
#endif
  atomicAdd(additions, own_additions);
#if !THINNED
  atomicAdd(samples, own_samples);
  if (own_pairs != 0u) atomicAdd(pairs, own_pairs);
  if (own_invalid != 0u) atomicAdd(invalid, own_invalid);
  if (own_saturated != 0u) atomicAdd(saturated, own_saturated);
#endif
}
)glsl";

/// One work group per beam: from differences to lines of the image, and the error of the thinned samples'
/// lines.
inline constexpr char sum_shader[] = R"glsl(
layout(local_size_x = BEAM_GROUP) in;

// [beam][line], low word first
layout(binding = 8) uniform usamplerBuffer echo_differences;
layout(binding = 9) uniform usamplerBuffer weight_differences;
layout(binding = 10) uniform usamplerBuffer thinned_differences;
layout(binding = 11) uniform usamplerBuffer thinned_weights;
// The echo [beam][line] as in BinningResult, then open_sr.
layout(std430, binding = 4) buffer Image { uint counts[5]; float image[]; };
layout(std430, binding = 5) readonly buffer Beams { Beam beams[]; };
layout(std430, binding = 7) buffer Estimates { Estimate estimates[]; };

layout(location = 8) uniform int image_beams;  // of the page
layout(location = 19) uniform int first_beam;   // of the page
layout(location = 9) uniform float sr_per_unit;
layout(location = 10) uniform bool mean;
layout(location = 11) uniform bool open_water;
layout(location = 12) uniform float least_share;
layout(location = 13) uniform float least_open;
layout(location = 14) uniform bool estimating;
layout(location = 15) uniform float least_level;
layout(location = 16) uniform int first_estimate;

shared uvec2 up_to[2][BEAM_GROUP];
shared vec2 gathered[BEAM_GROUP];

// What the invocations before this one hold together.
uvec2 sum_before(uvec2 own) {
  uint me = gl_LocalInvocationIndex;
  int from = 0;
  up_to[from][me] = own;
  barrier();
  for (uint distance = 1u; distance < uint(BEAM_GROUP); distance *= 2u) {
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

float strongest_of_all(float own) {
  uint me = gl_LocalInvocationIndex;
  gathered[me].x = own;
  barrier();
  for (uint half_of = uint(BEAM_GROUP) / 2u; half_of > 0u; half_of /= 2u) {
    if (me < half_of) gathered[me].x = max(gathered[me].x, gathered[me + half_of].x);
    barrier();
  }
  float strongest = gathered[0].x;
  barrier();
  return strongest;
}

vec2 sum_of_all(vec2 own) {
  uint me = gl_LocalInvocationIndex;
  gathered[me] = own;
  barrier();
  for (uint half_of = uint(BEAM_GROUP) / 2u; half_of > 0u; half_of /= 2u) {
    if (me < half_of) gathered[me] += gathered[me + half_of];
    barrier();
  }
  return gathered[0];
}

float steradians(uvec2 units) {
  return (float(units.y) * 4294967296.0 + float(units.x)) * sr_per_unit;
}

float line_value(float echo, float weight, float whole) {
  if (!mean) return echo;
  return weight > least_share * whole ? min(1.0, echo / weight) : 0.0;
}

// By how much a line differs from the one before.
#define STEP(differences, line) minus(texelFetch(differences, line).xy, uvec2(start_of_sum, 0u))

// What the invocations before this one hold together of `count` lines each.
#define SUM_BEFORE(name, differences) \
  uvec2 name(int first, int count) { \
    uvec2 sum = uvec2(0u); \
    for (int i = first; i < first + count; ++i) sum = plus(sum, STEP(differences, i)); \
    return sum_before(sum); \
  }
SUM_BEFORE(echo_before, echo_differences)
SUM_BEFORE(weight_before, weight_differences)
SUM_BEFORE(thinned_before, thinned_differences)
SUM_BEFORE(thinned_weight_before, thinned_weights)

void main() {
  Beam beam = beams[gl_WorkGroupID.x];
  int each = (lines + BEAM_GROUP - 1) / BEAM_GROUP;
  int begin = min(int(gl_LocalInvocationIndex) * each, lines);
  int count = min(each, lines - begin);
  int first = int(gl_WorkGroupID.x) * lines + begin;
  int to = (beam.in_image - first_beam) * lines + begin;
  int open_to = to + image_beams * lines;
  float whole = beam.solid_angle;

  uvec2 echo_units = echo_before(first, count);
  uvec2 weight_units = uvec2(0u), blocked = uvec2(0u);
  if (WEIGHED == 1) weight_units = weight_before(first, count);
  if (open_water) {
    uvec2 here = weight_units;
    for (int i = 0; i < count; ++i) {
      here = plus(here, STEP(weight_differences, first + i));
      blocked = plus(blocked, here);
    }
    blocked = sum_before(blocked);
  }
  float strongest = 0.0;
  for (int i = 0; i < count; ++i) {
    echo_units = plus(echo_units, STEP(echo_differences, first + i));
    float weight = 0.0;
    if (WEIGHED == 1) {
      weight_units = plus(weight_units, STEP(weight_differences, first + i));
      weight = steradians(weight_units);
      if (open_water) {
        float open = whole - steradians(blocked) - 0.5 * weight;
        image[open_to + i] = open > least_open * whole ? open : 0.0;
        blocked = plus(blocked, weight_units);
      }
    }
    float value = line_value(steradians(echo_units), weight, whole);
    image[to + i] = value;
    if (estimating) strongest = max(strongest, value * texelFetch(line_weight, begin + i).x);
  }
  if (!estimating) return;

  strongest = strongest_of_all(strongest);
  echo_units = thinned_before(first, count);
  if (mean) weight_units = thinned_weight_before(first, count);
  vec2 off = vec2(0.0);  // squares, bins
  for (int i = 0; i < count; ++i) {
    echo_units = plus(echo_units, STEP(thinned_differences, first + i));
    float weight = 0.0;
    if (mean) {
      weight_units = plus(weight_units, STEP(thinned_weights, first + i));
      weight = steradians(weight_units);
    }
    float value = image[to + i];
    if (value * texelFetch(line_weight, begin + i).x > least_level * strongest) {
      float ratio = line_value(steradians(echo_units), weight, whole) / value - 1.0;
      off += vec2(ratio * ratio, 1.0);
    }
  }
  off = sum_of_all(off);
  if (gl_LocalInvocationIndex == 0u) {
    uint at = uint(first_estimate) + gl_WorkGroupID.x;
    estimates[at].bin_squares = off.x;
    estimates[at].bins = uint(off.y);
  }
}
)glsl";

}  // namespace sonard::render
