// SPDX-License-Identifier: Apache-2.0
// The GLSL with which GpuBinner estimates the error of every beam from its samples (docs/accuracy.md). Along
// a surface, the change of the echo from column to column and from row to row is steady. A jump of the change
// is an edge, at an unknown place between the centres of two columns or rows. All sums have a fixed order.
#pragma once

namespace sonard::render {

/// The echo of a sample and its first moment over the range.
inline constexpr char strip_shader_head[] = R"glsl(
// Echo, first moment in lines, share of the pixel that counts. `weight` is the pixel's.
vec3 echo_of(vec4 seen, float width, float height, float weight) {
  float per_m = lines_per_m.x + lines_per_m.y + lines_per_m.z;
  float line = seen.x * per_m;
  float half_spread = 0.5 * per_m * (abs(seen.z) * width + abs(seen.w) * height);
  float end = float(lines);
  // A surface that the last line cuts through has no edge there: neither the part of a pixel beyond it nor the next
  // few pixels count.
  if (!(line > 0.0) || !(line - 9.0 * half_spread < end)) return vec3(0.0, 0.0, 1.0);
  if (line - half_spread >= end) return vec3(0.0);
  bool cut = line + half_spread > end;
  float share = cut ? (end - line + half_spread) / (2.0 * half_spread) : 1.0;
  float middle = cut ? (end + line - half_spread) / 2.0 : line;
  float echo = seen.y * weight * share * texelFetch(line_weight, clamp(int(middle), 0, lines - 1)).x;
  if (isnan(echo) || isinf(echo)) return vec3(0.0, 0.0, 1.0);
  return vec3(echo, echo * middle, share);
}
)glsl";

/// One invocation per row of a beam: the sums of the row. Cells are computed here, so that data in registers
/// need not be fetched for each cell.
inline constexpr char row_shader[] = R"glsl(
layout(local_size_x = 64) in;
// The columns of a beam in a view: GpuSegment.
layout(binding = 8) uniform isamplerBuffer segments;
layout(std430, binding = 0) writeonly buffer Rows { vec4 rows[]; };  // [beam][row]: echo, moment, width
layout(std430, binding = 5) readonly buffer Beams { Beam beams[]; };
layout(location = 5) uniform int most_rows;   // of any beam
layout(location = 6) uniform float tan_limit;

// What a row holds of a segment; x_begin and x_end are the tangents of its sides.
vec4 row_of(int row, int column_begin, int column_end, float x_begin, float x_end) {
  vec4 sum = vec4(0.0);
  float below = bottom + (float(row) - 0.5) * pixel.y;
  for (int column = column_begin; column < column_end; ++column) {
    float x = left + float(column) * pixel.x;
    float from = max(x_begin, x - 0.5 * pixel.x);
    float to = min(x_end, x + 0.5 * pixel.x);
    float middle = 0.5 * (from + to);
    float limit = tan_limit * sqrt(1.0 + middle * middle);
    float low = max(below, -limit);
    float high = min(below + pixel.y, limit);
    if (high > low) {
      vec4 seen = sample_at(ivec2(column, row));
      float weight = weight_of(vec2(middle, 0.5 * (low + high)), to - from, high - low);
      vec3 echo = echo_of(seen, to - from, high - low, weight);
      sum += vec4(echo.xy, (to - from) * (high - low) * echo.z, 0.0);
    }
  }
  return sum;
}

void main() {
  int row = int(gl_WorkGroupID.y) * 64 + int(gl_LocalInvocationIndex);
  Beam beam = beams[gl_WorkGroupID.x];
  if (row >= beam.rows) return;
  vec4 sum = vec4(0.0);
  for (int s = beam.segment_begin; s < beam.segment_end; ++s) {
    ivec4 place = texelFetch(segments, 2 * s);
    look_at(place.x);
    if (row < view_rows) {
      sum += row_of(row, place.y, place.z, intBitsToFloat(place.w), intBitsToFloat(texelFetch(segments, 2 * s + 1).x));
    }
  }
  rows[int(gl_WorkGroupID.x) * most_rows + row] = sum;
}
)glsl";

/// One invocation per part: the sum over the invocations of splat_shader.
inline constexpr char column_shader[] = R"glsl(
layout(local_size_x = 64) in;
layout(binding = 8) uniform samplerBuffer partial_columns;
layout(std430, binding = 1) writeonly buffer Columns { vec2 columns[]; };
layout(location = 7) uniform int part_count;

void main() {
  int p = int(gl_GlobalInvocationID.x);
  if (p >= part_count) return;
  vec2 sum = vec2(0.0);
  for (int i = COLUMN_GROUP * p; i < COLUMN_GROUP * (p + 1); ++i) sum += texelFetch(partial_columns, i).xy;
  columns[p] = sum;
}
)glsl";

/// One work group per beam.
inline constexpr char estimate_shader[] = R"glsl(
layout(local_size_x = BEAM_GROUP) in;
layout(binding = 8) uniform samplerBuffer columns;  // echo, moment: of each part
layout(binding = 9) uniform samplerBuffer rows;
layout(std430, binding = 3) coherent buffer ColumnMisses { float column_misses[]; };
layout(std430, binding = 5) readonly buffer Beams { Beam beams[]; };
layout(std430, binding = 7) buffer Estimates { Estimate estimates[]; };

