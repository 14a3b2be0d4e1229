// SPDX-License-Identifier: Apache-2.0
// One group for each slice: turns its pieces into patches. As SlicePatcher::shade() and add_patches().
#include "gpu/pieces.glsl"
#if MAPPED
#include "gpu/normal_maps.glsl"
#endif
layout(std430, binding = 6) buffer Pieces { uvec4 pieces[]; };  // as Piece; later as Patch

shared uint s_without_facets;

// ---- response laws ----

// 1 / (1 + exp(x)).
float sigmoid_of(float x) {
  float e = exp_of_negative(max(-abs(x), -80.0));
  return (x > 0.0 ? e : 1.0) / (1.0 + e);
}

// paper_response(). NaN gives NaN.
float paper_response(float of_cosine, float range_m) {
  float sum = surface.reflectance * of_cosine;
  sum *= exp_of_negative(max(-2.0 * echo.attenuation_per_m * range_m, -80.0));
  float x = echo.sigmoid_slope * (echo.sigmoid_centre - (sum > 1.0 ? 1.0 : sum));
  return isnan(x) ? x : sigmoid_of(x);
}

float response_at(float of_cosine) {
  return echo.is_physical != 0 ? surface.lambert_mu * of_cosine : paper_response(of_cosine, ranges.range_mid);
}

// ---- facets ----

// FacetSight::respond() for one of `parts` parts of the wedge; part 0 is at starboard.
FacetResponse wide_facets(FacetMaterial material, float part, float parts) {
  const float even = 0.05, nearly_even = 0.5, per_stride = 2.5, most_strides = 32.0;
  float slopes = slopes_across / parts;
  // Gauss-Legendre: one point, two points, or three per stride; over a stride the bell is smooth.
  int points = slopes < even ? 1 : slopes < nearly_even ? 2 : 3;
  float strides = points < 3 ? 1.0 : clamp(ceil(slopes / per_stride), 1.0, most_strides);
  float off = points == 1 ? 0.0 : points == 2 ? 0.28867513 : 0.38729833;
  float share_beside = points == 2 ? 0.5 : 5.0 / 18.0, share_at_middle = points == 1 ? 1.0 : 8.0 / 18.0;
  float middle_of_part = (part + 0.5) / parts - 0.5;
  FacetResponse sum;
  sum.mean = sum.moment = sum.gradient = 0.0;
  int samples = 3 * points * int(strides);
  for (int i = 0; i < samples; ++i) {
    int along = i % 3, point = (i / 3) % points;
    float stride = float(i / (3 * points));
    float side = points == 1 ? 0.0 : points == 2 ? float(2 * point - 1) : float(point - 1);
    float place = (stride + 0.5) / strides - 0.5 + side * off / strides;
    float share = (side == 0.0 ? share_at_middle : share_beside) / strides;
    float x = (middle_of_part + place / parts) * slice.width_rad;
    float response = share * facets_at(normal, material, x, t_at(along));
    float mean_share = along == 1 ? 4.0 / 6.0 : 1.0 / 6.0;
    sum.mean += mean_share * response;
    sum.moment += mean_share / parts * response * place;
    sum.gradient += float(along - 1) * response;
  }
  return sum;
}

// ---- elevation pattern ----

float pattern_at(float t) {
  float place = clamp(t * echo.pattern_per_t + echo.pattern_at_0, 0.0, 2.0 * echo.pattern_at_0 - 1e-3);
  int at = int(place), next = at + 1;
  float rest = place - float(at);
  return echo.pattern[at >> 2][at & 3] * (1.0 - rest) + echo.pattern[next >> 2][next & 3] * rest;
}

// ---- patches ----

float solid_angle, echo_gradient, range_gradient;  // as in SlicePatcher
float response, plain_response, centroid_offset;   // plain_response: without facets
FacetMaterial material;

// Sets response, echo_gradient and centroid_offset. @return false: there are no facets to add
bool shade() {
  float of_cosine = cosine.mean;
  vec2 mapped = vec2(cosine_mid, 1.0);  // incidence on the map, and mean length of its normals
#if MAPPED
  if ((surface.flags & has_map) != 0u && cosine_mid > 0.0) {
    mapped = mapped_incidence(cosine_mid);
    of_cosine = mapped.x * (of_cosine / cosine_mid);
  }
#endif
  response = plain_response = response_at(of_cosine);
  echo_gradient = is_plain ? cosine.gradient : 0.0;
  centroid_offset = 0.0;
#if FACETS
  material = FacetMaterial(surface.facet_strength, surface.slope_variance);
  if ((surface.flags & has_map) != 0u) {
    bool has_facets = echo.facets_anywhere != 0 || surface.facet_strength > 0.0;
    float direction = min(mapped.x / mapped.y, 1.0);
    float added = mapped.y < 1.0 ? (1.0 - mapped.y) / max(mapped.y, 0.1) : 0.0;
    material.variance = min(material.variance + added, 0.25);
    response += has_facets ? facet_law(direction * direction, material.strength, material.variance) : 0.0;
    return has_facets;
  }
  if (may_respond) {
    FacetResponse facets = facets_of_segment(normal, material, piece.low, piece.high, slice.width_rad);
    if (slopes_across > widest_facets) {
      facets = wide_facets(material, 0.0, 1.0);
    }
    response += facets.mean;
    if (response > 0.0) {
      echo_gradient = (echo_gradient * plain_response + 0.5 * facets.gradient) / response;
      centroid_offset = facets.moment / response;
    }
    return true;
  }
#endif
  return false;
}

