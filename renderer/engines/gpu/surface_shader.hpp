// SPDX-License-Identifier: Apache-2.0
// The GLSL of RasterSampler: one SurfaceSample per pixel. No discard: it would move the depth test behind the
// shader.
//
// Each kind of surface has a program of its own, which begins with surface_shader_head() and holds only what
// that kind takes: a software OpenGL runs both sides of every branch.
#pragma once

#include <string>

#include <fmt/format.h>

#include "renderer/surface/surface_model.hpp"

namespace sonard::render {

/// What of a surface decides which program draws it: where the normal comes from that its echo is taken by.
enum class Shading { geometric_normal = 0, vertex_normals = 1, normal_mapped = 2 };

/// Locations of the uniforms that belong to a view; OpenSceneGraph has the others.
enum ViewUniform : int { at_tan_half, at_pixels, at_refraction, at_corner };

/// The beginning of all three shaders. FACETS: 0 none, 1 near normal incidence, 2 everywhere. BENT: rays are.
/// TWO_SIDED: back faces are drawn.
inline std::string surface_shader_head(Shading shading, const SurfaceModel& surface, bool bent) {
  return fmt::format(
      "#version 450 compatibility\n#define SHADING {}\n#define FACETS {}\n#define PHYSICAL {:d}\n#define "
      "BENT {:d}\n#define TWO_SIDED {:d}\n",
      static_cast<int>(shading), static_cast<int>(surface.facets), surface.model == Model::physical, bent,
      surface.two_sided);
}

/// What the vertex shader hands to the geometry shader: both begin with it.
inline constexpr char surface_corner[] = R"glsl(
struct Corner {
  vec3 in_body, in_eye;  // positions
#if BENT
  vec3 unbent;           // in_eye, were rays straight
#endif
#if SHADING != 0
  vec3 normal_eye;
#endif
#if SHADING == 2
  vec4 tangent_eye;
  vec2 texcoord;
#endif
};
)glsl";

inline constexpr char surface_vertex_shader[] = R"glsl(
layout(location = 0) in vec4 position;  // VertexAttribute
layout(location = 1) in vec3 normal;
#if SHADING == 2
layout(location = 2) in vec2 mapped_at;
layout(location = 3) in vec4 tangent;  // xyz unit, w handedness
#endif
#if BENT
layout(location = 2) uniform vec4 refraction;  // Refraction in eye coordinates: up, per_m
#endif
out Corner corner;

void main() {
  vec3 p = (gl_ModelViewMatrix * position).xyz;
#if SHADING != 0
  corner.normal_eye = gl_NormalMatrix * normal;
#endif
#if BENT  // Refraction::point() and normal(), term by term
  corner.unbent = p;
  float height = dot(p, refraction.xyz);
  float squared = dot(p, p);
#if SHADING != 0
  corner.normal_eye -= (p - refraction.xyz * height) * (2.0 * refraction.w * dot(corner.normal_eye, refraction.xyz));
#endif
  vec3 lifted = p + refraction.xyz * (refraction.w * (squared - height * height));
  p = lifted * sqrt(squared / max(dot(lifted, lifted), 1e-30));
#endif
  gl_Position = gl_ProjectionMatrix * vec4(p, 1.0);
  corner.in_body = position.xyz;
  corner.in_eye = p;
#if SHADING == 2
  corner.tangent_eye = vec4(gl_NormalMatrix * tangent.xyz, tangent.w);
  corner.texcoord = mapped_at;
#endif
}
)glsl";

// The plane of a triangle from its corners, once, instead of from what the GPU interpolates between them:
// that is rounded as the GPU likes, and off by per cents where a triangle of a hundred metres passes a metre
// from the eye and is clipped there (docs/accuracy.md).
inline constexpr char surface_geometry_shader[] = R"glsl(
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
#if BENT
layout(location = 2) uniform vec4 refraction;
#endif
in Corner corner[];
flat out vec2 slope;      // of the inverse depth, per tangent
flat out vec3 anchor;     // tangents of a point of the plane, and its inverse depth
flat out float plane_distance;  // of the plane from the eye
#if SHADING != 0
out vec3 normal_eye;
#endif
#if SHADING == 2
out vec4 tangent_eye;
out vec2 texcoord;
#endif