layout(location = 5) uniform int most_rows;
layout(location = 16) uniform int first_estimate;
layout(location = 17) uniform vec2 most_error;  // of a beam's total and centroid: the error that counts as 1
layout(location = 18) uniform float most_rest;  // of a zone: the square of what may lie outside of it

shared vec4 gathered[BEAM_GROUP];

vec4 sum_of_all(vec4 own) {
  uint me = gl_LocalInvocationIndex;
  gathered[me] = own;
  barrier();
  for (uint half_of = uint(BEAM_GROUP) / 2u; half_of > 0u; half_of /= 2u) {
    if (me < half_of) gathered[me] += gathered[me + half_of];
    barrier();
  }
  vec4 sum = gathered[0];
  barrier();
  return sum;
}

// Upper limit of a strip's error in total and centroid, from the echo (and its moment) per unit of width of three
// neighbours. A single jump is met twice, and the edge lies within half a strip of its assumed place.
vec2 strip_error(vec2 a, vec2 b, vec2 c, float to_before, float to_after, float width, float all, float all_at) {
  vec2 bend = width * min(to_before, to_after) * ((c - b) / to_after - (b - a) / to_before);
  return abs(vec2(bend.x, bend.y - all_at * bend.x)) / (2.8284271 * all);
}

float miss(vec2 error) {
  return max(error.x / most_error.x, error.y / most_error.y);
}

void main() {
  Beam beam = beams[gl_WorkGroupID.x];
  uint me = gl_LocalInvocationIndex;
  vec4 all = vec4(0.0);
  for (int p = beam.part_begin + int(me); p < beam.part_end; p += BEAM_GROUP) all.xy += texelFetch(columns, p).xy;
  all = sum_of_all(all);
  float all_at = all.y / all.x;  // the centroid

  vec4 by_columns = vec4(0.0);  // squares of total and centroid, thin columns
  if (all.x > 0.0) {
    for (int p = beam.part_begin + int(me); p < beam.part_end; p += BEAM_GROUP) {
      Part part = part_at(p);
      // At the end of what was sampled, as from the column before it.
      bool first = part.before == p, last = part.after == p;
      int middle = first ? part.after : last ? part.before : p;
      Part here = part_at(middle);
      vec2 a = texelFetch(columns, here.before).xy / part_at(here.before).width_rad;
      vec2 b = texelFetch(columns, middle).xy / here.width_rad;
      vec2 c = texelFetch(columns, here.after).xy / part_at(here.after).width_rad;
      vec2 error = here.before == middle || here.after == middle
                       ? vec2(0.0)
                       : strip_error(a, b, c, here.to_before, here.to_after, part.width_rad, all.x, all_at);
      bool thin = !first && !last && b.x > 2.0 * max(a.x, c.x);
      by_columns += vec4(error * error, thin ? 1.0 : 0.0, 0.0);
      column_misses[p] = miss(error);
    }
  }
  by_columns = sum_of_all(by_columns);

  vec4 by_rows = vec4(0.0);
  int first_row = int(gl_WorkGroupID.x) * most_rows;
  if (all.x > 0.0) {
    for (int j = 1 + int(me); j + 1 < beam.rows; j += BEAM_GROUP) {
      vec4 a = texelFetch(rows, first_row + j - 1), b = texelFetch(rows, first_row + j),
           c = texelFetch(rows, first_row + j + 1);
      // Rows that the elevation limit or the last line nearly empties give no information.
      float least = 0.1 * b.z;
      if (b.z > 0.0 && a.z > least && c.z > least) {
        vec2 error = strip_error(a.xy / a.z, b.xy / b.z, c.xy / c.z, b.z, b.z, b.z, all.x, all_at);
        by_rows.xy += error * error;
      }
    }
  }
  by_rows = sum_of_all(by_rows);
  memoryBarrierBuffer();
  barrier();
  if (me != 0u) return;

  // The zone with the edges: both ends are trimmed while the discarded part stays small.
  int begin = beam.part_begin, end = beam.part_end;
  float rest = 0.0, within = 0.0;
  if (all.x > 0.0) {
    for (int p = begin; p < end; ++p) within += column_misses[p] * column_misses[p];
    while (end - begin > 1) {
      float port = column_misses[begin] * column_misses[begin];
      float starboard = column_misses[end - 1] * column_misses[end - 1];
      if (rest + min(port, starboard) > most_rest) break;
      rest += min(port, starboard);
      if (port < starboard) ++begin; else --end;
    }
  }
  uint at = uint(first_estimate) + gl_WorkGroupID.x;
  estimates[at].columns_total = sqrt(by_columns.x);
  estimates[at].columns_centroid_lines = sqrt(by_columns.y);
  estimates[at].rows_total = sqrt(by_rows.x);
  estimates[at].rows_centroid_lines = sqrt(by_rows.y);
  estimates[at].thin = uint(by_columns.z);
  estimates[at].zone_begin = begin - beam.part_begin;
  estimates[at].zone_end = end - beam.part_begin;
  estimates[at].zone_miss = sqrt(max(0.0, within - rest));
}
)glsl";

}  // namespace sonard::render
