// SPDX-License-Identifier: Apache-2.0
// The response of a surface's facets (Backscatter::facets), its mean over a segment and across the wedge.

// exp(x) for x from -80 to 0, accurate to 2e-7; a call of a library would prevent vectorisation.
SHARED float exp_of_negative(float x) {
  float y = x * 1.44269504F;
  int whole = int(y - 0.5F);
  float z = (y - float(whole)) * 0.69314718F;  // from -ln 2 / 2 to ln 2 / 2
  float series =
      1.0F + z * (1.0F + z * (0.5F + z * (1.0F / 6.0F +
                                          z * (1.0F / 24.0F + z * (1.0F / 120.0F + z * (1.0F / 720.0F))))));
  return series * intBitsToFloat((whole + 127) << 23);
}

// The response as a function of the squared cosine of the incidence, without branches. A negligible response
// is 1e-25, also for NaN. The variance is at most Backscatter::widest_variance.
SHARED float facet_law(float c2, float strength, float variance) {
  const float grazing = 1e-4F, as_good_as_none = 80.0F;
  float k2 = c2 > grazing ? (c2 < 1.0F ? c2 : 1.0F) : grazing;
  float exponent = (1.0F - k2) / (2.0F * variance * k2);
  return strength / (variance * k2 * k2 * sqrt(k2)) *
         exp_of_negative(exponent < as_good_as_none ? -exponent : -as_good_as_none);
}

// Normal of a surface beside a slice: (h, s, z) at azimuth 0 and t = 0, its change per azimuth x and per t.
struct NormalField {
  float at_h, at_s, at_z;
  float h_per_x, s_per_x, z_per_x;
  float h_per_t, s_per_t, z_per_t;
};

struct FacetMaterial {
  float strength, variance;
};

// The response in the direction (1, x, t), where the normal is (n_h, n_s, n_z), of any length.
SHARED float facets_toward(float n_h, float n_s, float n_z, float x, float t, FacetMaterial facets) {
  float product = n_h + n_s * x + n_z * t;
  float c2 = product * product / ((n_h * n_h + n_s * n_s + n_z * n_z) * (1.0F + x * x + t * t));
  return facet_law(c2, facets.strength, facets.variance);
}

SHARED float facets_at(NormalField n, FacetMaterial facets, float x, float t) {
  return facets_toward(n.at_h + n.h_per_x * x + n.h_per_t * t, n.at_s + n.s_per_x * x + n.s_per_t * t,
                       n.at_z + n.z_per_x * x + n.z_per_t * t, x, t, facets);
}

// The response over a segment and the width of its wedge.
struct FacetResponse {
  float mean;
  float moment;    // mean of response * (place across the wedge, from its middle)
  float gradient;  // response at the high end minus response at the low end
};

// Gauss and Legendre's three points across, Simpson's along.
SHARED FacetResponse facets_of_segment(NormalField n, FacetMaterial facets, float t1, float t2,
                                       float width_rad) {
  const float place = 0.38729833F, beside = 5.0F / 18.0F, at_middle = 8.0F / 18.0F;
  float x = place * width_rad, tm = 0.5F * (t1 + t2);
  float port1 = facets_at(n, facets, x, t1), port_m = facets_at(n, facets, x, tm),
        port2 = facets_at(n, facets, x, t2);
  float starboard1 = facets_at(n, facets, -x, t1), starboard_m = facets_at(n, facets, -x, tm),
        starboard2 = facets_at(n, facets, -x, t2);
  float mean1 = beside * (port1 + starboard1) + at_middle * facets_at(n, facets, 0.0F, t1);
  float mean_m = beside * (port_m + starboard_m) + at_middle * facets_at(n, facets, 0.0F, tm);
  float mean2 = beside * (port2 + starboard2) + at_middle * facets_at(n, facets, 0.0F, t2);
  FacetResponse response;
  response.mean = (mean1 + 4.0F * mean_m + mean2) * (1.0F / 6.0F);
  response.moment = beside * place * (1.0F / 6.0F) *
                    ((port1 - starboard1) + 4.0F * (port_m - starboard_m) + (port2 - starboard2));
  response.gradient = mean2 - mean1;
  return response;
}

