// SPDX-License-Identifier: Apache-2.0
// One group for each beam: compares its slices with their neighbours, and divides those that disagree too much
// or miss something. As slice_refinement.cpp. A slice is fresh in the round after it was made.
layout(local_size_x = GROUP) in;
layout(location = 0) uniform int round_number;

layout(std430, binding = 0) coherent buffer Slices { Slice slices[]; };
// Of each parity of the round and each beam: the number of its slices, then these from port to starboard.
layout(std430, binding = 1) buffer Order { uint order[]; };
layout(std430, binding = 2) readonly buffer Sides { float sides[]; };
layout(std430, binding = 3) readonly buffer Things { Thing things[]; };
layout(std430, binding = 4) readonly buffer Edges { Edge edges[]; };
layout(std430, binding = 5) buffer Counts {
  PingCounts counts;
  Round rounds[most_rounds];
};
layout(std430, binding = 6) buffer Beams { BeamList beams[]; };
layout(std430, binding = 7) readonly buffer Ends { ThingEnd ends[]; };

const uint none = 0xffffffffu;
shared uint s_parts[most_slices_of_beam];  // of each slice
shared float s_sums[4][GROUP];
shared int s_mismatched, s_curved;
shared uint s_count[GROUP], s_made[GROUP], s_base;
shared vec3 s_port_border;

uint lane, beam, count;
BeamList of_beam;

uint order_begin(int parity, uint of) {
  return (uint(parity) * uint(ping.beams) + of) * (uint(most_slices_of_beam) + 1u);
}
// The n-th slice of a beam.
uint slice_at(uint of, uint n) {
  return round_number == 0 ? beams[of].first_slice + n : order[order_begin(round_number & 1, of) + 1u + n];
}
uint slices_of(uint of) { return round_number == 0 ? beams[of].slices : order[order_begin(round_number & 1, of)]; }

bool is_fresh(uint number) {
  return number != none && number >= rounds[round_number].first_slice;
}

// The slice before the n-th of this beam, or `none`.
uint port_of(uint n) {
  return n > 0u ? slice_at(beam, n - 1u) : beam > 0u ? slice_at(beam - 1u, slices_of(beam - 1u) - 1u) : none;
}
uint starboard_of(uint n) {
  return n + 1u < count                ? slice_at(beam, n + 1u)
         : beam + 1u < uint(ping.beams) ? slice_at(beam + 1u, 0u)
                                        : none;
}

float share_of_beam(Slice slice) { return slice.width_rad / beams[slice.beam].width_rad; }

// ---- borders ----

float expected(uint slice, uint side, uint probe) {  // 1 / h; side: 0 is port
  return sides[(2u * slice + side) * uint(side_probes) + probe];
}

bool is_ignored(uint edge, uint probe) {  // along an edge the surfaces differ
  return edge != no_edge && (edges[edge].probes[probe / 32u] >> (probe % 32u) & 1u) != 0u;
}

