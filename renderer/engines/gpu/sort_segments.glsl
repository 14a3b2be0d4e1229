// SPDX-License-Identifier: Apache-2.0
// Sorts the segments of a band by low end, then by number, for see.comp.

uint bucket_of(float low) {
  precise float at = (low - band_low) * (float(count) / (band_high - band_low));  // the same at each call
  return uint(clamp(at, 0.0, float(count - 1u)));
}

bool comes_before(uint a, uint b) {
  return s_low[a] < s_low[b] || (s_low[a] == s_low[b] && s_number[a] < s_number[b]);
}

// Sets s_order: a counting sort into as many buckets as there are segments, then ranks within each bucket. If
// the driver cuts loops, s_order has no meaning, but no index leads out of the arrays.
void sort_segments() {
  for (uint k = lane; k < count; k += GROUP) {
    s_bucket[k] = 0u;
  }
  barrier();
  for (uint k = lane; k < count; k += GROUP) {
    atomicAdd(s_bucket[bucket_of(s_low[k])], 1u);
  }
  barrier();
  uint begin = begin_of_share(count, lane), end = begin_of_share(count, lane + 1u), sum = 0u, all;
  for (uint k = begin; k < end; ++k) {
    sum += s_bucket[k];
  }
  uint before = sum_before(sum, all);
  for (uint k = begin; k < end; ++k) {
    uint here = s_bucket[k];
    s_bucket[k] = before;
    before += here;
  }
  barrier();
  for (uint k = lane; k < count; k += GROUP) {
    uint place = atomicAdd(s_bucket[bucket_of(s_low[k])], 1u);  // s_bucket then has the ends
    s_order[min(place, room - 1u)] = k;
  }
  barrier();
  const uint most = (room + GROUP - 1u) / GROUP;
  uint rank[most], element[most], n = 0u;
  for (uint at = lane; at < count; at += GROUP, ++n) {
    uint k = min(s_order[at], room - 1u), bucket = bucket_of(s_low[k]);
    uint from = bucket == 0u ? 0u : s_bucket[max(bucket, 1u) - 1u], to = s_bucket[bucket];
    rank[n] = from;
    element[n] = k;
    for (uint j = from; j < to; ++j) {
      rank[n] += comes_before(min(s_order[min(j, room - 1u)], room - 1u), k) ? 1u : 0u;
    }
  }
  barrier();
  n = 0u;
  for (uint at = lane; at < count; at += GROUP, ++n) {
    s_order[min(rank[n], room - 1u)] = element[n];
  }
  barrier();
  for (uint b = lane; b * block < count; b += GROUP) {
    float highest = -never;
    for (uint k = b * block; k < min(count, b * block + block); ++k) {
      highest = max(highest, s_high[min(s_order[k], room - 1u)]);
    }
    s_block_high[b] = highest;
  }
  barrier();
}
