// SPDX-License-Identifier: Apache-2.0
// Sorts the segments of a band by low end, then by number, for see.comp.

uint bucket_of(float low) {
  precise float at = (low - band_low) * (float(count) / (band_high - band_low));  // the same at each call
  return uint(clamp(at, 0.0, float(count - 1u)));
}

bool comes_before(uint a, uint b) {
  return s_low[a] < s_low[b] || (s_low[a] == s_low[b] && s_number[a] < s_number[b]);
}

// Sets s_order: a counting sort into as many buckets as there are segments, then ranks within each bucket.
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
    s_order[atomicAdd(s_bucket[bucket_of(s_low[k])], 1u)] = k;  // s_bucket then has the ends
  }
  barrier();
  const uint most = (room + GROUP - 1u) / GROUP;
  uint rank[most], element[most], n = 0u;
  for (uint at = lane; at < count; at += GROUP, ++n) {
    uint k = s_order[at], bucket = bucket_of(s_low[k]);
    uint from = bucket == 0u ? 0u : s_bucket[max(bucket, 1u) - 1u], to = s_bucket[bucket];
    rank[n] = from;
    element[n] = k;
    for (uint j = from; j < to; ++j) {
      rank[n] += comes_before(s_order[j], k) ? 1u : 0u;
    }
  }
  barrier();
  n = 0u;
  for (uint at = lane; at < count; at += GROUP, ++n) {
    s_order[rank[n]] = element[n];
  }
  barrier();
  for (uint b = lane; b * block < count; b += GROUP) {
    float highest = -never;
    for (uint k = b * block; k < min(count, b * block + block); ++k) {
      highest = max(highest, s_high[s_order[k]]);
    }
    s_block_high[b] = highest;
  }
  barrier();
}