// Adds the probes of one lane to s_mismatched, s_curved and s_sums.
void compare_probes(uint port, uint starboard, uint edge, BorderLimits limits) {
  float probes_per_t = float(side_probes - 1) / (2.0 * probe_reach * ping.tan_limit);
  vec4 sums = vec4(0.0);
  int mismatched = 0, curved = 0;
  for (uint k = lane; k < uint(side_probes); k += GROUP) {
    ProbePair w;
    float near[2][2], secants[2];  // of this probe and the next
    for (uint next = 0u; next < 2u; ++next) {
      uint probe = min(k + next, uint(side_probes) - 1u);
      float t = probe_at(ping.tan_limit, int(probe));
      bool ignored = is_ignored(edge, probe);
      secants[next] = sqrt(1.0 + t * t);
      near[0][next] = ignored ? 0.0 : expected(port, 1u, probe);
      near[1][next] = ignored ? 0.0 : expected(starboard, 0u, probe);
    }
    w.port_far = expected(port, 0u, k);
    w.starboard_far = expected(starboard, 1u, k);
    w.port_near = near[0][0];
    w.starboard_near = near[1][0];
    w.secant = secants[0];
    w.weight = probe_weight(k);
    ProbeDisagreement probe = compare_probe(w, limits);
    mismatched += probe.mismatched;
    curved += probe.curved;
    if (k + 1u == uint(side_probes)) {
      continue;
    }
    vec2 echo, moment;
    for (int side = 0; side < 2; ++side) {
      moment[side] = moment_of(near[side][0], near[side][1], secants[0], secants[1], limits.furthest_m, probes_per_t,
                               float(w.weight) / probe_weight_unit);
      echo[side] = moment[side] * near[side][0];
    }
    sums.xy += vec2(echo.x + echo.y, moment.x + moment.y);
    if (probe.mismatched > 0) {
      sums.zw += vec2(echo.x - echo.y, moment.x - moment.y);
    }
  }
  atomicAdd(s_mismatched, mismatched);
  atomicAdd(s_curved, curved);
  for (int n = 0; n < 4; ++n) {
    s_sums[n][lane] = sums[n];
  }
}

// Mismatch, curvature and shift in lines (SliceBorder). All invocations must call it.
vec3 compare(uint port, uint starboard) {
  Slice a = slices[port], b = slices[starboard];
  float lines = max(1.0, min(a.lines, b.lines));
  float mean_width = 0.5 * (a.width_rad + b.width_rad);
  BorderLimits limits = BorderLimits(refinement.line_m, refinement.max_range_m,
                                     refinement.sagitta_lines * lines * refinement.line_m,
                                     mean_width / (8.0 * a.width_rad), mean_width / (8.0 * b.width_rad));
  barrier();
  if (lane == 0u) {
    s_mismatched = s_curved = 0;
  }
  barrier();
  compare_probes(port, starboard, a.edge, limits);
  barrier();
  vec4 sums = vec4(0.0);
  for (uint k = 0u; k < GROUP; ++k) {
    sums += vec4(s_sums[0][k], s_sums[1][k], s_sums[2][k], s_sums[3][k]);
  }
  float all = float(side_probes) * probe_weight_unit;
  float mismatch = float(s_mismatched) / all;
  float divided_anyway = refinement.division.disagreement / min(share_of_beam(a), share_of_beam(b));
  float shift = sums.x > 0.0
                    ? abs(sums.w - sums.z * (sums.y / sums.x)) / (0.5 * sums.x * refinement.line_m)
                    : 0.0;
  return vec3(mismatch, float(s_curved) / all, mismatch > 0.0 && mismatch < divided_anyway ? shift : 0.0);
}

// Compares the borders of this beam, both ends included, that touch a fresh slice.
// @return whether there is any
bool compare_borders() {
  bool any = false;
  if (lane == 0u) {
    s_port_border = vec3(of_beam.port_mismatch, of_beam.port_curvature, of_beam.port_shift_lines);
  }
  for (uint n = 0u; n <= count; ++n) {
    uint port = port_of(n), starboard = n < count ? slice_at(beam, n) : starboard_of(count - 1u);
    if (port == none || starboard == none || !(is_fresh(port) || is_fresh(starboard))) {
      continue;
    }
    any = true;
    vec3 border = compare(port, starboard);
    if (lane == 0u && n == 0u) {
      s_port_border = border;
      beams[beam].port_mismatch = border.x;
      beams[beam].port_curvature = border.y;
      beams[beam].port_shift_lines = border.z;
    } else if (lane == 0u) {
      slices[port].mismatch = border.x;
      slices[port].curvature = border.y;
      slices[port].shift_lines = border.z;
    }
  }
  memoryBarrierBuffer();
  barrier();
  return any || (count == 1u && is_fresh(slice_at(beam, 0u)));
}

// The larger values of both borders of a slice.
vec3 worse_border(uint n, Slice slice) {
  vec3 port = s_port_border;
  if (n > 0u) {
    Slice before = slices[slice_at(beam, n - 1u)];
    port = vec3(before.mismatch, before.curvature, before.shift_lines);
  }
  return max(port, vec3(slice.mismatch, slice.curvature, slice.shift_lines));
}

