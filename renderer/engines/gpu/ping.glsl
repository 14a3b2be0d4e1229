// SPDX-License-Identifier: Apache-2.0
// What all shaders of a ping have in common. Each one declares the buffers that it uses.
// clang-format off
#include "slices/language.glsl"
#include "slices/cut.glsl"
#include "slices/place.glsl"
#include "slices/sweep.glsl"
#include "slices/sides.glsl"
#include "slices/refine.glsl"
#define INTS_BY_FOUR(name, count) ivec4 name[(count) / 4]
#define FLOATS_BY_FOUR(name, count) vec4 name[(count) / 4]
#include "gpu/records.glsl"
#include "gpu/group.glsl"
// clang-format on

layout(std140, binding = 0) uniform PingBlock {
  Ping ping;
};

int probe_weight(uint probe) {
  return ping.weights[probe / 4u][probe % 4u];
}

// If a buffer is too small, the ping is repeated with more room, so later stages need not run.
bool lists_have_room(Room needed) {
  return needed.triangles <= ping.room.triangles && needed.entries <= ping.room.entries;
}
bool visible_have_room(Room needed) {
  return lists_have_room(needed) && needed.visible <= ping.room.visible &&
         needed.scratch <= ping.room.scratch && needed.things <= ping.room.things &&
         needed.edges <= ping.room.edges;
}
// Whether a slice is there to be binned.
bool has_slice(uint number, Room needed) {
  return number < needed.slices && needed.slices <= ping.room.slices && visible_have_room(needed);
}

// llvmpipe ends all further loops of an invocation after 65,535 rounds (LP_MAX_TGSI_LOOP_ITERATIONS of Mesa),
// and says nothing. Such a ping counts as an overflow.
bool loops_are_cut() {
  uint n = 0u, end = 1u + uint(ping.room.slices > 0u);  // 2, which no compiler knows
  while (n < end) {
    ++n;
  }
  return n < 2u;
}
// Loops over all things of a beam take so many in a round: compilers unroll the inner loop.
const uint things_a_round = 8u;
#define report_cut_loops() atomicAdd(counts.overflows, loops_are_cut() ? 1u : 0u)
