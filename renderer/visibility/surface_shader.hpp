// The GLSL of RasterSampler: one SurfaceSample per pixel. No discard: it would move the depth test behind the shader.
#pragma once

namespace sonard::render {

inline constexpr char surface_vertex_shader[] = R"glsl(#version 450 compatibility
layout(location = 6) in vec4 tangent;  // xyz unit, w handedness
out vec3 normal_eye;
out vec4 tangent_eye;
out vec2 texcoord;

void main() {
  gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex;
  normal_eye = gl_NormalMatrix * gl_Normal;
  tangent_eye = vec4(gl_NormalMatrix * tangent.xyz, tangent.w);
  texcoord = gl_MultiTexCoord0.xy;
}
)glsl";

// Eye coordinates: x to starboard, y up, the view axis along -z. The ray of a pixel is q = (t.x, t.y, -1)
// with tangents t. On the plane n.p = 1 seen along p = depth * q the inverse depth is n.q, so it is affine in
// t: its screen derivatives give the plane, and with it the exact range derivatives (docs/physics.md 2.3,
// equation 2), without differences of positions and without trouble where the plane is seen edge-on.
inline constexpr char surface_fragment_shader[] = R"glsl(#version 450 compatibility
in vec3 normal_eye;
in vec4 tangent_eye;
in vec2 texcoord;
layout(location = 0) out vec4 surface_sample;

uniform vec2 tan_half;        // of the view
uniform vec2 pixels;
uniform int shading;          // 0 geometric normal, 1 vertex normals, 2 normal map
uniform sampler2D normal_map;
uniform float reflectance;
uniform float lambert_mu;
uniform int model;            // 0 paper, 1 physical
uniform vec2 sigmoid;         // slope, centre
uniform float attenuation_per_m;

vec3 shading_normal(vec3 plane) {
  if (shading == 0) return plane;
  vec3 n = normalize(normal_eye);
  if (shading == 2) {
    vec3 t = normalize(tangent_eye.xyz - n * dot(n, tangent_eye.xyz));
    vec3 b = cross(n, t) * tangent_eye.w;
    vec3 m = texture(normal_map, texcoord).xyz * 2.0 - 1.0;
    n = normalize(t * m.x + b * m.y + n * m.z);
  }
  return any(isnan(n)) ? plane : n;
}

void main() {
  vec2 t = (gl_FragCoord.xy / pixels * 2.0 - 1.0) * tan_half;
  vec2 pixel = 2.0 * tan_half / pixels;
  float inverse_depth = gl_FragCoord.w;
  vec2 slope = vec2(dFdx(inverse_depth), dFdy(inverse_depth)) / pixel;
  vec3 q = vec3(t, -1.0);
  float qq = dot(q, q);
  float range = sqrt(qq) / inverse_depth;
  vec2 range_d = range * (t / qq - slope / inverse_depth);

  vec3 plane = normalize(vec3(slope, dot(slope, t) - inverse_depth));
  float cos_phi = clamp(abs(dot(shading_normal(plane), q)) * inversesqrt(qq), 0.0, 1.0);
  float response;
  if (model == 1) {
    response = lambert_mu * cos_phi;
  } else {
    float echo = min(1.0, reflectance * cos_phi * exp(-2.0 * attenuation_per_m * range));
    response = 1.0 / (1.0 + exp(-sigmoid.x * (echo - sigmoid.y)));
  }
  vec4 result = vec4(range, response, range_d);
  surface_sample = any(isnan(result)) || any(isinf(result)) ? vec4(-1.0, 0.0, 0.0, 0.0) : result;
}
)glsl";

}  // namespace sonard::render
