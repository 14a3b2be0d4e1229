// SPDX-License-Identifier: Apache-2.0
// The buffers of a ping. Each shader declares those it uses; records are as in ping_buffers.hpp.

layout(std140, binding = 0) uniform Ping {
  float tan_limit, sin_limit, cos_limit, max_range_m;            // of the fan's elevation, and its range
  float port_x, port_y, starboard_x, starboard_y;                // unit normals of its sides, outwards
  float port_rad, starboard_rad, upright_rad, widest_slice_rad;  // see Fan
  float up_x, up_y, up_z, bend_per_m;                            // see Refraction
  int beams, clusters, parts;
  int is_convex;        // the fan is narrower than half a turn
  int two_sided, cull;  // 0: back faces are not seen; no cluster is culled
  int most_triangles, most_entries, most_visible, most_scratch, most_slices, most_pieces, most_things,
      most_edges;  // room in the buffers
}
ping;

// A slice, and the thin wedge around it that it represents.
struct Slice {
  float cosine, sine, width_rad;
  int beam;
  uint first_visible, visible_count;
  uint state;        // is_... below
  float offset_rad;  // azimuth, from the middle of its beam
  // Of its sides, weighted by the elevation pattern; see SliceSides:
  float ensonified, one_sided, lines;
  float missed_share;                      // of the fan's height, by thin things
  float mismatch, curvature, shift_lines;  // on the border to the next slice; see SliceBorder
  uint edge;                               // upright edge on that border, or no_edge
};
const uint is_seen = 1u, is_divided = 2u;  // is_divided: its parts replace it
const uint no_edge = 0xffffffffu;

// A visible part of a triangle in a slice, between two elevations.
struct Visible {
  float low, high, w_at_0, w_slope;
  float low_slope, low_reach, high_slope, high_reach;
  float normal_h, normal_s, normal_z;
  uint triangle;  // in `fan`
};

// A part of a body.
struct Part {
  Placement placement;
  uint first_hiding;                // of its shells: Shell::outwards if they hide their inner sides, or 0
  uint is_tall;                     // 1: some cluster in the fan is higher than the gap between two probes
  uint first_cluster, first_group;  // in `clusters`, and of all clusters of the ping
};

// A triangle in the fan, in the sonar frame.
struct FanTriangle {
  float x0, y0, z0, x1, y1, z1, x2, y2, z2;
  float low_azimuth, high_azimuth;
  uint flags;  // is_... below, and the part in the bits above them
  uint mesh_triangle;
  uint number;  // unique, in the order of the world: of surfaces in one place, the first is visible
  uint first_beam, last_beam;
};
const uint is_thin = 1u, is_small = 2u, is_of_low_cluster = 4u, has_upright_edge = 8u, is_back_face = 16u;
const uint part_shift = 5u;

struct BeamList {
  float port_rad;               // edge of the beam; one more record has the edge of the last beam
  uint count, begin, filled;    // triangles, in `lists`
  float middle_rad, width_rad;  // azimuth
  float cosine, sine;           // of the middle
  uint first_thing, things;     // see things.comp
  uint ends;                    // from 2 * first_thing
  uint first_edge, edges;
  uint first_slice, slices;                               // before any is divided, in `slices`
  float port_mismatch, port_curvature, port_shift_lines;  // on the border to the beam before
};

// A triangle that is thin, small or of a low part, and is joined with those of the same key that touch it.
struct Thing {
  float low_azimuth, high_azimuth;
  float low_t, high_t;
  uint key;  // kind and part
};
// The azimuth at which joined things begin or end.
struct ThingEnd {
  float azimuth;
  uint key, is_high;
};
const uint kind_bits = 2u, kind_mask = 3u, thin_kind = 0u, small_kind = 1u, low_kind = 2u;

// An upright edge (UprightEdge), from starboard to port in each beam.
struct Edge {
  float offset_rad;  // azimuth, from the middle of the beam
  uint count;        // of probes
  uint probes[side_probes / 32];
};

// Counts of a ping. More than there is room for: the ping is repeated with more room, so later stages need
// not run.
struct PingCounts {
  uint triangles, entries, visible, scratch, slices, pieces, things, edges;
  uint culled_clusters, hidden_faces;
  uint overflows;  // of lists that no room helps
  uint longest_slice;
  uint samples, invalid, without_facets, empty_beams;  // see BinningResult
  uint segments, rounds, additions;                    // see GpuWork
};
bool lists_have_room(PingCounts needed) {
  return needed.triangles <= uint(ping.most_triangles) && needed.entries <= uint(ping.most_entries);
}
bool visible_have_room(PingCounts needed) {
  return lists_have_room(needed) && needed.visible <= uint(ping.most_visible) &&
         needed.scratch <= uint(ping.most_scratch) && needed.things <= uint(ping.most_things) &&
         needed.edges <= uint(ping.most_edges);
}
// Whether a slice is there to be binned.
bool has_slice(uint number, PingCounts made) {
  return number < made.slices && made.slices <= uint(ping.most_slices) && visible_have_room(made);
}
// A round of refinement: the slices made for it.
struct Round {
  uint groups, one, also_one;  // of an indirect dispatch that sees them
  uint first_slice, slices;
};
const int most_rounds = 12;
const int most_slices_of_beam = 1023;
const uint most_groups = 65535u;

// Constants of a ping for comparing and dividing slices.
layout(std140, binding = 2) uniform Refinement {
  DivisionLimits division;
  float line_m, max_range_m, sagitta_lines;  // see SideView and SliceAccuracy
  ivec4 weights[side_probes / 4];            // ProbeWeights
}
refinement;

int probe_weight(uint probe) {
  return refinement.weights[probe / 4u][probe % 4u];
}

uint group_number() {
  return gl_WorkGroupID.x + gl_WorkGroupID.y * gl_NumWorkGroups.x;
}
