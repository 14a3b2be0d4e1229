// SPDX-License-Identifier: Apache-2.0
// One group for each cluster: culls it, or places its triangles in the sonar frame and counts them for the
// beams that they may touch. As FanTriangles::collect().
#include "gpu/ping.glsl"
layout(std430, binding = 0) readonly buffer Vertices { float vertices[]; };
layout(std430, binding = 1) readonly buffer Triangles { ClusterTriangle triangles[]; };
layout(std430, binding = 2) readonly buffer Clusters { Cluster clusters[]; };
layout(std430, binding = 3) buffer Parts { Part parts[]; };
layout(std430, binding = 4) writeonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 5) buffer Counts { PingCounts counts; };
layout(std430, binding = 6) buffer Beams { Beam beams[]; };
layout(std430, binding = 7) readonly buffer Hiding { float hiding[]; };  // Shell::outwards, or 0

const uint no_shell = 0xffffffffu;
const uint most_vertices = 128u, most_triangles = 96u;  // of a cluster
shared Corner s_corner[most_vertices];
shared Sight s_sight[most_vertices];
shared int s_to_port, s_to_starboard, s_steep, s_least, s_most;
shared uint s_kept, s_first;

// ---- the fan ----

// The apparent position of a point (Refraction::point()).
Corner refracted(Corner p) {
  if (ping.bend_per_m == 0.0) {
    return p;
  }
  vec3 at = vec3(p.x, p.y, p.z), up = vec3(ping.up_x, ping.up_y, ping.up_z);
  float height = dot(at, up), squared = dot(at, at);
  vec3 lifted = at + up * (ping.bend_per_m * (squared - height * height));
  lifted *= sqrt(squared / max(dot(lifted, lifted), 1e-30));
  return Corner(lifted.x, lifted.y, lifted.z);
}

bool is_out(Cluster cluster, Placement placement) {
  Corner centre = place(placement, cluster.x, cluster.y, cluster.z);
  float distance = length(vec3(centre.x, centre.y, centre.z));
  float spread = 4.0 * abs(ping.bend_per_m) * cluster.radius_m * (distance + cluster.radius_m);
  return misses_fan(ping.fan, refracted(centre), cluster.radius_m + spread);
}