void weigh_by_pattern() {
  if (echo.has_pattern != 0) {
    float weights[3];
    for (int k = 0; k < 3; ++k) {
      weights[k] = pattern_at(t_at(k));
    }
    float weight = mean_weight(piece.low, piece.high, weights[0], weights[1], weights[2], echo_gradient);
    solid_angle *= weight;
    if (range_gradient != 0.0 && weight > 0.0) {
      range_gradient += 0.5 * (weights[2] - weights[0]) / weight;
    }
  }
  echo_gradient = range_gradient != 0.0 ? within_one(range_gradient + echo_gradient) : 0.0;
  range_gradient = within_one(range_gradient);
}

Piece piece_at(uint i) {
  vec4 ends = uintBitsToFloat(pieces[2u * i]);
  uvec4 rest = pieces[2u * i + 1u];
  return Piece(ends.x, ends.y, ends.z, ends.w, rest.x, rest.y, rest.z, rest.w);
}

void set_patch(uint i, Patch p) {
  pieces[2u * i] = floatBitsToUint(vec4(p.range_a, p.range_b, p.smear_a, p.smear_b));
  pieces[2u * i + 1u] = floatBitsToUint(vec4(p.echo, p.weight, p.echo_gradient, p.weight_gradient));
}

#if FACETS
// Number of patches side by side, if facets are much stronger at one side of the wedge. If one patch will do, moved_m
// gets the move of its centroid.
int patches_beside(out float moved_m) {
  float by_wedge_m = 0.5 * (ranges.by_azimuth_low + ranges.by_azimuth_high) * slice.width_rad;
  moved_m = by_wedge_m * centroid_offset;
  float turn_across_rad = slopes_across * sqrt(surface.slope_variance);
  if (abs(moved_m) < 0.25 * echo.facet_m && turn_across_rad * ranges.range_mid * slice.width_rad < echo.facet_m) {
    return 1;
  }
  float wedge_m = ranges.range_mid * slice.width_rad, slopes[3];
  for (int k = 0; k < 3; ++k) {
    slopes[k] = range_slope(normal, 0.5 * float(k - 1) * slice.width_rad, t_at(1));
  }
  moved_m = wedge_m * slopes[1] * centroid_offset;
  float sagitta_m = 0.125 * wedge_m * (1.0 - plain_response / response) * (slopes[2] - slopes[0]);
  return patches_side_by_side(moved_m, sagitta_m, echo.facet_m);
}

// The part at `place` across the wedge, of `count` parts, with its own response.
Patch patch_beside(Patch whole, FacetResponse facets, float place, float count) {
  float of_part = plain_response + facets.mean;
  float offset = of_part > 0.0 ? facets.moment / of_part : 0.0;
  Patch part = whole;
  part.weight /= count;
  part.echo = of_part * part.weight;
  for (int end = 0; end < 2; ++end) {
    float t = end == 0 ? piece.low : piece.high, range_m = end == 0 ? whole.range_a : whole.range_b;
    // The range at the azimuth of the slice instead of the mean over the wedge.
    float n = seen.normal_h + seen.normal_z * t;
    range_m /= 1.0 + sagitta_of_plane(seen.normal_h / n, seen.normal_s / n, slice.width_rad);
    float wedge_m = range_m * slice.width_rad, slopes[3];
    for (int k = 0; k < 3; ++k) {
      slopes[k] = range_slope(normal, 0.5 * float(k) * place * slice.width_rad, t);
    }
    float on_the_way = slopes[0] + 4.0 * slopes[1] + slopes[2];
    range_m += wedge_m * (place * on_the_way * (1.0 / 6.0) + slopes[2] * offset);
    float smear_m = wedge_m * abs(slopes[2]) / count;
    part.range_a = end == 0 ? range_m : part.range_a;
    part.smear_a = end == 0 ? smear_m : part.smear_a;
    part.range_b = end == 0 ? part.range_b : range_m;
    part.smear_b = end == 0 ? part.smear_b : smear_m;
  }
  return part;
}

// Puts patches side by side in the place of piece i.
void add_beside(uint i, Patch whole, int count) {
  uint begin = atomicAdd(counts.needed.pieces, uint(count));
  if (begin + uint(count) > ping.room.pieces) {
    return;
  }
  for (int k = 0; k < count; ++k) {
    FacetResponse facets = wide_facets(material, float(k), float(count));
    set_patch(begin + uint(k), patch_beside(whole, facets, (float(k) + 0.5) / float(count) - 0.5, float(count)));
  }
  pieces[2u * i] = uvec4(is_elsewhere, begin, count, 0u);
}
#endif

void make_patches(uint i) {
  Patch whole = Patch(ranges.range_low, ranges.range_high, gradient.smear_low, gradient.smear_high,
                      response * solid_angle, solid_angle, echo_gradient, range_gradient);
#if FACETS
  if (centroid_offset != 0.0) {
    float moved_m;
    int beside = patches_beside(moved_m);
    if (beside > 1) {
      add_beside(i, whole, beside);
      return;
    }
    whole.range_a += moved_m;
    whole.range_b += moved_m;
  }
#endif
  set_patch(i, whole);
}

void main() {
  uint number = group_number();
  if (!has_slice(number, counts.needed)) {
    return;
  }
  slice = slices[number];
  if (lane == 0u) {
    s_without_facets = 0u;
  }
  barrier();
  uint without_facets = 0u;
  SlicePieces mine = of_slice[number];
  for (uint i = lane; i < mine.count; i += GROUP) {
    measure(piece_at(mine.first + i));
    solid_angle = ranges.solid_angle;
    range_gradient = gradient.gradient;
    without_facets += shade() ? 0u : 1u;
    weigh_by_pattern();
    make_patches(mine.first + i);
  }
  atomicAdd(s_without_facets, without_facets);
  barrier();
  if (lane == 0u) {
    atomicAdd(counts.without_facets, s_without_facets);
  }
  report_cut_loops();
}