// ---- thin things and edges in a slice ----

bool lies_well_inside(float offset_rad, Slice slice) {
  const float margin = 1e-3;  // of the wedge
  return abs(offset_rad - slice.offset_rad) < (0.5 - margin) * slice.width_rad;
}

// Height in t of the triangles of a thing that reach into the wedge of a slice.
float height_within(Slice slice, uint key) {
  float azimuth = of_beam.middle_rad + slice.offset_rad, low = never, high = -never;
  for (uint i = of_beam.first_thing; i < of_beam.first_thing + of_beam.things; ++i) {
    Thing thing = things[i];
    if (thing.key == key && thing.low_azimuth < azimuth + 0.5 * slice.width_rad &&
        thing.high_azimuth > azimuth - 0.5 * slice.width_rad) {
      low = min(low, thing.low_t);
      high = max(high, thing.high_t);
    }
  }
  return max(high - low, 0.0);
}

// As SliceCutter::missed_height().
float missed_height(Slice slice) {
  float azimuth = of_beam.middle_rad + slice.offset_rad, half_width = 0.5 * slice.width_rad, height = 0.0;
  for (uint i = 0u; i < of_beam.ends; ++i) {
    ThingEnd end = ends[2u * of_beam.first_thing + i];
    float beside = end.azimuth - azimuth;
    bool is_low = (end.key & kind_mask) == low_kind;
    bool missed = is_low ? lies_well_inside(end.azimuth - of_beam.middle_rad, slice)
                  : end.is_high != 0u ? beside < azimuth_error_rad && beside > -half_width
                                      : beside > -azimuth_error_rad && beside < half_width;
    if (missed) {
      height = max(height, is_low ? least_missed : max(least_missed, height_within(slice, end.key)));
    }
  }
  return height;
}

const uint most_edges_of_slice = 4u;
// Edges well inside a slice, from port to starboard.
struct SliceEdges {
  uint count;
  float offset_rad[most_edges_of_slice];
  uint edge[most_edges_of_slice];  // no_edge: the end of a low thing
};

uint probes_of(uint edge) { return edge == no_edge ? 0u : edges[edge].count; }

// An order that does not depend on where edges lie.
bool is_higher(uint edge, float offset_rad, uint other, float other_offset_rad) {
  uint probes = probes_of(edge), of_other = probes_of(other);
  return probes > of_other || (probes == of_other && offset_rad > other_offset_rad);
}

// The highest edges in a slice (SliceCutter::find_upright_edges()).
SliceEdges edges_in(Slice slice) {
  SliceEdges found;
  found.count = 0u;
  for (uint i = 0u; i < of_beam.ends + of_beam.edges; ++i) {
    bool is_end = i < of_beam.ends;
    ThingEnd end = ends[is_end ? 2u * of_beam.first_thing + i : 0u];
    uint edge = is_end ? no_edge : of_beam.first_edge + i - of_beam.ends;
    float offset_rad = is_end ? end.azimuth - of_beam.middle_rad : edges[edge].offset_rad;
    if ((is_end && (end.key & kind_mask) != low_kind) || !lies_well_inside(offset_rad, slice)) {
      continue;
    }
    uint at = found.count;
    if (at == most_edges_of_slice) {
      at = 0u;
      for (uint k = 1u; k < most_edges_of_slice; ++k) {
        at = is_higher(found.edge[at], found.offset_rad[at], found.edge[k], found.offset_rad[k]) ? k : at;
      }
      if (!is_higher(edge, offset_rad, found.edge[at], found.offset_rad[at])) {
        continue;
      }
    } else {
      ++found.count;
    }
    found.offset_rad[at] = offset_rad;
    found.edge[at] = edge;
  }
  for (uint k = 1u; k < found.count; ++k) {  // from port to starboard
    for (uint i = k; i > 0u && found.offset_rad[i - 1u] < found.offset_rad[i]; --i) {
      float offset_rad = found.offset_rad[i];
      uint edge = found.edge[i];
      found.offset_rad[i] = found.offset_rad[i - 1u];
      found.edge[i] = found.edge[i - 1u];
      found.offset_rad[i - 1u] = offset_rad;
      found.edge[i - 1u] = edge;
    }
  }
  return found;
}