// Number of the beams' edges from the `first` on, before the `end`, that lie to port of an azimuth, or at it.
int edges_to_port(int first, int end, float azimuth, bool or_at) {
  int begin = first;
  while (begin < end) {
    int middle = (begin + end) / 2;
    float edge = beams[middle].port_rad;
    if (edge > azimuth || (or_at && edge == azimuth)) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin - first;
}

// ---- clusters ----

// The last part whose clusters do not begin behind this one.
uint part_of(uint number) {
  uint begin = 0u, end = uint(ping.parts);
  while (begin + 1u < end) {
    uint middle = (begin + end) / 2u;
    if (parts[middle].first_group <= number) {
      begin = middle;
    } else {
      end = middle;
    }
  }
  return begin;
}

// Whole numbers in the order of floats.
int order_of(float x) {
  int bits = floatBitsToInt(x);
  return bits < 0 ? bits ^ 0x7fffffff : bits;
}
float of_order(int order) { return intBitsToFloat(order < 0 ? order ^ 0x7fffffff : order); }

// All invocations must call it. @return false: all vertices lie to one side of the fan
bool place_vertices(Cluster cluster, Placement placement) {
  if (lane == 0u) {
    s_to_port = s_to_starboard = s_steep = 0;
    s_least = 0x7fffffff;
    s_most = -0x7fffffff;
    s_kept = 0u;
  }
  barrier();
  for (uint i = lane; i < cluster.vertex_count; i += GROUP) {
    uint v = 3u * (cluster.first_vertex + i);
    Corner at = refracted(place(placement, vertices[v], vertices[v + 1u], vertices[v + 2u]));
    Sight sight = sight_of(at);
    s_corner[i] = at;
    s_sight[i] = sight;
    float port = ping.port_rad + azimuth_error_rad, starboard = ping.starboard_rad - azimuth_error_rad;
    atomicAdd(s_to_port, sight.azimuth > port && sight.azimuth < port + half_turn ? 1 : 0);
    atomicAdd(s_to_starboard, sight.azimuth < starboard && sight.azimuth > starboard - half_turn ? 1 : 0);
    atomicMin(s_least, order_of(sight.azimuth));
    atomicMax(s_most, order_of(sight.azimuth));
  }
  barrier();
  int all = int(cluster.vertex_count);
  return s_to_port != all && s_to_starboard != all;
}

// ---- triangles ----

const uint rounds = (most_triangles + GROUP - 1u) / GROUP;
FanTriangle kept[2u * rounds];
uint place_of[2u * rounds];
uint count = 0u;

// Keeps a triangle for the beams between two azimuths.
void keep(FanTriangle t, float low, float high) {
  int first = edges_to_port(1, ping.beams + 1, high + azimuth_error_rad, false);
  int last = edges_to_port(0, ping.beams, low - azimuth_error_rad, true) - 1;
  if (last < first) {
    return;
  }
  t.first_beam = uint(first);
  t.last_beam = uint(last);
  for (int beam = first; beam <= last; ++beam) {
    atomicAdd(beams[beam].count, 1u);
  }
  kept[count] = t;
  place_of[count++] = atomicAdd(s_kept, 1u);
}

void add(ClusterTriangle triangle, uint number, uint part, bool out_of_fan) {
  uint i = triangle.corners & 0xffu, j = triangle.corners >> 8u & 0xffu, k = triangle.corners >> 16u;
  Corner a = s_corner[i], b = s_corner[j], c = s_corner[k];
  FanLimits limits = FanLimits(ping.tan_limit, ping.upright_rad);
  TriangleBounds bounds = bounds_of_triangle(s_sight[i], s_sight[j], s_sight[k], a.z, b.z, c.z, limits);
  if (bounds.in_elevation == 0) {
    return;
  }
  float outwards = triangle.shell == no_shell ? 0.0 : hiding[parts[part].first_hiding + triangle.shell];
  if (bounds.thin == 0 && is_turned_away(a, b, c, outwards)) {
    atomicAdd(counts.hidden_faces, 1u);
    return;
  }
  bool whole_turn = bounds.high_azimuth - bounds.low_azimuth > half_turn;
  bool small = of_order(s_most) - of_order(s_least) < ping.widest_slice_rad;
  vec3 across = cross(vec3(b.x - a.x, b.y - a.y, b.z - a.z), vec3(c.x - a.x, c.y - a.y, c.z - a.z));
  FanTriangle t;
  t.corners = Corner[3](a, b, c);
  t.low_azimuth = whole_turn ? -half_turn : bounds.low_azimuth;
  t.high_azimuth = whole_turn ? half_turn : bounds.high_azimuth;
  t.flags = (part << part_shift) | (bounds.upright != 0 ? has_upright_edge : 0u) |
            (dot(across, vec3(a.x, a.y, a.z)) > 0.0 ? is_back_face : 0u);
  if (!out_of_fan) {
    t.flags |= (bounds.thin != 0 ? is_thin : 0u) | (small ? is_small : 0u) | is_of_low_cluster;
  }
  t.mesh_triangle = triangle.mesh_triangle;
  t.number = number;
  float azimuth[3] = float[3](s_sight[i].azimuth, s_sight[j].azimuth, s_sight[k].azimuth);
  if (!whole_turn || !(min(min(abs(azimuth[0]), abs(azimuth[1])), abs(azimuth[2])) >= 0.5 * half_turn)) {
    keep(t, t.low_azimuth, t.high_azimuth);
    return;
  }
  // It lies behind the sonar, across the azimuth of pi and -pi: two spans of azimuths.
  float port = half_turn, starboard = -half_turn;
  for (int v = 0; v < 3; ++v) {
    port = azimuth[v] > 0.0 ? min(port, azimuth[v]) : port;
    starboard = azimuth[v] > 0.0 ? starboard : max(starboard, azimuth[v]);
  }
  keep(t, port, half_turn);
  keep(t, -half_turn, starboard);
}

void main() {
  uint number = group_number();
  if (number >= uint(ping.clusters)) {
    return;
  }
  uint part = part_of(number);
  Cluster cluster = clusters[parts[part].first_cluster + number - parts[part].first_group];
  bool out_of_fan = is_out(cluster, parts[part].placement);
  bool is_culled = out_of_fan && ping.cull != 0;
  if (!is_culled) {
    is_culled = !place_vertices(cluster, parts[part].placement) && ping.cull != 0;
  }
  if (is_culled) {
    if (lane == 0u) {
      atomicAdd(counts.culled_clusters, 1u);
    }
    return;
  }
  float most_rise = 0.75 * probe_step(ping.tan_limit);
  for (uint i = lane; i < cluster.vertex_count; i += GROUP) {
    if (abs(s_sight[i].tangent - s_sight[0].tangent) > most_rise) {
      s_steep = 1;
    }
  }
  for (uint n = lane; n < cluster.triangle_count; n += GROUP) {
    add(triangles[cluster.first_triangle + n], number * most_triangles + n, part, out_of_fan);
  }
  barrier();
  if (lane == 0u) {
    s_first = atomicAdd(counts.needed.triangles, s_kept);
    if (!out_of_fan && s_steep != 0) {
      parts[part].is_tall = 1u;
    }
  }
  barrier();
  for (uint i = 0u; i < count; ++i) {
    uint at = s_first + place_of[i];
    if (at < ping.room.triangles) {
      fan[at] = kept[i];
    }
  }
}
