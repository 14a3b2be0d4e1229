// SPDX-License-Identifier: Apache-2.0
// One group for each beam: the thin, small and low things that slices must not miss, and the upright edges at
// which slices are divided. As SliceCutter::list_thin() and SliceCutter::list_upright_edges().
#include "gpu/ping.glsl"
layout(std430, binding = 0) readonly buffer Parts { Part parts[]; };
layout(std430, binding = 1) coherent buffer Things { Thing things[]; };
layout(std430, binding = 2) writeonly buffer Edges { Edge edges[]; };
layout(std430, binding = 3) readonly buffer Lists { uint lists[]; };
layout(std430, binding = 4) readonly buffer Fan { FanTriangle fan[]; };
layout(std430, binding = 5) buffer Counts { PingCounts counts; };
layout(std430, binding = 6) buffer Beams { Beam beams[]; };
layout(std430, binding = 7) writeonly buffer Ends { ThingEnd ends[]; };

Beam beam;
shared uint s_count, s_first;

float tangent_of(Corner c) { return c.z / sqrt(c.x * c.x + c.y * c.y + 1e-30); }

bool is_in_beam(FanTriangle t) {
  return t.high_azimuth >= beam.middle_rad - 0.5 * beam.width_rad - azimuth_error_rad &&
         t.low_azimuth <= beam.middle_rad + 0.5 * beam.width_rad + azimuth_error_rad;
}

#include "gpu/upright_edges.glsl"

// ---- things ----

Thing thing_of(FanTriangle t, uint kind) {
  float a = tangent_of(t.corners[0]), b = tangent_of(t.corners[1]), c = tangent_of(t.corners[2]);
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
    for (uint i = beam.begin + lane; i < beam.begin + beam.count; i += GROUP) {
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
      s_first = atomicAdd(counts.needed.things, found);
    }
    barrier();
    has_room = s_first + found <= ping.room.things;
    beam.things = has_room ? found : 0u;
  }
  beam.first_thing = has_room ? s_first : 0u;
  memoryBarrierBuffer();
  barrier();
}

// True if thing i ends neither there nor before, because another one of its key goes on.
bool is_joined(uint i, bool at_high) {
  Thing thing = things[beam.first_thing + i];
  float at = at_high ? thing.high_azimuth : thing.low_azimuth;
  bool joined = false;
  for (uint first = 1u; first < beam.things && !joined; first += things_a_round) {
    for (uint n = 0u; n < things_a_round; ++n) {
      uint k = min(first + n, beam.things - 1u);
      uint j = i + k < beam.things ? i + k : i + k - beam.things;  // neighbours of surfaces come first
      Thing other = things[beam.first_thing + j];
      bool goes_on = at_high ? other.high_azimuth > at || (other.high_azimuth == at && j < i)
                             : other.low_azimuth < at || (other.low_azimuth == at && j < i);
      joined = joined || (other.key == thing.key && goes_on && other.low_azimuth <= at && other.high_azimuth >= at);
    }
  }
  return joined;
}

void list_ends() {
  if (lane == 0u) {
    s_count = 0u;
  }
  barrier();
  for (uint n = lane; n < 2u * beam.things; n += GROUP) {
    uint i = n / 2u;
    bool at_high = n % 2u == 1u;
    if (!is_joined(i, at_high)) {
      Thing thing = things[beam.first_thing + i];
      ends[2u * beam.first_thing + atomicAdd(s_count, 1u)] =
          ThingEnd(at_high ? thing.high_azimuth : thing.low_azimuth, thing.key, at_high ? 1u : 0u);
    }
  }
  barrier();
  beam.ends = s_count;
  barrier();
}

void main() {
  if (!lists_have_room(counts.needed)) {
    return;
  }
  beam = beams[group_number()];
  list_things();
  list_ends();
  list_edges();
  barrier();
  if (lane == 0u) {
    beams[group_number()] = beam;
  }
  report_cut_loops();
}
