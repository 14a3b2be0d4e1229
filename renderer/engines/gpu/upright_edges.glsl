// SPDX-License-Identifier: Apache-2.0
// The upright edges of a beam, for things.comp: those of its triangles, joined where they are at one azimuth.

const float same_edge_rad = 2e-6;  // nearer edges count as one
const uint least_probes = 12u;     // for lower edges even parts are as good

// Upright edges of single triangles.
const uint room = 2048u;
shared float s_offset[room];
shared uint s_edge[room];  // edge_word()
shared uint s_bits[side_probes / 32];

// First and last probe, whether the triangle lies to port, and the azimuth of its normal in parts of a turn:
// whole numbers, whose sums do not depend on their order.
const int parts_of_half_turn = 4095;
uint edge_word(int first, int last, bool to_port, float facing) {
  return uint(first) | uint(last) << 9 | (to_port ? 1u << 18 : 0u) |
         uint(clamp(facing / half_turn + 1.0, 0.0, 2.0) * float(parts_of_half_turn)) << 19;
}
uint first_of(uint edge) {
  return edge & 0x1ffu;
}
uint last_of(uint edge) {
  return edge >> 9 & 0x1ffu;
}
int side_of(uint edge) {
  return (edge >> 18 & 1u) != 0u ? 1 : -1;
}
int facing_of(uint edge) {
  return int(edge >> 19);
}
const int sharp_turn = int(0.6 / half_turn * float(parts_of_half_turn));

// atan(x) for x from -1 to 1, accurate to 1e-7.
float atan_of(float x) {
  float size = abs(x);
  float y = size > 0.41421356 ? (size - 1.0) / (size + 1.0) : size;
  float series = 1.0 / 15.0;
  for (int k = 13; k > 0; k -= 2) {
    series = 1.0 / float(k) - y * y * series;
  }
  return with_sign_of(size > 0.41421356 ? 0.25 * half_turn + y * series : y * series, x);
}

// Azimuth of a triangle's normal, turned away from the sonar.
float azimuth_of_normal(vec3 a, vec3 b, vec3 c) {
  vec3 n = cross(b - a, c - a);
  n = dot(n, a) < 0.0 ? -n : n;
  return fast_azimuth(n.y, n.x);
}

float turn(vec3 from, vec3 to) {
  return (from.x * to.y - from.y * to.x) / (from.x * to.x + from.y * to.y);
}

void add_edges(FanTriangle t) {
  vec3 corners[3];
  float tangents[3];
  for (int k = 0; k < 3; ++k) {
    Corner c = t.corners[k];
    precise vec3 turned = vec3(c.x * beam.cosine + c.y * beam.sine, c.y * beam.cosine - c.x * beam.sine, c.z);
    corners[k] = turned;
    tangents[k] = tangent_of(c);
  }
  float facing = azimuth_of_normal(corners[0], corners[1], corners[2]);
  for (int k = 0; k < 3; ++k) {
    int next = (k + 1) % 3, opposite = (k + 2) % 3;
    float lean = turn(corners[k], corners[next]);
    if (!(abs(lean) < ping.upright_rad) || !(abs(corners[k].y) < corners[k].x)) {
      continue;
    }
    int first = probe_above(min(tangents[k], tangents[next]), ping.tan_limit);
    int last = probe_above(max(tangents[k], tangents[next]), ping.tan_limit);
    float at = atan_of(corners[k].y / corners[k].x) + 0.5 * lean;
    if (last - first < 2 || !(abs(at) < 0.5 * beam.width_rad)) {
      continue;
    }
    // The point of the edge, or of its continuation, at the height of the third corner.
    float beside = lean * (tangents[opposite] - tangents[k]) / (tangents[next] - tangents[k]);
    uint place = atomicAdd(s_count, 1u);
    if (place < room) {
      s_offset[place] = at;
      s_edge[place] = edge_word(first, last, turn(corners[k], corners[opposite]) > beside, facing);
    }
  }
}

void gather_edges() {
  if (lane == 0u) {
    s_count = 0u;
  }
  barrier();
  for (uint i = beam.begin + lane; i < beam.begin + beam.count; i += GROUP) {
    FanTriangle t = fan[lists[i]];
    if ((t.flags & has_upright_edge) != 0u && is_in_beam(t)) {
      add_edges(t);
    }
  }
  barrier();
}

