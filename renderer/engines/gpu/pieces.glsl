// SPDX-License-Identifier: Apache-2.0
// What a slice sees of a piece: ranges, incidence, the turn of facets. As SlicePatcher. The macros SHADED
// (some part is shaded by vertex normals), MAPPED (some part has a normal map) and FACETS are 0 or 1.

// clang-format off
#include "gpu/echoes.glsl"
#include "slices/patches.glsl"
#include "slices/facets.glsl"
layout(std430, binding = 0) readonly buffer Slices { Slice slices[]; };
layout(std430, binding = 1) readonly buffer VisibleSegments { Visible visible[]; };
layout(std430, binding = 2) buffer PiecesOfSlices { SlicePieces of_slice[]; };
layout(std430, binding = 3) readonly buffer Surfaces { Surface surfaces[]; };
layout(std430, binding = 4) readonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 5) buffer Counts { PingCounts counts; };
// Indices of triangles; normals of vertices, and texture coordinates and tangents if mapped; normal maps.
layout(std430, binding = 7) readonly buffer World { uint world[]; };
// clang-format on

Slice slice;

// The piece at hand:
Piece piece;
Visible seen;
FanTriangle triangle;
Surface surface;
NormalField normal;   // of any length
PlaneSegment ranges;  // by the plane of its triangle
CosineRun cosine;     // of the incidence; the mean is at most 1
float cosine_mid;
bool is_plain;  // the response is the cosine, which changes evenly
RangeGradient gradient;
float slopes_per_t, slopes_across;  // turn of the facets' direction, in rms slopes
bool may_respond;                   // its facets

// Tangent of the elevation: 0 at the low end, 1 in the middle, 2 at the high end.
float t_at(int k) {
  return k == 0 ? piece.low : k == 1 ? 0.5 * (piece.low + piece.high) : piece.high;
}

bool is_mapped() {
  return MAPPED == 1 && (surface.flags & has_map) != 0u && surface.level_count > 1u;
}

vec3 in_slice(vec3 v) {
  return vec3(slice.cosine * v.x + slice.sine * v.y, slice.cosine * v.y - slice.sine * v.x, v.z);
}

vec3 corner_of(uint k) {
  Corner corner = triangle.corners[k];
  return vec3(corner.x, corner.y, corner.z);
}

vec3 in_sonar_frame(vec3 v) {
  float r[9] = surface.rotation;
  return vec3(r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
              r[6] * v.x + r[7] * v.y + r[8] * v.z);
}

// Word of `world` where the k-th vertex of the triangle begins.
uint vertex_of(uint k) {
  return surface.vertices +
         surface.floats_per_vertex * world[surface.indices + 3u * triangle.mesh_triangle + k];
}

vec3 vertex_normal(uint k) {
  uint at = vertex_of(k);
  return in_sonar_frame(uintBitsToFloat(uvec3(world[at], world[at + 1u], world[at + 2u])));
}

#if SHADED
// The interpolated normals of the triangle (VertexNormals), turned by refraction in the middle of the
// segment.
NormalField smooth_normal() {
  vec3 corner = corner_of(0u), edge_b = corner_of(1u) - corner, edge_c = corner_of(2u) - corner;
  vec3 across = cross(edge_b, edge_c);
  vec3 a = vertex_normal(0u), by_b = vertex_normal(1u) - a, by_c = vertex_normal(2u) - a;
  float nn = dot(across, across);
  vec3 grows_to_b = cross(edge_c, across) / nn, grows_to_c = cross(across, edge_b) / nn;
  vec3 at_sonar = a - by_b * dot(grows_to_b, corner) - by_c * dot(grows_to_c, corner);
  vec3 depth = across / dot(across, corner);
  // At the hit of a ray d the normal is this matrix times d.
  mat3 field =
      outerProduct(at_sonar, depth) + outerProduct(by_b, grows_to_b) + outerProduct(by_c, grows_to_c);
  vec3 at = in_slice(field[0] * slice.cosine + field[1] * slice.sine);
  vec3 per_x = in_slice(field[1] * slice.cosine - field[0] * slice.sine), per_t = in_slice(field[2]);
  if (ping.bend_per_m != 0.0) {
    vec3 up = in_slice(vec3(ping.up_x, ping.up_y, ping.up_z)), nearness = in_slice(depth);
    float t = 0.5 * (seen.low + seen.high);
    vec3 middle = (at + t * per_t) / (nearness.x + t * nearness.z);
    float turn = 2.0 * ping.bend_per_m * dot(middle, up);
    at -= turn * (vec3(1.0, 0.0, 0.0) - up * up.x);
    per_x -= turn * (vec3(0.0, 1.0, 0.0) - up * up.y);
    per_t -= turn * (vec3(0.0, 0.0, 1.0) - up * up.z);
  }
  return NormalField(at.x, at.y, at.z, per_x.x, per_x.y, per_x.z, per_t.x, per_t.y, per_t.z);
}

