// SPDX-License-Identifier: Apache-2.0
// One group for each beam: the thin, small and low things that slices must not miss, and the upright edges at
// which slices are divided. As SliceCutter::list_thin() and SliceCutter::list_upright_edges().
layout(local_size_x = GROUP) in;

layout(std430, binding = 0) readonly buffer Parts { Part parts[]; };
layout(std430, binding = 1) coherent buffer Things { Thing things[]; };
layout(std430, binding = 2) writeonly buffer Edges { Edge edges[]; };
layout(std430, binding = 3) readonly buffer Lists { uint lists[]; };
layout(std430, binding = 4) readonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 5) buffer Counts { PingCounts counts; };
layout(std430, binding = 6) buffer Beams { BeamList beams[]; };
layout(std430, binding = 7) writeonly buffer Ends { ThingEnd ends[]; };

const float same_edge_rad = 2e-6;  // nearer edges count as one
const uint least_probes = 12u;     // for lower edges even parts are as good

uint lane, beam;
BeamList of_beam;

float tangent_of(FanTriangle t, int k) {
  float x = k == 0 ? t.x0 : k == 1 ? t.x1 : t.x2, y = k == 0 ? t.y0 : k == 1 ? t.y1 : t.y2;
  return (k == 0 ? t.z0 : k == 1 ? t.z1 : t.z2) / sqrt(x * x + y * y + 1e-30);
}

bool is_in_beam(FanTriangle t) {
  return t.high_azimuth >= of_beam.middle_rad - 0.5 * of_beam.width_rad - azimuth_error_rad &&
         t.low_azimuth <= of_beam.middle_rad + 0.5 * of_beam.width_rad + azimuth_error_rad;
}

// ---- things ----

shared uint s_count, s_first;

Thing thing_of(FanTriangle t, uint kind) {
  float a = tangent_of(t, 0), b = tangent_of(t, 1), c = tangent_of(t, 2);
  return Thing(t.low_azimuth, t.high_azimuth, least_of(a, b, c), most_of(a, b, c),
               kind | (t.flags >> part_shift) << kind_bits);
}

bool is_of_kind(FanTriangle t, uint kind) {
  if (!is_in_beam(t) || (ping.two_sided == 0 && (t.flags & is_back_face) != 0u)) {
    return false;
  }
  return kind == thin_kind    ? (t.flags & is_thin) != 0u
         : kind == small_kind ? (t.flags & (is_thin | is_small)) == is_small
                              : (t.flags & is_of_low_cluster) != 0u && parts[t.flags >> part_shift].is_tall == 0u;
}

// Counts the things of the beam, then writes them, in any order.
void list_things() {
  bool has_room = false;
  for (int writing = 0; writing < 2; ++writing) {
    if (lane == 0u) {
      s_count = 0u;
    }
    barrier();
    for (uint i = of_beam.begin + lane; i < of_beam.begin + of_beam.count; i += GROUP) {
      FanTriangle t = fan[lists[i]];
      for (uint kind = thin_kind; kind <= low_kind; ++kind) {
        if (is_of_kind(t, kind)) {
          uint at = atomicAdd(s_count, 1u);
          if (has_room) {
            things[s_first + at] = thing_of(t, kind);
          }
        }
      }
    }
    barrier();
    uint found = s_count;
    if (lane == 0u && writing == 0) {
      s_first = atomicAdd(counts.things, found);
    }
    barrier();
    has_room = s_first + found <= uint(ping.most_things);
    of_beam.things = has_room ? found : 0u;
  }
  of_beam.first_thing = has_room ? s_first : 0u;
  memoryBarrierBuffer();
  barrier();
}

// True if thing i ends neither there nor before, because another one of its key goes on.
bool is_joined(uint i, bool at_high) {
  Thing thing = things[of_beam.first_thing + i];
  float at = at_high ? thing.high_azimuth : thing.low_azimuth;
  for (uint k = 1u; k < of_beam.things; ++k) {
    uint j = i + k < of_beam.things ? i + k : i + k - of_beam.things;  // neighbours of surfaces come first
    Thing other = things[of_beam.first_thing + j];
    bool goes_on = at_high ? other.high_azimuth > at || (other.high_azimuth == at && j < i)
                           : other.low_azimuth < at || (other.low_azimuth == at && j < i);
    if (other.key == thing.key && goes_on && other.low_azimuth <= at && other.high_azimuth >= at) {
      return true;
    }
  }
  return false;
}

void list_ends() {
  if (lane == 0u) {
    s_count = 0u;
  }
  barrier();
  for (uint n = lane; n < 2u * of_beam.things; n += GROUP) {
    uint i = n / 2u;
    bool at_high = n % 2u == 1u;
    if (!is_joined(i, at_high)) {
      Thing thing = things[of_beam.first_thing + i];
      ends[2u * of_beam.first_thing + atomicAdd(s_count, 1u)] =
          ThingEnd(at_high ? thing.high_azimuth : thing.low_azimuth, thing.key, at_high ? 1u : 0u);
    }
  }
  barrier();
  of_beam.ends = s_count;
  barrier();
}

// ---- edges ----

// Upright edges of single triangles.
const uint room = 2048u;
shared float s_offset[room];
shared uint s_edge[room];   // edge_word()
shared uint s_order[room];  // by rising azimuth
shared uint s_bits[side_probes / 32];

