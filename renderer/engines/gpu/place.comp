// SPDX-License-Identifier: Apache-2.0
// One group for each cluster: culls it, or places its triangles in the sonar frame and counts them for the
// beams that they may touch. As FanTriangles::collect().
layout(local_size_x = GROUP) in;

struct Triangle {
  uint corners;  // three vertices of the cluster, a byte each
  uint mesh_triangle;
  uint shell;  // index into `hiding` of the part; no_shell: both sides may be seen
};
const uint no_shell = 0xffffffffu;
struct Cluster {
  float x, y, z, radius_m;  // bounding sphere, in the frame of the part
  uint first_vertex, vertex_count, first_triangle, triangle_count;
};
layout(std430, binding = 0) readonly buffer Vertices { float vertices[]; };
layout(std430, binding = 1) readonly buffer Triangles { Triangle triangles[]; };
layout(std430, binding = 2) readonly buffer Clusters { Cluster clusters[]; };
layout(std430, binding = 3) buffer Parts { Part parts[]; };
layout(std430, binding = 4) writeonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 5) buffer Counts { PingCounts counts; };
layout(std430, binding = 6) buffer Beams { BeamList beams[]; };
layout(std430, binding = 7) readonly buffer Hiding { float hiding[]; };  // Shell::outwards, or 0

const int most_vertices = 128;
shared float s_x[most_vertices], s_y[most_vertices], s_z[most_vertices];
shared float s_azimuth[most_vertices], s_squared[most_vertices], s_tangent[most_vertices];
shared int s_to_port, s_to_starboard, s_steep, s_least, s_most;
shared uint s_kept, s_first;

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

// As Fan::misses().
bool misses_fan(vec3 centre, float radius_m) {
  const float slack = 1e-3;
  float horizontal = length(centre.xy), distance = length(centre), reach = radius_m + slack * distance;
  if (distance - radius_m > ping.max_range_m ||
      abs(centre.z) * ping.cos_limit - horizontal * ping.sin_limit > reach) {
    return true;
  }
  float port = centre.x * ping.port_x + centre.y * ping.port_y;
  float starboard = centre.x * ping.starboard_x + centre.y * ping.starboard_y;
  return (ping.is_convex != 0 ? max(port, starboard) : min(port, starboard)) > reach;
}

bool is_out(Cluster cluster, Placement placement) {
  Corner centre = place(placement, cluster.x, cluster.y, cluster.z);
  vec3 at = vec3(centre.x, centre.y, centre.z);
  float spread = 4.0 * abs(ping.bend_per_m) * cluster.radius_m * (length(at) + cluster.radius_m);
  Corner apparent = refracted(centre);
  return misses_fan(vec3(apparent.x, apparent.y, apparent.z), cluster.radius_m + spread);
}

// Whole numbers in the order of floats.
int order_of(float x) {
  int bits = floatBitsToInt(x);
  return bits < 0 ? bits ^ 0x7fffffff : bits;
}
float of_order(int order) { return intBitsToFloat(order < 0 ? order ^ 0x7fffffff : order); }

void place_vertices(Cluster cluster, Placement placement) {
  for (uint i = gl_LocalInvocationID.x; i < cluster.vertex_count; i += GROUP) {
    uint v = 3u * (cluster.first_vertex + i);
    Corner at = refracted(place(placement, vertices[v], vertices[v + 1u], vertices[v + 2u]));
    Sight sight = sight_of(at);
    s_x[i] = at.x;
    s_y[i] = at.y;
    s_z[i] = at.z;
    s_azimuth[i] = sight.azimuth;
    s_squared[i] = sight.horizontal_squared;
    s_tangent[i] = sight.tangent;
    float port = ping.port_rad + azimuth_error_rad, starboard = ping.starboard_rad - azimuth_error_rad;
    atomicAdd(s_to_port, sight.azimuth > port && sight.azimuth < port + half_turn ? 1 : 0);
    atomicAdd(s_to_starboard, sight.azimuth < starboard && sight.azimuth > starboard - half_turn ? 1 : 0);
    atomicMin(s_least, order_of(sight.azimuth));
    atomicMax(s_most, order_of(sight.azimuth));
  }
}