void swap_edges(uint i, uint k) {
  float offset = s_offset[i];
  uint edge = s_edge[i];
  s_offset[i] = s_offset[k];
  s_edge[i] = s_edge[k];
  s_offset[k] = offset;
  s_edge[k] = edge;
}

// Sorts the edges by rising azimuth (bitonic sort). All invocations must call it.
void sort_edges(uint count) {
  uint size = 1u;
  while (size < count) {
    size *= 2u;
  }
  for (uint i = count + lane; i < size; i += GROUP) {
    s_offset[i] = never;
  }
  barrier();
  for (uint run = 2u; run <= size; run *= 2u) {
    for (uint step = run / 2u; step > 0u; step /= 2u) {
      for (uint pair = lane; pair < size / 2u; pair += GROUP) {
        uint i = 2u * pair - pair % step;
        if ((i & run) == 0u ? s_offset[i] > s_offset[i + step] : s_offset[i] < s_offset[i + step]) {
          swap_edges(i, i + step);
        }
      }
      barrier();
    }
  }
}

// Edges at one azimuth.
struct EdgeGroup {
  uint begin, end;
  uint probes;
};
EdgeGroup group_from(uint begin, uint count) {
  EdgeGroup group = EdgeGroup(begin, begin, 0u);
  float until = 0.0;
  while (group.end < count) {
    uint i = group.end;
    until = i == begin ? s_offset[i] + same_edge_rad : until;
    if (i > begin && !(s_offset[i] < until)) {
      break;
    }
    group.probes += last_of(s_edge[i]) - first_of(s_edge[i]);
    ++group.end;
  }
  return group;
}

// Whether the surface ends or turns sharply at a probe: if it continues evenly on the other side, sides and
// normals of its triangles cancel.
bool ends_at(uint probe, EdgeGroup group) {
  int side = 0, turned = 0;
  for (uint i = group.begin; i < group.end; ++i) {
    uint edge = s_edge[i];
    bool touches = probe >= first_of(edge) && probe < last_of(edge);
    side += touches ? side_of(edge) : 0;
    turned += touches ? side_of(edge) * facing_of(edge) : 0;
  }
  // Modulo a turn: of two normals that point backwards, one may have azimuth pi and the other -pi.
  int one_way = abs(turned) % (2 * parts_of_half_turn);
  return side != 0 || min(one_way, 2 * parts_of_half_turn - one_way) > sharp_turn;
}

// Writes an edge with the probes of a group. All invocations must call it. @return 1, or 0 if it is not high
uint write_edge(EdgeGroup group, uint to) {
  for (uint word = lane; word < uint(side_probes / 32); word += GROUP) {
    s_bits[word] = 0u;
  }
  barrier();
  for (uint probe = lane; probe < uint(side_probes); probe += GROUP) {
    if (ends_at(probe, group)) {
      atomicOr(s_bits[probe / 32u], 1u << probe % 32u);
    }
  }
  barrier();
  Edge edge;
  edge.offset_rad = s_offset[group.begin];
  edge.count = 0u;
  for (uint word = 0u; word < uint(side_probes / 32); ++word) {
    edge.probes[word] = s_bits[word];
    edge.count += uint(bitCount(s_bits[word]));
  }
  bool is_high = edge.count >= least_probes;
  if (is_high && lane == 0u && to < ping.room.edges) {
    edges[to] = edge;
  }
  barrier();
  return is_high ? 1u : 0u;
}

// Lists the edges that are high enough.
void list_edges() {
  gather_edges();
  uint count = min(s_count, room);
  if (lane == 0u) {
    atomicAdd(counts.overflows, s_count > room ? 1u : 0u);
    s_first = atomicAdd(counts.needed.edges, count);
  }
  sort_edges(count);
  uint kept = 0u;
  for (EdgeGroup group = group_from(0u, count); group.begin < count; group = group_from(group.end, count)) {
    kept += group.probes >= least_probes ? write_edge(group, s_first + kept) : 0u;
  }
  beam.first_edge = s_first;
  beam.edges = s_first + kept <= ping.room.edges ? kept : 0u;
}
