// SPDX-License-Identifier: Apache-2.0
// One SurfaceSample per pixel. surface_shader_head() precedes it. No discard: it would move the depth test behind the
// shader.
//
// Eye coordinates: x to starboard, y up, the view axis along -z. The ray of a pixel is q = (t.x, t.y, -1) with tangents
// t. On the plane n.p = d, with p = depth * q, the inverse depth is n.q / d, which is affine in t. This gives the exact
// range derivatives (docs/physics.md 2.3, equation 2), without differences of positions, even for planes seen edge-on.

flat in vec4 plane;
#if SHADING != 0
in vec3 normal_eye;
#endif
layout(location = 0) out vec4 surface_sample;

uniform vec2 tan_half;  // of the view
uniform vec2 pixel;     // the tangents that one spans
#if SHADING == 2
in vec4 tangent_eye;
in vec2 texcoord;
uniform isampler2D normal_map;  // texels of all levels, one after the other, in rows of 4096
uniform ivec3 map_levels[16];    // width, height, first texel
uniform int map_level_count;
#endif
uniform float reflectance;
uniform float lambert_mu;
uniform float facet_strength;   // see Backscatter
uniform float slope_variance;
uniform float facets_least_cosine;
uniform vec2 sigmoid;         // slope, centre
uniform float attenuation_per_m;

#if SHADING == 2
// NormalPyramid::mean_normal() and its helper, term by term, on the same texels in the same order. Filters of the
// texture unit will not do: they weigh texels in steps of 1/256, and llvmpipe gives four pixels one level.
vec3 texel(int i) {
  return vec3(texelFetch(normal_map, ivec2(i & 4095, i >> 12), 0).xyz);
}

vec3 bilinear(ivec3 level, vec2 uv) {
  ivec2 size = level.xy;
  vec2 position = uv * vec2(size) - 0.5;
  vec2 corner = floor(position);
  vec2 part = position - corner;
  ivec2 low = ivec2(corner);
  low += ivec2(lessThan(low, ivec2(0))) * size - ivec2(greaterThanEqual(low, size)) * size;
  ivec2 high = low + 1;
  high -= ivec2(greaterThanEqual(high, size)) * size;
  int below = level.z + low.y * size.x;
  int above = level.z + high.y * size.x;
  return mix(mix(texel(below + low.x), texel(below + high.x), part.x),
             mix(texel(above + low.x), texel(above + high.x), part.x), part.y) / 32767.0;
}

vec3 mean_normal(vec2 uv, float level) {
  uv -= floor(uv);
  float held = level > 0.0 ? min(level, float(map_level_count - 1)) : 0.0;
  int low = int(held);
  float part = held - float(low);
  vec3 fine = bilinear(map_levels[low], uv);
  return part > 0.0 ? mix(fine, bilinear(map_levels[low + 1], uv), part) : fine;
}

// How many texels a pixel spans, as the level whose texels are as large. Like the inverse depth, texture
// coordinates over depth are affine in the tangents, so that their derivatives are exact.
float map_level(float inverse_depth, vec2 inverse_depth_step) {
  vec2 over_depth = texcoord * inverse_depth;
  vec2 texels_per_step = vec2(map_levels[0].xy) / inverse_depth;
  vec2 dx = (dFdx(over_depth) - texcoord * inverse_depth_step.x) * texels_per_step;
  vec2 dy = (dFdy(over_depth) - texcoord * inverse_depth_step.y) * texels_per_step;
  return 0.5 * log2(max(dot(dx, dx), dot(dy, dy)));
}
#endif

#if SHADING != 0
// Shorter than unit length if a map averages.
vec3 shading_normal(float inverse_depth, vec2 step) {
  vec3 n = normalize(normal_eye);
#if SHADING == 2
  vec3 t = normalize(tangent_eye.xyz - n * dot(n, tangent_eye.xyz));
  vec3 b = cross(n, t) * tangent_eye.w;
  vec3 m = mean_normal(texcoord, map_level(inverse_depth, step));
  n = t * m.x + b * m.y + n * m.z;
#endif
  return n;
}
#endif

#if FACETS != 0
// Backscatter::facets() and variance_of_mean_normal(), term by term.
float facet_response(float cos_phi, float added_variance) {
  float variance = min(slope_variance + added_variance, 0.25);
  float c2 = cos_phi * cos_phi;
  float exponent = (1.0 - c2) / (2.0 * variance * c2);
  return exponent < 80.0 ? facet_strength / (variance * c2 * c2 * cos_phi) * exp(-exponent) : 0.0;
}

float variance_of_mean_normal(float mean_length) {
  return mean_length < 1.0 ? (1.0 - mean_length) / max(mean_length, 0.1) : 0.0;
}

// Facets need a direction; a mean normal below unit length widens their slopes.
float facet_response_of_mean(float cos_phi, float mean_length) {
  float cosine = min(cos_phi / mean_length, 1.0);
#if FACETS == 1
  if (!(SHADING == 2 ? facet_strength > 0.0 : cosine > facets_least_cosine)) return 0.0;
#endif
  return facet_response(cosine, variance_of_mean_normal(mean_length));
}
#endif

void main() {
  vec2 t = gl_FragCoord.xy * pixel - tan_half;
  vec2 slope = plane.xy;  // of the inverse depth, per tangent
#if BENT  // small, and as a plane only that through its corners
  float inverse_depth = gl_FragCoord.w;
#else
  float inverse_depth = dot(plane.xyz, vec3(t, -1.0));
#endif
  float depth = 1.0 / inverse_depth;
  float qq = 1.0 + dot(t, t);
  float per_length = inversesqrt(qq);
  float range = qq * per_length * depth;
  vec2 range_d = range * (t * (1.0 / qq) - slope * depth);

  float cosine = plane.w * inverse_depth * per_length;
  float mean_length = 1.0;
#if SHADING != 0
  vec3 n = shading_normal(inverse_depth, slope * pixel);
  float of_normal = dot(n, vec3(t, -1.0)) * per_length;
  if (!isnan(of_normal)) {
    cosine = of_normal;
    mean_length = SHADING == 2 ? length(n) : 1.0;
  }
#endif
  float cos_phi = clamp(abs(cosine), 0.0, 1.0);
#if PHYSICAL
  float response = lambert_mu * cos_phi;
#if FACETS != 0
  response += facet_response_of_mean(cos_phi, mean_length);
#endif
#else
  float echo = min(1.0, reflectance * cos_phi * exp(-2.0 * attenuation_per_m * range));
  float response = 1.0 / (1.0 + exp(-sigmoid.x * (echo - sigmoid.y)));
#endif
  vec4 result = vec4(range, response, range_d);
  float all = range + response + range_d.x + range_d.y;
  // A triangle seen edge-on may be drawn all the same, but has no echo.
  surface_sample = !(inverse_depth > 0.0) ? vec4(0.0)
                   : isnan(all) || isinf(all) ? vec4(-1.0, 0.0, 0.0, 0.0) : result;
}
