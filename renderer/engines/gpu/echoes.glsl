// SPDX-License-Identifier: Apache-2.0
// What the stages from visible segments to the image have in common. Records are as in gpu_echoes.cpp.

layout(std140, binding = 1) uniform Echo {
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
  vec4 pattern[257];                                       // four weights each; see ElevationPattern
}
echo;

// Where the pieces of a slice are, and later their patches.
struct SlicePieces {
  uint first, count;
};

// Two records of the buffer `pieces`: a piece is a visible segment or a part of one.
struct Piece {
  float low, high, low_slope, high_slope;  // ends, and how they move as straight lines across the wedge
  uint segment;                            // in `visible`
  uint flags;                              // low_end and ... below
};
const uint low_end = 1u, high_end = 2u;  // the end is the segment's
const uint goes_on = 4u;                 // the next piece continues its surface
const uint parts_shift = 8u;             // above: number of parts into which it must be divided

// A patch (EchoPatch) takes the place of its piece. For patches side by side, the place refers to them.
struct Patch {
  float range_a, range_b, smear_a, smear_b;
  float echo, weight, echo_gradient, weight_gradient;
};
const uint is_elsewhere = 0xffffffffu;  // first word; then the first patch and their number

uint lane_number() {
  return gl_LocalInvocationID.x;
}