// ---- choice ----

uint first_of_mine() { return min(lane * ((count + GROUP - 1u) / GROUP), count); }
uint end_of_mine() { return min((lane + 1u) * ((count + GROUP - 1u) / GROUP), count); }

// Share of elevations at which the beam receives an echo, and the effective number of slices that share its
// error: weighted by squares, so that one slice much worse than the others counts alone.
vec2 errors_of_beam() {
  vec3 sums = vec3(0.0);
  for (uint n = first_of_mine(); n < end_of_mine(); ++n) {
    Slice slice = slices[slice_at(beam, n)];
    float share = share_of_beam(slice), error = share * worse_border(n, slice).x;
    sums += vec3(share * slice.ensonified, error * error, error * error * error * error);
  }
  barrier();
  for (int k = 0; k < 3; ++k) {
    s_sums[k][lane] = sums[k];
  }
  barrier();
  sums = vec3(0.0);
  for (uint k = 0u; k < GROUP; ++k) {
    sums += vec3(s_sums[0][k], s_sums[1][k], s_sums[2][k]);
  }
  return vec2(max(sums.x, least_ensonified), sums.z > 0.0 ? sums.y * sums.y / sums.z : 1.0);
}

// Writes the number of parts of each slice into s_parts.
void choose_parts(vec2 beam_errors) {
  for (uint n = lane; n < count; n += GROUP) {
    uint number = slice_at(beam, n);
    Slice slice = slices[number];
    if (is_fresh(number)) {
      slice.missed_share = missed_height(slice) / (2.0 * ping.tan_limit);
      slices[number].missed_share = slice.missed_share;
    }
    vec3 border = worse_border(n, slice);
    int parts = parts_of_slice(SliceErrors(share_of_beam(slice), beam_errors.x, beam_errors.y, border.x, border.y,
                                           border.z, slice.ensonified, slice.one_sided, slice.missed_share),
                               refinement.division);
    s_parts[n] = uint(parts);
  }
  memoryBarrierBuffer();
  barrier();
}

// ---- division ----

// Sine and cosine - 1 of a small angle.
vec2 sine_and_versine(float x) {
  float x2 = x * x;
  return vec2(x * (1.0 - x2 * (1.0 / 6.0 - x2 * (1.0 / 120.0 - x2 * (1.0 / 5040.0)))),
              -x2 * (0.5 - x2 * (1.0 / 24.0 - x2 * (1.0 / 720.0 - x2 * (1.0 / 40320.0)))));
}

Slice part_between(Slice whole, float from, float to) {
  Slice part = whole;
  part.offset_rad = 0.5 * (from + to);
  part.width_rad = from - to;
  vec2 turn = sine_and_versine(part.offset_rad);
  part.cosine = of_beam.cosine + (of_beam.cosine * turn.y - of_beam.sine * turn.x);
  part.sine = of_beam.sine + (of_beam.sine * turn.y + of_beam.cosine * turn.x);
  part.first_visible = part.visible_count = part.state = 0u;
  part.mismatch = part.curvature = part.shift_lines = 0.0;
  return part;
}

