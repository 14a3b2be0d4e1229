// SPDX-License-Identifier: Apache-2.0
// A vertex of a MeshChunk. surface_shader_head() precedes it.
//
// The plane of a triangle is an attribute of its last corner, with which no other triangle ends. Positions that the GPU
// interpolates between corners are less accurate: they are off by per cents if a triangle of a hundred metres passes a
// metre from the eye and is clipped there (docs/accuracy.md). The distance of the plane from the eye is computed from
// the chunk's centre, because corners may be far away.

layout(location = 0) in vec4 position;  // VertexAttribute
layout(location = 1) in vec3 normal;
#if SHADING == 2
layout(location = 2) in vec2 mapped_at;
layout(location = 3) in vec4 tangent;  // xyz unit, w handedness
#endif
layout(location = 4) in vec4 facet;
layout(location = 0) uniform vec3 eye;  // from the centre of the chunk, in coordinates of the part; see MeshChunk
#if BENT
uniform vec4 refraction;  // Refraction in eye coordinates: up, per_m

// Refraction::normal() at `p`.
vec3 bent_normal(vec3 n, vec3 p) {
  vec3 level = p - refraction.xyz * dot(p, refraction.xyz);
  return n - level * (2.0 * refraction.w * dot(n, refraction.xyz));
}

// Refraction::point().
vec3 bent_point(vec3 p) {
  float height = dot(p, refraction.xyz);
  float squared = dot(p, p);
  vec3 lifted = p + refraction.xyz * (refraction.w * (squared - height * height));
  return lifted * sqrt(squared / max(dot(lifted, lifted), 1e-30));
}
#endif
flat out vec4 plane;  // n / d, where n.p = d, and the distance
#if SHADING != 0
out vec3 normal_eye;
#endif
#if SHADING == 2
out vec4 tangent_eye;
out vec2 texcoord;
#endif

void main() {
  vec3 p = (gl_ModelViewMatrix * position).xyz;
  vec3 n = mat3(gl_ModelViewMatrix) * facet.xyz;
  float d = facet.w - dot(facet.xyz, eye);
#if SHADING != 0
  normal_eye = gl_NormalMatrix * normal;
#endif
#if BENT
  n = bent_normal(n, p);
#if SHADING != 0
  normal_eye = bent_normal(normal_eye, p);
#endif
  p = bent_point(p);
  d = dot(n, p);
#endif
  gl_Position = gl_ProjectionMatrix * vec4(p, 1.0);
  plane = d == 0.0 ? vec4(0.0) : vec4(n / d, abs(d) * inversesqrt(dot(n, n)));
#if SHADING == 2
  tangent_eye = vec4(gl_NormalMatrix * tangent.xyz, tangent.w);
  texcoord = mapped_at;
#endif
}
