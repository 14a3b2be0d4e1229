// SPDX-License-Identifier: Apache-2.0
// What a slice expects at the two sides of its wedge if its surfaces continue as in its middle.

// Number of t at which neighbouring slices are compared, evenly spaced over the elevation of the fan. The
// first and the last lie just inside its limits, where weak echoes of a beam often are.
CONSTANT int side_probes = 256;
CONSTANT float probe_reach = 0.999F;  // of the tangent of the limit

// Unit of the probes' weights (ProbeWeights), which are whole numbers.
CONSTANT float probe_weight_unit = 1024.0F;

SHARED float first_probe(float tan_limit) {
  return -probe_reach * tan_limit;
}

SHARED float probe_step(float tan_limit) {
  return -2.0F * first_probe(tan_limit) / float(side_probes - 1);
}

// The tangent of the elevation of a probe.
SHARED float probe_at(float tan_limit, int probe) {
  return first_probe(tan_limit) + float(probe) * probe_step(tan_limit);
}

// Number of the first probe above t, which lies from 0 to side_probes.
SHARED int probe_above(float t, float tan_limit) {
  // Negative numbers become 0, so truncation equals floor.
  float place = (t - first_probe(tan_limit)) * (1.0F / probe_step(tan_limit)) + 1.0F;
  return int(place < 0.0F ? 0.0F : (place > float(side_probes) ? float(side_probes) : place));
}

// The slope of a segment's end (dt / d azimuth) as a straight line over a wedge of the fan. An end at t moves
// at most by `reach`, the length of its edge; an end that leaves the fan stops there.
SHARED float slope_within(float slope, float reach, float t, float width_rad, float tan_limit) {
  float rest = (tan_limit - (t < 0.0F ? -t : t)) * 2.0F;
  float most = (reach < rest ? reach : rest) / width_rad;
  return slope > most ? most : (slope < -most ? -most : slope);
}

// Change of w = 1 / h with the azimuth, in the middle t of a segment. On a plane n . p = D,
// 1 / h = (n_h + n_z t) / D changes by n_s / D, at any point.
SHARED float w_per_azimuth(float w_at_0, float w_slope, float normal_h, float normal_s, float normal_z,
                           float t) {
  return (w_at_0 + w_slope * t) * normal_s / (normal_h + normal_z * t);
}