bool outside_of_view() {
  vec4 a = gl_in[0].gl_Position, b = gl_in[1].gl_Position, c = gl_in[2].gl_Position;
  vec3 w = vec3(a.w, b.w, c.w), x = vec3(a.x, b.x, c.x), y = vec3(a.y, b.y, c.y);
  return all(greaterThan(x, w)) || all(lessThan(x, -w)) || all(greaterThan(y, w)) || all(lessThan(y, -w));
}

void main() {
  // What is not handed on costs least.
  if (outside_of_view()) return;
  // Differences of positions in the body have its roundings, not those of how far away it is.
  vec3 n = mat3(gl_ModelViewMatrix) *
           cross(corner[1].in_body - corner[0].in_body, corner[2].in_body - corner[0].in_body);
#if BENT  // as a normal of the vertex shader is, in the middle
  vec3 middle = (corner[0].unbent + corner[1].unbent + corner[2].unbent) / 3.0;
  n -= (middle - refraction.xyz * dot(middle, refraction.xyz)) * (2.0 * refraction.w * dot(n, refraction.xyz));
#endif
  vec3 p = corner[0].in_eye;  // the corner farthest ahead
  for (int i = 1; i < 3; ++i) {
    if (corner[i].in_eye.z < p.z) p = corner[i].in_eye;
  }
  float d = dot(n, p);
  if (d == 0.0 || p.z >= 0.0) return;  // seen edge-on, or behind the eye
#if !TWO_SIDED
  if (d > 0.0) return;
#endif
  for (int i = 0; i < 3; ++i) {
    gl_Position = gl_in[i].gl_Position;
    slope = n.xy / d;
    anchor = vec3(p.xy, 1.0) / -p.z;
    plane_distance = abs(d) * inversesqrt(dot(n, n));
#if SHADING != 0
    normal_eye = corner[i].normal_eye;
#endif
#if SHADING == 2
    tangent_eye = corner[i].tangent_eye;
    texcoord = corner[i].texcoord;
#endif
    EmitVertex();
  }
  EndPrimitive();
}
)glsl";

// Eye coordinates: x to starboard, y up, the view axis along -z. The ray of a pixel is q = (t.x, t.y, -1)
// with tangents t. On the plane n.p = d seen along p = depth * q the inverse depth is n.q / d, so it is
// affine in t, and with it come the exact range derivatives (docs/physics.md 2.3, equation 2), without
// differences of positions and without trouble where the plane is seen edge-on.
inline constexpr char surface_fragment_shader[] = R"glsl(
flat in vec2 slope;
flat in vec3 anchor;
flat in float plane_distance;
#if SHADING != 0
in vec3 normal_eye;
#endif
layout(location = 0) out vec4 surface_sample;

layout(location = 0) uniform vec2 tan_half;  // of the view
layout(location = 1) uniform vec2 pixels;
layout(location = 3) uniform vec2 view_corner;  // its lower left, in pixels
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
// Not of unit length where a map averages.
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

// Facets need a direction; what is missing of the length of a mean normal widens their slopes.
float facet_response_of_mean(float cos_phi, float mean_length) {
  float cosine = min(cos_phi / mean_length, 1.0);
#if FACETS == 1
  if (!(SHADING == 2 ? facet_strength > 0.0 : cosine > facets_least_cosine)) return 0.0;
#endif
  return facet_response(cosine, variance_of_mean_normal(mean_length));
}
#endif

void main() {
  vec2 pixel = 2.0 * tan_half / pixels;
  vec2 t = (gl_FragCoord.xy - view_corner) * pixel - tan_half;
  float inverse_depth = anchor.z + dot(slope, t - anchor.xy);
  float depth = 1.0 / inverse_depth;
  float qq = 1.0 + dot(t, t);
  float per_length = inversesqrt(qq);
  float range = qq * per_length * depth;
  vec2 range_d = range * (t / qq - slope * depth);

  float cosine = plane_distance * inverse_depth * per_length;
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
  surface_sample = any(isnan(result)) || any(isinf(result)) ? vec4(-1.0, 0.0, 0.0, 0.0) : result;
}
)glsl";

}  // namespace sonard::render
