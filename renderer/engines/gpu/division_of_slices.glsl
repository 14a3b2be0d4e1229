// SPDX-License-Identifier: Apache-2.0
// The division of slices into parts, for refine.comp. As SliceSampler::divide().

shared uint s_base;

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
  part.starboard = Border(0.0, 0.0, 0.0);
  return part;
}

// Writes the parts of a slice: divided at upright edges if there are any, else evenly.
void divide(Slice whole, SliceEdges at, uint parts, uint first, uint to_order) {
  float port = whole.offset_rad + 0.5 * whole.width_rad, from = port;
  for (uint k = 0u; k < parts; ++k) {
    bool last = k + 1u == parts, at_edge = at.count > 0u && !last;
    float to = at_edge ? at.at[k].offset_rad : port - whole.width_rad * float(k + 1u) / float(parts);
    Slice part = part_between(whole, from, to);
    part.edge = last ? whole.edge : at_edge ? at.at[k].edge : 0u;
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
    if (first + k < ping.room.slices) {
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
  return atomicAdd(counts.needed.slices, made);
}

// Where the order of the next round begins.
uint next_order() {
  return order_begin(1 - (round_number & 1), beam);
}
void keep_order() {
  order[next_order()] = count;
  for (uint n = lane; n < count; n += GROUP) {
    order[next_order() + 1u + n] = slice_at(beam, n);
  }
}

// Divides the slices into s_parts. All invocations must call it.
void divide_slices() {
  uint begin = begin_of_share(count, lane), end = begin_of_share(count, lane + 1u);
  uint to = 0u, made = 0u, all, all_made;  // places of the parts in the order, and among the new slices
  for (uint n = begin; n < end; ++n) {
    to += s_parts[n];
    made += s_parts[n] > 1u ? s_parts[n] : 0u;
  }
  to = next_order() + 1u + sum_before(to, all);
  made = sum_before(made, all_made);
  if (all > most_slices_of_beam) {
    keep_order();
    atomicAdd(counts.overflows, 1u);
    return;
  }
  if (lane == 0u) {
    s_base = all_made > 0u ? take_slices(all_made) : 0u;
    order[next_order()] = all;
  }
  barrier();
  for (uint n = begin; n < end; ++n) {
    uint number = slice_at(beam, n), parts = s_parts[n];
    if (parts == 1u) {
      order[to++] = number;
      continue;
    }
    Slice whole = slices[number];
    divide(whole, edges_in(whole), parts, s_base + made, to);
    slices[number].state = whole.state | is_divided;
    to += parts;
    made += parts;
  }
}
