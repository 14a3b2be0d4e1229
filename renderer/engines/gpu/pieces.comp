// SPDX-License-Identifier: Apache-2.0
// One group for each slice: divides its visible segments into pieces whose echo over range a patch can
// represent. As SlicePatcher::make() and VisibleEnds.
#include "gpu/pieces.glsl"
layout(std430, binding = 6) coherent buffer Pieces { Piece pieces[]; };

shared uint s_first;
uint first, count;  // pieces of the slice

void wait_for_all() {
  memoryBarrierBuffer();
  barrier();
}

// All invocations must call it. @return first of `wanted` pieces, or false if there is no room
bool make_room(uint wanted, out uint begin) {
  if (lane == 0u) {
    s_first = atomicAdd(counts.needed.pieces, wanted);
  }
  barrier();
  begin = s_first;
  barrier();
  return begin + wanted <= ping.room.pieces;
}

// ---- ends across the wedge ----

// Whether the next piece continues the surface of piece p, the i-th.
bool continues(uint i, Piece p, Visible of_p) {
  if (i + 1u == count) {
    return false;
  }
  Piece next = pieces[first + i + 1u];
  Visible of_next = visible[next.segment];
  float t = p.high;
  return t == next.low && fan[of_p.triangle].flags >> part_shift == fan[of_next.triangle].flags >> part_shift &&
         is_one_surface(of_p.w_at_0 + of_p.w_slope * t, of_next.w_at_0 + of_next.w_slope * t);
}

void limit_slopes() {
  for (uint i = begin_of_share(count, lane); i < begin_of_share(count, lane + 1u); ++i) {
    Piece p = pieces[first + i];
    Visible v = visible[p.segment];
    bool is_low = (p.flags & low_end) != 0u, is_high = (p.flags & high_end) != 0u;
    p.low_slope = is_low ? slope_within(v.low_slope, v.low_reach, p.low, slice.width_rad, ping.tan_limit) : 0.0;
    p.high_slope = is_high ? slope_within(v.high_slope, v.high_reach, p.high, slice.width_rad, ping.tan_limit) : 0.0;
    p.flags |= continues(i, p, v) ? goes_on : 0u;
    pieces[first + i] = p;
  }
}

float excess_of(Piece p) {
  return crossing_excess(p.low_slope, p.high_slope, p.high - p.low, slice.width_rad);
}

// As VisibleEnds::keep_from_crossing().
void keep_from_crossing(uint begin, uint last) {
  float most = 2.0 * (pieces[last].high - pieces[begin].low) / slice.width_rad;
  float whole = pieces[last].high_slope - pieces[begin].low_slope;
  if (abs(whole) > most) {  // the whole surface ends within the wedge
    float excess = 0.5 * (whole - with_sign_of(most, whole));
    pieces[begin].low_slope += excess;
    pieces[last].high_slope -= excess;
  }
  for (uint i = begin; i < last; ++i) {
    float excess = excess_of(pieces[i]);
    if (excess == 0.0) {
      break;
    }
    pieces[i].high_slope -= excess;
    pieces[i + 1u].low_slope = pieces[i].high_slope;
  }
  for (uint i = last; i > begin; --i) {
    float excess = excess_of(pieces[i]);
    if (excess == 0.0) {
      break;
    }
    pieces[i].low_slope += excess;
    pieces[i - 1u].high_slope = pieces[i].low_slope;
  }
}

bool goes_on_after(uint i) { return (pieces[i].flags & goes_on) != 0u; }

// One invocation for each surface.
void straighten_ends() {
  for (uint i = begin_of_share(count, lane); i < begin_of_share(count, lane + 1u); ++i) {
    if (i > 0u && goes_on_after(first + i - 1u)) {
      continue;
    }
    uint last = first + i;
    while (last + 1u < first + count && goes_on_after(last)) {
      ++last;
    }
    keep_from_crossing(first + i, last);
  }
}

// ---- division ----

// Writes the parts of a piece from `to` on. @param writing false: only counts them @return their number
uint divide(Piece whole, uint to, bool writing) {
  precise float turn = turn_of_range(visible[whole.segment].w_at_0, visible[whole.segment].w_slope);
  int parts = int(whole.parts);
  uint made = 0u;
  Piece part = whole;
  part.flags = whole.flags & low_end;
  for (int k = 1; k <= parts; ++k) {
    part.high = end_of_part(whole.low, whole.high, turn, k, parts);
    part.flags |= k == parts ? whole.flags & high_end : 0u;
    if (part.high > part.low) {
      if (writing) {
        pieces[to + made] = part;
      }
      ++made;
      part.low = part.high;
      part.flags = 0u;
    }
  }
  return made;
}

// Of the piece at hand.
int count_parts() {
  float height = piece.high - piece.low;
  UnevenSegment uneven = UnevenSegment(
      height, ranges.range_low, ranges.range_mid, ranges.range_high, 0.5 * (gradient.smear_low + gradient.smear_high),
      gradient.displaced_m, is_plain && gradient.gradient != 0.0, is_mapped(),
      FACETS == 1 && may_respond ? slopes_per_t * height : 0.0);
  PatchLimits limits = PatchLimits(echo.displaced_m, ping.fan.sampled_range_m, 0.5 * echo.line_m, echo.mapped_m,
                                   echo.facet_slopes, echo.height, echo.height_in_one_place);
  return parts_of_segment(uneven, limits);
}

// Notes for each of my pieces how many parts it must have. @return their number
uint find_parts() {
  uint made = 0u;
  for (uint i = begin_of_share(count, lane); i < begin_of_share(count, lane + 1u); ++i) {
    measure(pieces[first + i]);
    pieces[first + i].parts = piece.parts = uint(count_parts());
    made += divide(piece, 0u, false);
  }
  return made;
}

void write_parts(uint to) {
  for (uint i = begin_of_share(count, lane); i < begin_of_share(count, lane + 1u); ++i) {
    to += divide(pieces[first + i], to, true);
  }
}

// @return false if there is no room
bool begin_pieces() {
  count = slice.visible_count;
  if (!make_room(count, first)) {
    return false;
  }
  for (uint i = begin_of_share(count, lane); i < begin_of_share(count, lane + 1u); ++i) {
    uint segment = slice.first_visible + i;
    pieces[first + i] =
        Piece(visible[segment].low, visible[segment].high, 0.0, 0.0, segment, low_end | high_end, 1u, 0u);
  }
  return true;
}

// Divides pieces until none needs it. @return false if there is no room
bool divide_pieces() {
  for (int round_number = 0;; ++round_number) {
    wait_for_all();
    limit_slopes();
    wait_for_all();
    straighten_ends();
    wait_for_all();
    if (round_number == most_division_rounds) {
      return true;
    }
    uint total, to, before = sum_before(find_parts(), total);
    if (total == count) {
      return true;
    }
    if (!make_room(total, to)) {
      return false;
    }
    write_parts(to + before);
    first = to;
    count = total;
  }
}

void main() {
  uint number = group_number();
  if (!has_slice(number, counts.needed)) {
    return;
  }
  slice = slices[number];
  bool is_done = (slice.state & is_divided) == 0u && begin_pieces() && divide_pieces();
  if (lane == 0u) {
    of_slice[number] = SlicePieces(first, is_done ? count : 0u);
  }
  report_cut_loops();
}