// Turn of the echo's direction, re the direction of a mirror.
struct FacetTurn {
  float along_per_t;  // per t, along the slice
  float across_rad;   // across the wedge
  float cosine;       // of the incidence in the middle
};

// From the changes of direction d and normal n, both of unit length, in the middle; re a mirror they differ
// by d - n or d + n.
SHARED FacetTurn turn_of_facets(NormalField n, float t, float width_rad) {
  float n_h = n.at_h + n.h_per_t * t, n_s = n.at_s + n.s_per_t * t, n_z = n.at_z + n.z_per_t * t;
  float per_d = 1.0F / sqrt(1.0F + t * t);
  float per_n = 1.0F / sqrt(n_h * n_h + n_s * n_s + n_z * n_z);
  float product = (n_h + n_z * t) * per_d * per_n;
  float facing = with_sign_of(per_n, product);
  float u_h = n_h * per_n, u_s = n_s * per_n, u_z = n_z * per_n;
  // Along: d changes by the part of (0, 0, 1) across d, n by the part of per_t across n.
  float d_t = t * per_d * per_d;  // (0, 0, 1) . d, divided by the length of q
  float n_t = u_h * n.h_per_t + u_s * n.s_per_t + u_z * n.z_per_t;
  float a_h = -d_t * per_d - (n.h_per_t - u_h * n_t) * facing;
  float a_s = -(n.s_per_t - u_s * n_t) * facing;
  float a_z = (1.0F - d_t * t) * per_d - (n.z_per_t - u_z * n_t) * facing;
  // Across: (0, 1, 0) is across d.
  float n_x = u_h * n.h_per_x + u_s * n.s_per_x + u_z * n.z_per_x;
  float b_h = -(n.h_per_x - u_h * n_x) * facing;
  float b_s = per_d - (n.s_per_x - u_s * n_x) * facing;
  float b_z = -(n.z_per_x - u_z * n_x) * facing;
  FacetTurn turn;
  turn.along_per_t = sqrt(a_h * a_h + a_s * a_s + a_z * a_z);
  turn.across_rad = sqrt(b_h * b_h + b_s * b_s + b_z * b_z) * width_rad;
  turn.cosine = abs(product);
  return turn;
}

// False only if all facets of a segment, between both sides of the wedge, echo less than
// SkipRule::facet_kernel allows. Incidences up to half the turn away count too: cos(phi - a) <= cos phi + a
// sin phi. height: of the segment, in t
SHARED bool facets_may_respond(FacetTurn turn, float height, float least_cosine) {
  float sine2 = 1.0F - turn.cosine * turn.cosine;
  float sine = sqrt(sine2 > 0.0F ? sine2 : 0.0F);
  float half_of_turn = 0.5F * (turn.along_per_t * height + turn.across_rad);
  return turn.cosine + half_of_turn * sine > least_cosine;
}

// Relative change r' / r, per radian of azimuth, of the range of a surface with these normals, in the
// direction q = (1, x, t). On p = h q the surface is perpendicular to its normal: (ln h)' = -n_s / (n . q).
// The range is h times the length of q.
SHARED float range_slope(NormalField n, float x, float t) {
  const float steepest = 10.0F;  // 84 degrees off: a silhouette
  float n_h = n.at_h + x * n.h_per_x + t * n.h_per_t;
  float n_s = n.at_s + x * n.s_per_x + t * n.s_per_t;
  float n_z = n.at_z + x * n.z_per_x + t * n.z_per_t;
  float slope = -n_s / (n_h + n_s * x + n_z * t);
  float kept = slope > steepest ? steepest : (slope < -steepest ? -steepest : slope);
  return kept + x / (1.0F + x * x + t * t);
}

CONSTANT float widest_facets = 2.5F;  // turn across the wedge, in rms slopes, for three samples

CONSTANT float most_side_by_side = 16.0F;

// Number of patches side by side that represent a segment whose facets echo off the middle of the wedge.
// moved_m: of the centroid. sagitta_m: of the range across the wedge, times the facets' share of the echo
SHARED int patches_side_by_side(float moved_m, float sagitta_m, float allowed_m) {
  // Both the move and the curvature of a part fall with the square of the number of parts.
  float wanted = ceil(sqrt(max(abs(moved_m), abs(sagitta_m)) / allowed_m));
  return int(min(max(wanted, 1.0F), most_side_by_side));
}