bool is_finite(NormalField n) {
  float sum = abs(n.at_h) + abs(n.at_s) + abs(n.at_z) + abs(n.h_per_x) + abs(n.s_per_x) + abs(n.z_per_x) +
              abs(n.h_per_t) + abs(n.s_per_t) + abs(n.z_per_t);
  return sum < never;  // false for NaN
}

void shade_smoothly() {
  float cosines[3];
  for (int k = 0; k < 3; ++k) {
    float t = t_at(k);
    cosines[k] = cosine_of_normal(normal.at_h + normal.h_per_t * t, normal.at_s + normal.s_per_t * t,
                                  normal.at_z + normal.z_per_t * t, t);
  }
  CosineRun run = cosine_run(cosines[0], cosines[1], cosines[2]);
  if (run.mean >= 0.0) {  // a direction
    cosine = run;
    cosine_mid = cosines[1];
  }
}
#endif

// Sets the normals that shade the piece. @return false: those of its plane
bool find_normal() {
  normal = NormalField(seen.normal_h, seen.normal_s, seen.normal_z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
#if SHADED
  if ((surface.flags & has_vertex_normals) != 0u && !is_mapped()) {
    NormalField smooth_one = smooth_normal();
    if (is_finite(smooth_one)) {
      normal = smooth_one;
      return true;
    }
  }
#endif
  return false;
}

void find_facet_turn() {
  bool anywhere = echo.facets_anywhere != 0;
  bool has_none =
      (MAPPED == 1 && (surface.flags & has_map) != 0u) || (!anywhere && !(surface.facet_strength > 0.0));
  float least_cosine = has_none ? 1e9 : anywhere ? -1.0 : surface.least_cosine;
  FacetTurn turn = turn_of_facets(normal, t_at(1), slice.width_rad);
  float slope = sqrt(surface.slope_variance);
  slopes_per_t = turn.along_per_t / slope;
  slopes_across = turn.across_rad / slope;
  may_respond = facets_may_respond(turn, piece.high - piece.low, least_cosine);
}

// Makes a piece the piece at hand. Its ends must have been straightened.
void measure(Piece at_hand) {
  piece = at_hand;
  seen = visible[piece.segment];
  triangle = fan[seen.triangle];
  surface = surfaces[triangle.flags >> part_shift];
  PlaneLine plane = PlaneLine(seen.w_at_0, seen.w_slope, seen.normal_h, seen.normal_s, seen.normal_z);
  ranges = segment_of_plane(plane, piece.low, piece.high, piece.low_slope, piece.high_slope, slice.width_rad);
  cosine = cosine_run(ranges.cosine_low, ranges.cosine_mid, ranges.cosine_high);
  cosine_mid = ranges.cosine_mid;
  is_plain = echo.is_physical != 0 && !is_mapped();
  bool is_smooth = find_normal();
#if SHADED
  if (is_smooth) {
    shade_smoothly();
  }
#endif
  cosine.mean = cosine.mean < 1.0 ? cosine.mean : 1.0;
#if FACETS
  find_facet_turn();
#endif
  RangeSpan span = RangeSpan(
      piece.low, piece.high, ranges.range_low, ranges.range_mid, ranges.range_high,
      abs(ranges.by_azimuth_low) * slice.width_rad, abs(ranges.by_azimuth_high) * slice.width_rad,
      abs(piece.high_slope - piece.low_slope) * slice.width_rad, is_plain ? cosine.gradient : 0.0, is_plain);
  // A gradient moves the middle of the echo by a third of this.
  gradient = gradient_of(span, 0.5 * echo.displaced_m, ping.fan.sampled_range_m);
}