// Writes the parts of a slice: divided at upright edges if there are any, else evenly.
void divide(Slice whole, SliceEdges at, uint parts, uint first, uint to_order) {
  float port = whole.offset_rad + 0.5 * whole.width_rad, from = port;
  for (uint k = 0u; k < parts; ++k) {
    bool last = k + 1u == parts, at_edge = at.count > 0u && !last;
    float to = at_edge ? at.offset_rad[k] : port - whole.width_rad * float(k + 1u) / float(parts);
    Slice part = part_between(whole, from, to);
    part.edge = last ? whole.edge : at_edge ? at.edge[k] : no_edge;
    if (at.count == 0u) {
      part.width_rad = whole.width_rad / float(parts);
      if (2u * k + 1u == parts) {  // sees what the whole has seen
        part.cosine = whole.cosine;
        part.sine = whole.sine;
        part.offset_rad = whole.offset_rad;
        part.first_visible = whole.first_visible;
        part.visible_count = whole.visible_count;
        part.state = is_seen;
      }
    }
    if (first + k < uint(ping.most_slices)) {
      slices[first + k] = part;
    }
    order[to_order + k] = first + k;
    from = to;
  }
}

// Takes `made` slices for this beam, and counts them for the next round. @return the first
uint take_slices(uint made) {
  rounds[round_number + 1].first_slice = rounds[round_number].first_slice + rounds[round_number].slices;
  uint all = atomicAdd(rounds[round_number + 1].slices, made) + made;
  atomicMax(rounds[round_number + 1].groups, min(all, most_groups));
  atomicMax(counts.rounds, uint(round_number) + 2u);
  if (all > most_groups) {
    atomicAdd(counts.overflows, 1u);
  }
  return atomicAdd(counts.slices, made);
}

// Counts the parts of all slices, then writes the next order and the new slices.
void divide_slices() {
  uint next = order_begin(1 - (round_number & 1), beam) + 1u, base = 0u, total = 0u;
  for (int writing = 0; writing < 2; ++writing) {
    uint to = writing == 0 ? 0u : s_count[lane], made = writing == 0 ? 0u : s_made[lane];
    for (uint n = first_of_mine(); n < end_of_mine(); ++n) {
      uint number = slice_at(beam, n);
      if (s_parts[n] == 1u || total > uint(most_slices_of_beam)) {
        if (writing == 1) {
          order[next + to] = number;
        }
        ++to;
        continue;
      }
      Slice whole = slices[number];
      SliceEdges at = edges_in(whole);
      uint parts = at.count > 0u ? at.count + 1u : s_parts[n];
      if (writing == 1) {
        divide(whole, at, parts, base + made, next + to);
        slices[number].state = whole.state | is_divided;
      }
      to += parts;
      made += parts;
    }
    barrier();
    if (writing == 1) {
      break;
    }
    s_count[lane] = to;
    s_made[lane] = made;
    barrier();
    uint before[2] = uint[2](0u, 0u), all_made = 0u;
    total = 0u;
    for (uint k = 0u; k < GROUP; ++k) {
      before[0] += k < lane ? s_count[k] : 0u;
      before[1] += k < lane ? s_made[k] : 0u;
      total += s_count[k];
      all_made += s_made[k];
    }
    barrier();
    if (total > uint(most_slices_of_beam)) {
      before[0] = first_of_mine();
      all_made = 0u;
    }
    s_count[lane] = before[0];
    s_made[lane] = before[1];
    if (lane == 0u) {
      if (total > uint(most_slices_of_beam)) {
        atomicAdd(counts.overflows, 1u);
      }
      s_base = all_made > 0u ? take_slices(all_made) : 0u;
      order[next - 1u] = total > uint(most_slices_of_beam) ? count : total;
    }
    barrier();
    base = s_base;
  }
}

void keep_order() {
  uint next = order_begin(1 - (round_number & 1), beam);
  order[next] = count;
  for (uint n = lane; n < count; n += GROUP) {
    order[next + 1u + n] = slice_at(beam, n);
  }
}

void main() {
  lane = gl_LocalInvocationID.x;
  beam = group_number();
  if (rounds[round_number].slices == 0u || !visible_have_room(counts) ||
      rounds[round_number].first_slice + rounds[round_number].slices > uint(ping.most_slices)) {
    return;
  }
  of_beam = beams[beam];
  count = slices_of(beam);
  if (!compare_borders()) {
    keep_order();
    return;
  }
  choose_parts(errors_of_beam());
  divide_slices();
}
