// SPDX-License-Identifier: Apache-2.0
// One piece of the sweep, for see.comp. As SliceSweep.

const uint most_waiting = uint(WAITING);
uint waiting[most_waiting];
uint waits, current, crosser, next, emitted;
float crossing, t;
uint most_seen;  // room in `scratch`

Line line_of(uint k) {
  return Line(int(s_number[k]), s_high[k], s_w_at_0[k], s_w_slope[k]);
}

float start_of(uint k) {
  return k < count ? max(band_low, s_low[s_order[k]]) : never;
}

void wait_for(uint segment) {
  if (waits < most_waiting) {
    waiting[waits++] = segment;
  } else {
    s_lost = 1u;
  }
}

void find_next_crossing() {
  crossing = never;
  for (uint k = 0u; k < waits; ++k) {
    float at = s_high[waiting[k]] > t ? crossing_of(line_of(current), line_of(waiting[k]), t) : never;
    if (at < crossing) {
      crossing = at;
      crosser = k;
    }
  }
}

// Makes the nearest of all segments at t the current one.
void take_nearest() {
  while (next < count && start_of(next) <= t) {
    wait_for(s_order[next++]);
  }
  uint kept = 0u, best = 0u;
  for (uint k = 0u; k < waits; ++k) {
    uint candidate = waiting[k];
    if (!(s_high[candidate] > t)) {
      continue;
    }
    waiting[kept] = candidate;
    if (kept > 0u) {
      Line a = line_of(candidate), b = line_of(waiting[best]);
      if (is_seen_first(a, b, t, crossing_of(a, b, t))) {
        best = kept;
      }
    }
    ++kept;
  }
  waits = kept;
  if (kept > 0u) {
    current = waiting[best];
    waiting[best] = waiting[--waits];
  }
}

void emit(float until) {
  if (!(until > t)) {
    return;
  }
  uint at = atomicAdd(s_used, 1u);
  if (at < most_seen) {
    scratch[s_base + at] = Seen(t, until, current, lane << 16 | emitted);
  } else {
    s_lost = 1u;
  }
  ++emitted;
  t = until;
}

// Number of segments that begin before `from`.
uint count_before(float from) {
  uint begin = 0u, end = count;
  while (begin < end) {
    uint middle = (begin + end) / 2u;
    if (start_of(middle) < from) {
      begin = middle + 1u;
    } else {
      end = middle;
    }
  }
  return begin;
}

// The next segment that began before the piece and reaches over its begin, or `none`. Then next is `earlier`.
uint take_earlier(uint earlier) {
  while (next < earlier) {
    if (next % block == 0u && !(s_block_high[next / block] > t)) {
      next = min(next + block, earlier);
    } else if (s_high[s_order[next]] > t) {
      return s_order[next++];
    } else {
      ++next;
    }
  }
  return none;
}

// As SliceSweep::run(), from the begin of a piece to its end. At the begin it meets all segments that began
// earlier.
void sweep(float from, float until) {
  waits = next = 0u;
  current = none;
  t = from;
  bool crossing_is_known = false;
  uint earlier = lane > 0u ? count_before(from) : 0u;
  while (t < until && s_lost == 0u) {
    float start = t;
    uint met;
    if (next < earlier) {
      met = take_earlier(earlier);
      if (met == none) {
        continue;
      }
      crossing_is_known = false;
      if (current == none) {
        current = met;
        continue;
      }
    } else {
      if (current == none) {
        take_nearest();
        if (current == none) {
          if (next == count || start_of(next) >= until) {
            break;
          }
          t = start_of(next);
          continue;
        }
        crossing_is_known = false;
      }
      if (!crossing_is_known) {
        find_next_crossing();
        crossing_is_known = true;
      }
      float end = min(s_high[current], until);
      start = start_of(next);
      if (crossing < start && crossing < end) {
        emit(crossing);
        uint before = current;
        current = waiting[crosser];
        waiting[crosser] = before;
        crossing_is_known = false;
        continue;
      }
      if (!(start < end)) {
        emit(end);
        current = none;
        continue;
      }
      met = s_order[next++];
    }
    Line a = line_of(met), b = line_of(current);
    float at = crossing_of(a, b, start);
    bool cross = at < never;
    if (is_seen_first(a, b, start, at)) {
      emit(start);
      if (cross || b.high > a.high) {
        wait_for(current);
      }
      current = met;
      crossing_is_known = false;
    } else if (cross || a.high > b.high) {
      wait_for(met);
      if (at < crossing) {
        crossing = at;
        crosser = waits - 1u;
      }
    }
  }
}

float border_of(uint piece) {
  return piece == 0u      ? band_low
         : piece == GROUP ? band_high
                          : clamp(s_low[s_order[piece * count / GROUP]], band_low, band_high);
}
