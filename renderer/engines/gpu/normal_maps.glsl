// SPDX-License-Identifier: Apache-2.0
// Incidence on the normals of a map, for patches.comp. As NormalPyramid and mapped_incidence().

vec3 texel(uint level_texels, ivec2 at, int width) {
  uint word = level_texels + 2u * uint(at.y * width + at.x);
  int xy = int(world[word]), z = int(world[word + 1u]);
  return vec3(float(bitfieldExtract(xy, 0, 16)), float(bitfieldExtract(xy, 16, 16)),
              float(bitfieldExtract(z, 0, 16)));
}

vec3 bilinear(uint level, vec2 uv) {
  uint at = surface.levels + 3u * level;
  ivec2 size = ivec2(int(world[at]), int(world[at + 1u]));
  vec2 position = uv * vec2(size) - 0.5, corner = floor(position), part = position - corner;
  ivec2 low = ivec2(corner);
  low += ivec2(lessThan(low, ivec2(0))) * size - ivec2(greaterThanEqual(low, size)) * size;
  ivec2 high = low + 1;
  high -= ivec2(greaterThanEqual(high, size)) * size;
  uint texels = world[at + 2u];
  return mix(mix(texel(texels, low, size.x), texel(texels, ivec2(high.x, low.y), size.x), part.x),
             mix(texel(texels, ivec2(low.x, high.y), size.x), texel(texels, high, size.x), part.x), part.y) *
         (1.0 / 32767.0);
}

// log2(x) of x >= 1, accurate to 1e-5.
float log2_of(float x) {
  int bits = floatBitsToInt(x);
  float y = intBitsToFloat((bits & 0x7fffff) | 0x3f800000);  // from 1 to 2
  float q = (y - 1.41421356) / (y + 1.41421356), q2 = q * q;
  return float((bits >> 23) - 127) + 0.5 +
         2.88539008 * q * (1.0 + q2 * (1.0 / 3.0 + q2 * (0.2 + q2 * (1.0 / 7.0))));
}

vec3 first_corner, edge_b, edge_c, across_plane;  // of the triangle; across_plane is its normal

vec2 weights_of(vec3 from_corner) {
  return vec2(dot(cross(from_corner, edge_c), across_plane), dot(cross(edge_b, from_corner), across_plane)) /
         dot(across_plane, across_plane);
}

vec2 uv_of(uint vertex) {
  return uintBitsToFloat(uvec2(world[vertex + 3u], world[vertex + 4u]));
}

// Interpolated between the vertices.
struct MapVertex {
  vec3 normal;
  vec2 uv;
  vec4 tangent;
};

MapVertex vertex_at(vec2 weights) {
  MapVertex sum = MapVertex(vec3(0.0), vec2(0.0), vec4(0.0));
  for (uint k = 0u; k < 3u; ++k) {
    float weight = k == 0u ? 1.0 - weights.x - weights.y : k == 1u ? weights.x : weights.y;
    uint at = vertex_of(k);
    vec3 tangent = uintBitsToFloat(uvec3(world[at + 5u], world[at + 6u], world[at + 7u]));
    sum.normal += weight * vertex_normal(k);
    sum.uv += weight * uv_of(at);
    sum.tangent += weight * vec4(in_sonar_frame(tangent), uintBitsToFloat(world[at + 8u]));
  }
  return sum;
}

// Mean of the map's normals over the footprint of the piece around p; see footprint_on_map().
vec3 mean_normal(vec3 p, vec2 uv) {
  const float most_taps = 8.0;
  float range = length(p);
  vec3 d = p / range, n = normalize(across_plane), along = d - n * dot(n, d);
  float steepness = length(along);
  along = steepness > 1e-3 ? along / steepness : normalize(edge_b);
  vec2 at_corner[3] = vec2[3](uv_of(vertex_of(0u)), uv_of(vertex_of(1u)), uv_of(vertex_of(2u)));
  vec2 b = at_corner[1] - at_corner[0], c = at_corner[2] - at_corner[0];
  float extent_m = abs(ranges.range_high - ranges.range_low);
  vec2 w_along = weights_of(along * (extent_m / max(steepness, 1e-2)));
  vec2 w_across = weights_of(cross(n, along) * (range * slice.width_rad));
  vec2 u = b * w_along.x + c * w_along.y, v = b * w_across.x + c * w_across.y;
  vec2 size = vec2(float(world[surface.levels]), float(world[surface.levels + 1u]));
  float u_texels = length(u * size), v_texels = length(v * size);
  float shorter = max(1.0, min(u_texels, v_texels)), longer = max(u_texels, v_texels);
  float taps = clamp(ceil(longer / shorter), 1.0, most_taps);
  float level = clamp(log2_of(max(shorter, longer / most_taps)), 0.0, float(surface.level_count - 1u));
  vec2 step_of_taps = u_texels > v_texels ? u : v;
  vec3 sum = vec3(0.0);
  float between = level - floor(level);
  for (float k = 0.0; k < 2.0 * taps; k += 1.0) {  // each tap in two levels
    float tap = floor(0.5 * k);
    bool is_coarse = k > 2.0 * tap;
    vec2 at = uv + step_of_taps * ((tap + 0.5) / taps - 0.5);
    uint of_level = min(uint(level) + (is_coarse ? 1u : 0u), surface.level_count - 1u);
    sum += (is_coarse ? between : 1.0 - between) * bilinear(of_level, at - floor(at));
  }
  return sum / taps;
}

// Incidence in the middle of the piece: the cosine, and the mean length of the normals.
// @param geometric cosine of the plane; returned if there is no direction
vec2 mapped_incidence(float geometric) {
  float t = t_at(1), h = 1.0 / (seen.w_at_0 + seen.w_slope * t);
  vec3 p = vec3(h * slice.cosine, h * slice.sine, t * h);
  first_corner = corner_of(0u);
  edge_b = corner_of(1u) - first_corner;
  edge_c = corner_of(2u) - first_corner;
  across_plane = cross(edge_b, edge_c);
  MapVertex vertex = vertex_at(weights_of(p - first_corner));
  vec3 up = vec3(ping.up_x, ping.up_y, ping.up_z);
  vec3 bent = vertex.normal - (p - up * dot(p, up)) * (2.0 * ping.bend_per_m * dot(vertex.normal, up));
  vec3 m = mean_normal(p, vertex.uv);
  vec3 n = normalize(bent), along = vertex.tangent.xyz;
  vec3 tangent = normalize(along - n * dot(n, along));
  vec3 mapped = tangent * m.x + cross(n, tangent) * vertex.tangent.w * m.y + n * m.z;
  float product = abs(dot(mapped, normalize(p)));
  return product < never ? vec2(min(1.0, product), length(mapped)) : vec2(geometric, 1.0);
}