// The first beam that touches azimuths below `high`, and the last one that touches azimuths above `low`.
uint first_beam(float high) {
  int low_beam = 0, end = ping.beams;
  while (low_beam < end) {
    int middle = (low_beam + end) / 2;
    if (beams[middle + 1].port_rad <= high) {
      end = middle;
    } else {
      low_beam = middle + 1;
    }
  }
  return uint(low_beam);
}
int last_beam(float low) {
  int begin = 0, end = ping.beams;  // the number of beams whose port side is not below `low`
  while (begin < end) {
    int middle = (begin + end) / 2;
    if (beams[middle].port_rad >= low) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin - 1;
}

Corner corner(uint i) { return Corner(s_x[i], s_y[i], s_z[i]); }
Sight sight(uint i) { return Sight(s_azimuth[i], s_squared[i], s_tangent[i]); }

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

void main() {
  uint number = group_number();
  if (number >= uint(ping.clusters)) {
    return;
  }
  uint lane = gl_LocalInvocationID.x, part = part_of(number);
  Cluster cluster = clusters[parts[part].first_cluster + number - parts[part].first_group];
  Placement placement = parts[part].placement;
  bool out_of_fan = is_out(cluster, placement);
  if (out_of_fan && ping.cull != 0) {
    if (lane == 0u) {
      atomicAdd(counts.culled_clusters, 1u);
    }
    return;
  }
  if (lane == 0u) {
    s_to_port = s_to_starboard = s_steep = 0;
    s_least = 0x7fffffff;
    s_most = -0x7fffffff;
    s_kept = 0u;
  }
  barrier();
  place_vertices(cluster, placement);
  barrier();
  int all_vertices = int(cluster.vertex_count);
  if ((s_to_port == all_vertices || s_to_starboard == all_vertices) && ping.cull != 0) {
    if (lane == 0u) {
      atomicAdd(counts.culled_clusters, 1u);
    }
    return;
  }
  float most_rise = 0.75 * probe_step(ping.tan_limit);
  for (uint i = lane; i < cluster.vertex_count; i += GROUP) {
    if (abs(s_tangent[i] - s_tangent[0]) > most_rise) {
      s_steep = 1;
    }
  }
  bool small = of_order(s_most) - of_order(s_least) < ping.widest_slice_rad;
  FanLimits limits = FanLimits(ping.tan_limit, ping.upright_rad);
  const uint rounds = (96u + GROUP - 1u) / GROUP;
  FanTriangle kept[2u * rounds];
  uint place_of[2u * rounds];
  uint count = 0u;
  for (uint n = lane; n < cluster.triangle_count; n += GROUP) {
    Triangle triangle = triangles[cluster.first_triangle + n];
    uint i = triangle.corners & 0xffu, j = triangle.corners >> 8u & 0xffu, k = triangle.corners >> 16u;
    Corner a = corner(i), b = corner(j), c = corner(k);
    TriangleBounds bounds = bounds_of_triangle(sight(i), sight(j), sight(k), a.z, b.z, c.z, limits);
    if (bounds.in_elevation == 0) {
      continue;
    }
    float outwards =
        triangle.shell == no_shell ? 0.0 : hiding[parts[part].first_hiding + triangle.shell];
    if (bounds.thin == 0 && is_turned_away(a, b, c, outwards)) {
      atomicAdd(counts.hidden_faces, 1u);
      continue;
    }
    bool whole_turn = bounds.high_azimuth - bounds.low_azimuth > half_turn;
    vec3 across = cross(vec3(b.x - a.x, b.y - a.y, b.z - a.z), vec3(c.x - a.x, c.y - a.y, c.z - a.z));
    FanTriangle t;
    t.x0 = a.x; t.y0 = a.y; t.z0 = a.z;
    t.x1 = b.x; t.y1 = b.y; t.z1 = b.z;
    t.x2 = c.x; t.y2 = c.y; t.z2 = c.z;
    t.low_azimuth = whole_turn ? -half_turn : bounds.low_azimuth;
    t.high_azimuth = whole_turn ? half_turn : bounds.high_azimuth;
    t.flags = (part << part_shift) | (bounds.upright != 0 ? has_upright_edge : 0u) |
              (dot(across, vec3(a.x, a.y, a.z)) > 0.0 ? is_back_face : 0u);
    if (!out_of_fan) {
      t.flags |= (bounds.thin != 0 ? is_thin : 0u) | (small ? is_small : 0u) | is_of_low_cluster;
    }
    t.mesh_triangle = triangle.mesh_triangle;
    t.number = number * 96u + n;
    // Behind the sonar, a triangle may lie across the azimuth of pi and -pi: two spans of azimuths.
    float nearest = min(min(abs(s_azimuth[i]), abs(s_azimuth[j])), abs(s_azimuth[k]));
    bool behind = whole_turn && nearest >= 0.5 * half_turn;
    float port = half_turn, starboard = -half_turn;
    for (int v = 0; v < 3; ++v) {
      float azimuth = s_azimuth[v == 0 ? i : v == 1 ? j : k];
      port = azimuth > 0.0 ? min(port, azimuth) : port;
      starboard = azimuth > 0.0 ? starboard : max(starboard, azimuth);
    }
    for (int span = 0; span < (behind ? 2 : 1); ++span) {
      float low = behind ? (span == 0 ? port : -half_turn) : t.low_azimuth;
      float high = behind ? (span == 0 ? half_turn : starboard) : t.high_azimuth;
      uint first = first_beam(high + azimuth_error_rad);
      int last = last_beam(low - azimuth_error_rad);
      if (last < int(first)) {
        continue;
      }
      t.first_beam = first;
      t.last_beam = uint(last);
      for (uint beam = first; beam <= t.last_beam; ++beam) {
        atomicAdd(beams[beam].count, 1u);
      }
      kept[count] = t;
      place_of[count++] = atomicAdd(s_kept, 1u);
    }
  }
  barrier();
  if (lane == 0u) {
    s_first = atomicAdd(counts.triangles, s_kept);
    if (!out_of_fan && s_steep != 0) {
      parts[part].is_tall = 1u;
    }
  }
  barrier();
  for (uint i = 0u; i < count; ++i) {
    uint at = s_first + place_of[i];
    if (at < uint(ping.most_triangles)) {
      fan[at] = kept[i];
    }
  }
}
