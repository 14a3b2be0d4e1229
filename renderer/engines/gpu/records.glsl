// SPDX-License-Identifier: Apache-2.0
// The records that the CPU and the shaders share, the same text for C++ (records.hpp) and GLSL 4.30. Numbers
// of four bytes lie one behind the other.

// Room in the buffers of a ping, or what the ping needs, in records.
struct Room {
  uint triangles, entries, visible, scratch, slices, pieces, things, edges;
};

// Constants of a ping, a uniform block. Structures begin at multiples of 16 bytes there.
struct Ping {
  Room room;
  FanSpace fan;
  DivisionLimits division;
  float tan_limit, widest_slice_rad, upright_rad;  // see Fan
  float port_rad, starboard_rad;                   // edges of the fan
  float up_x, up_y, up_z, bend_per_m;              // see Refraction
  float line_m, bins_end_m, sagitta_lines;         // see SideView and SliceAccuracy
  int beams, clusters, parts;
  int two_sided, cull;                 // 0: back faces are not seen; no cluster is culled
  INTS_BY_FOUR(weights, side_probes);  // ProbeWeights
};

// Constants of its echoes, a uniform block.
struct Echo {
  float line_m;
  float lines_per_m_0, lines_per_m_1, lines_per_m_2;  // the sum is exact; see place_of() in bin.comp
  int lines;
  int is_physical;                                         // 0: mode `paper`
  int facets_anywhere;                                     // 1: Facets::everywhere
  int has_pattern;                                         // 0: the elevation pattern is 1 everywhere
  float displaced_m, mapped_m, facet_slopes;               // see PatchLimits
  float facet_m;                                           // see SlicePatcher::Request::facet_lines
  float height, height_in_one_place;                       // see PatchLimits
  float pattern_at_0, pattern_per_t;                       // place of t in `pattern`
  float sigmoid_slope, sigmoid_centre, attenuation_per_m;  // see SurfaceModel
  float units_per_sr, sr_per_unit;                         // of the sums
  int is_mean, has_open_water;                             // see BinningOptions
  FLOATS_BY_FOUR(pattern, 1028);                           // see ElevationPattern
};

// What the shaders counted.
struct PingCounts {
  Room needed;
  uint culled_clusters, hidden_faces;
  uint overflows;  // of lists that no room helps
  uint longest_slice;
  uint samples, invalid, without_facets, empty_beams;  // see BinningResult
  uint segments, rounds, additions;                    // see GpuWork
};

// A round of refinement: the slices made for it.
struct Round {
  uint groups, one, also_one;  // of an indirect dispatch that sees them
  uint first_slice, slices;
};
CONSTANT int most_rounds = 12;
CONSTANT uint most_slices_of_beam = 1023U;
CONSTANT uint most_groups = 65535U;  // in one row of a dispatch; every OpenGL allows as many

// ---- the world ----

// A cluster of a mesh: its bounding sphere in the frame of the part, vertices and triangles.
struct Cluster {
  float x, y, z, radius_m;
  uint first_vertex, vertex_count, first_triangle, triangle_count;
};
struct ClusterTriangle {
  uint corners;  // three vertices of the cluster, a byte each
  uint mesh_triangle;
  uint shell;  // Shells::of_triangle()
};

// A part of a body.
struct Part {
  Placement placement;
  uint first_hiding;                // of its shells: Shell::outwards if they hide their inner sides, or 0
  uint is_tall;                     // 1: some cluster in the fan is higher than the gap between two probes
  uint first_cluster, first_group;  // in `clusters`, and of all clusters of the ping
};

// The surface of a part (PartSurface).
struct Surface {
  float rotation[9];  // from the part to the sonar, row after row
  float lambert_mu, reflectance, facet_strength, slope_variance, least_cosine;
  uint flags;
  uint indices, vertices, floats_per_vertex;  // of its mesh, in `world`
  uint levels, level_count;                   // of its normal map, in `world`
};
CONSTANT uint has_vertex_normals = 1U, has_map = 2U;

// A triangle in the fan, in the sonar frame.
struct FanTriangle {
  Corner corners[3];
  float low_azimuth, high_azimuth;
  uint flags;  // is_... below, and the part in the bits above them
  uint mesh_triangle;
  uint number;  // unique, in the order of the world: of surfaces in one place, the first is visible
  uint first_beam, last_beam;
};
CONSTANT uint is_thin = 1U, is_small = 2U, is_of_low_cluster = 4U, has_upright_edge = 8U, is_back_face = 16U;
CONSTANT uint part_shift = 5U;

// ---- beams ----

// The border between two slices (SliceBorder).
struct Border {
  float mismatch, curvature, shift_lines;
};

struct Beam {
  float port_rad;               // one more record has the edge of the last beam
  uint count, begin, filled;    // triangles, in `lists`
  float middle_rad, width_rad;  // azimuth
  float cosine, sine;           // of the middle
  uint first_thing, things;     // see things.comp
  uint ends;                    // from 2 * first_thing
  uint first_edge, edges;
  uint first_slice, slices;  // before any is divided, in `slices`
  Border port;               // to the beam before
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
CONSTANT uint kind_bits = 2U, kind_mask = 3U, thin_kind = 0U, small_kind = 1U, low_kind = 2U;

// An upright edge (UprightEdge), from starboard to port in each beam.
struct Edge {
  float offset_rad;  // azimuth, from the middle of the beam
  uint count;        // of probes
  uint probes[side_probes / 32];
};

// ---- slices ----

// A slice, and the thin wedge around it that it represents (SliceCell).
struct Slice {
  float cosine, sine, width_rad;
  int beam;
  uint first_visible, visible_count;
  uint state;        // is_... below
  float offset_rad;  // azimuth, from the middle of its beam
  // Of its sides, weighted by the elevation pattern; see SliceSides:
  float ensonified, one_sided, lines;
  float missed_share;  // of the fan's height, by thin things
  Border starboard;    // to the next slice
  uint edge;           // 1 + the number of the upright edge on that border; 0: none
};
CONSTANT uint is_seen = 1U, is_divided = 2U;  // is_divided: its parts replace it

// What one piece of the sweep sees of a segment.
struct Seen {
  float low, high;
  uint segment, place;  // place: piece and number within it
};

// A visible part of a triangle in a slice, between two elevations (VisibleSegment).
struct Visible {
  float low, high, w_at_0, w_slope;
  float low_slope, low_reach, high_slope, high_reach;
  float normal_h, normal_s, normal_z;
  uint triangle;  // in `fan`
};

// ---- patches ----

// Where the pieces of a slice are, and later their patches.
struct SlicePieces {
  uint first, count;
};

// A visible segment or a part of one.
struct Piece {
  float low, high, low_slope, high_slope;  // ends, and how they move as straight lines across the wedge
  uint segment;                            // in `visible`
  uint flags;                              // low_end and ... below
  uint parts;                              // into which it must be divided
  uint unused;                             // a Patch is as long
};
CONSTANT uint low_end = 1U, high_end = 2U;  // the end is the segment's
CONSTANT uint goes_on = 4U;                 // the next piece continues its surface

// A patch (EchoPatch) takes the place of its piece. For patches side by side, the place refers to them.
struct Patch {
  float range_a, range_b, smear_a, smear_b;
  float echo, weight, echo_gradient, weight_gradient;
};
CONSTANT uint is_elsewhere = 0xffffffffU;  // first word; then the first patch and their number