// First and last probe, whether the triangle lies to port, and the azimuth of its normal in parts of a turn: whole
// numbers, whose sums do not depend on their order.
const int parts_of_half_turn = 4095;
uint edge_word(int first, int last, bool to_port, float facing) {
  return uint(first) | uint(last) << 9 | (to_port ? 1u << 18 : 0u) |
         uint(clamp(facing / half_turn + 1.0, 0.0, 2.0) * float(parts_of_half_turn)) << 19;
}
uint first_of(uint edge) { return edge & 0x1ffu; }
uint last_of(uint edge) { return edge >> 9 & 0x1ffu; }
int side_of(uint edge) { return (edge >> 18 & 1u) != 0u ? 1 : -1; }
int facing_of(uint edge) { return int(edge >> 19); }
const int sharp_turn = int(0.6 / half_turn * float(parts_of_half_turn));

// atan(x) for x from -1 to 1, accurate to 1e-7.
float atan_of(float x) {
  float size = abs(x);
  float y = size > 0.41421356 ? (size - 1.0) / (size + 1.0) : size;
  float y2 = y * y;
  float series =
      y * (1.0 - y2 * (1.0 / 3.0 - y2 * (0.2 - y2 * (1.0 / 7.0 - y2 * (1.0 / 9.0 - y2 * (1.0 / 11.0 - y2 * (1.0 / 13.0 - y2 * (1.0 / 15.0))))))));
  return with_sign_of(size > 0.41421356 ? 0.25 * half_turn + series : series, x);
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
    float x = k == 0 ? t.x0 : k == 1 ? t.x1 : t.x2, y = k == 0 ? t.y0 : k == 1 ? t.y1 : t.y2;
    precise vec3 turned = vec3(x * of_beam.cosine + y * of_beam.sine, y * of_beam.cosine - x * of_beam.sine,
                               k == 0 ? t.z0 : k == 1 ? t.z1 : t.z2);
    corners[k] = turned;
    tangents[k] = tangent_of(t, k);
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
    if (last - first < 2 || !(abs(at) < 0.5 * of_beam.width_rad)) {
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
  for (uint i = of_beam.begin + lane; i < of_beam.begin + of_beam.count; i += GROUP) {
    FanTriangle t = fan[lists[i]];
    if ((t.flags & has_upright_edge) != 0u && is_in_beam(t)) {
      add_edges(t);
    }
  }
  barrier();
}

void sort_edges(uint count) {
  for (uint i = lane; i < count; i += GROUP) {
    uint rank = 0u;
    for (uint j = 0u; j < count; ++j) {
      rank += s_offset[j] < s_offset[i] || (s_offset[j] == s_offset[i] && j < i) ? 1u : 0u;
    }
    s_order[rank] = i;
  }
  barrier();
}

// Edges at one azimuth, from `begin` in s_order.
struct EdgeGroup {
  uint begin, end;
  uint probes;
};
EdgeGroup group_from(uint begin, uint count) {
  EdgeGroup group = EdgeGroup(begin, begin, 0u);  // at least one edge, so that the list ends
  float until = s_offset[s_order[begin]] + same_edge_rad;
  while (group.end < count) {
    uint i = s_order[min(group.end, count - 1u)];  // drivers may read it before they compare
    if (group.end > begin && !(s_offset[i] < until)) {
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
    uint edge = s_edge[s_order[i]];
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
  edge.offset_rad = s_offset[s_order[group.begin]];
  edge.count = 0u;
  for (uint word = 0u; word < uint(side_probes / 32); ++word) {
    edge.probes[word] = s_bits[word];
    edge.count += uint(bitCount(s_bits[word]));
  }
  bool is_high = edge.count >= least_probes;
  if (is_high && lane == 0u && to < uint(ping.most_edges)) {
    edges[to] = edge;
  }
  barrier();
  return is_high ? 1u : 0u;
}

// Lists the edges that are high enough. First it counts those that may be.
void list_edges() {
  gather_edges();
  uint count = min(s_count, room);
  if (lane == 0u && s_count > room) {
    atomicAdd(counts.overflows, 1u);
  }
  barrier();
  sort_edges(count);
  uint kept = 0u;
  for (int writing = 0; writing < 2; ++writing) {
    uint may_be = 0u;
    for (uint begin = 0u; begin < count;) {
      EdgeGroup group = group_from(begin, count);
      if (group.probes >= least_probes) {
        kept += writing == 1 ? write_edge(group, s_first + kept) : 0u;
        ++may_be;
      }
      begin = group.end;
    }
    barrier();
    if (lane == 0u && writing == 0) {
      s_first = atomicAdd(counts.edges, may_be);
    }
    barrier();
  }
  of_beam.first_edge = s_first;
  of_beam.edges = s_first + kept <= uint(ping.most_edges) ? kept : 0u;
}

void main() {
  lane = gl_LocalInvocationID.x;
  beam = group_number();
  if (!lists_have_room(counts)) {
    return;
  }
  of_beam = beams[beam];
  list_things();
  list_ends();
  list_edges();
  barrier();
  if (lane == 0u) {
    beams[beam] = of_beam;
  }
}
