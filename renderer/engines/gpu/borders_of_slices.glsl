// SPDX-License-Identifier: Apache-2.0
// The comparison of neighbouring slices on their borders, for refine.comp. As
// SliceSampler::compare_neighbours().

shared int s_mismatched, s_curved;
shared Border s_port;  // of the beam

float expected(uint slice, uint side, uint probe) {  // 1 / h; side: 0 is port
  return sides[(2u * slice + side) * uint(side_probes) + probe];
}

bool is_ignored(uint edge, uint probe) {  // along an edge the surfaces differ
  return edge != 0u && (edges[edge - 1u].probes[probe / 32u] >> (probe % 32u) & 1u) != 0u;
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
      moment[side] = moment_of(near[side][0], near[side][1], secants[0], secants[1], limits.furthest_m,
                               probes_per_t, float(w.weight) / probe_weight_unit);
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

// All invocations must call it.
Border compare(uint port, uint starboard) {
  Slice a = slices[port], b = slices[starboard];
  float lines = max(1.0, min(a.lines, b.lines));
  float mean_width = 0.5 * (a.width_rad + b.width_rad);
  BorderLimits limits = BorderLimits(ping.line_m, ping.bins_end_m, ping.sagitta_lines * lines * ping.line_m,
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
  float divided_anyway = ping.division.disagreement / min(share_of_beam(a), share_of_beam(b));
  float shift = sums.x > 0.0 ? abs(sums.w - sums.z * (sums.y / sums.x)) / (0.5 * sums.x * ping.line_m) : 0.0;
  return Border(mismatch, float(s_curved) / all, mismatch > 0.0 && mismatch < divided_anyway ? shift : 0.0);
}

// Compares the borders of this beam, both ends included, that touch a fresh slice.
// @return whether there is any
bool compare_borders() {
  bool any = false;
  if (lane == 0u) {
    s_port = of_beam.port;
  }
  for (uint n = 0u; n <= count; ++n) {
    uint port = port_of(n), starboard = n < count ? slice_at(beam, n) : starboard_of(count - 1u);
    if (port == none || starboard == none || !(is_fresh(port) || is_fresh(starboard))) {
      continue;
    }
    any = true;
    Border border = compare(port, starboard);
    if (lane == 0u && n == 0u) {
      s_port = beams[beam].port = border;
    } else if (lane == 0u) {
      slices[port].starboard = border;
    }
  }
  memoryBarrierBuffer();
  barrier();
  return any || (count == 1u && is_fresh(slice_at(beam, 0u)));
}

// The larger values of both borders of a slice.
Border worse_border(uint n, Slice slice) {
  Border port = s_port, starboard = slice.starboard;
  if (n > 0u) {
    port = slices[slice_at(beam, n - 1u)].starboard;
  }
  return Border(max(port.mismatch, starboard.mismatch), max(port.curvature, starboard.curvature),
                max(port.shift_lines, starboard.shift_lines));
}
