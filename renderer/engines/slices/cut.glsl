// SPDX-License-Identifier: Apache-2.0
// A triangle cut by a slice: the half plane h > 0 at one azimuth, with horizontal distance h and height z as
// coordinates. The tangent of the elevation, t = z / h, identifies a ray of the slice. Along a straight line
// in the slice, 1 / h is affine in t.

// Shortest segment, in radians of elevation; shorter ones are dropped, because rounding hides the slope of
// their surface.
CONSTANT float shortest_rad = 1e-6F;
CONSTANT float nearest_m = 1e-4F;  // nearer to the vertical axis, triangles are cut off

struct Corner {
  float x, y, z;  // in the sonar frame, m
};

// What a cut does with a triangle.
CONSTANT int cut_misses = 0;
CONSTANT int cut_keeps = 1;
CONSTANT int cut_is_partly_behind = 2;  // the triangle crosses the plane behind the vertical axis too

struct CutTriangle {
  int fate;
  // The segment, if the fate is cut_keeps:
  float low, high;        // t at the ends; low < high
  float w_at_0, w_slope;  // 1 / h = w_at_0 + w_slope * t
  // Motion of the ends beside the slice, along the edges on which they lie:
  float low_slope, high_slope;  // dt / d azimuth
  float low_reach, high_reach;  // length of the edge in t
};

// With s the distance of a corner from the plane of the slice, an edge from i to j crosses it at
// h = (h_i s_j - h_j s_i) / (s_j - s_i), and z likewise. Exchanging i and j changes only the signs of
// numerator and denominator, so that two triangles find the same point on their common edge.
SHARED CutTriangle cut_triangle(Corner c0, Corner c1, Corner c2, float cosine, float sine, float tan_limit) {
  precise float s0 = c0.y * cosine - c0.x * sine, h0 = c0.x * cosine + c0.y * sine;
  precise float s1 = c1.y * cosine - c1.x * sine, h1 = c1.x * cosine + c1.y * sine;
  precise float s2 = c2.y * cosine - c2.x * sine, h2 = c2.x * cosine + c2.y * sine;
  // Sides of the slice as numbers: GCC 12 does not vectorise a comparison of comparisons.
  float side0 = s0 >= 0.0F ? 1.0F : -1.0F, side1 = s1 >= 0.0F ? 1.0F : -1.0F,
        side2 = s2 >= 0.0F ? 1.0F : -1.0F;
  bool cut01 = side0 * side1 < 0.0F;
  bool cut20 = side2 * side0 < 0.0F;
  // The two edges that are cut: p is 0-1 or else 1-2, q is 2-0 or else 1-2.
  float hpi = cut01 ? h0 : h1, hpj = cut01 ? h1 : h2, spi = cut01 ? s0 : s1, spj = cut01 ? s1 : s2;
  float zpi = cut01 ? c0.z : c1.z, zpj = cut01 ? c1.z : c2.z;
  float hqi = cut20 ? h2 : h1, hqj = cut20 ? h0 : h2, sqi = cut20 ? s2 : s1, sqj = cut20 ? s0 : s2;
  float zqi = cut20 ? c2.z : c1.z, zqj = cut20 ? c0.z : c2.z;
  precise float ep = spj - spi, eq = sqj - sqi;
  precise float over_p = 1.0F / (hpi * spj - hpj * spi), over_q = 1.0F / (hqi * sqj - hqj * sqi);
  precise float tp = (zpi * spj - zpj * spi) * over_p, wp = ep * over_p;
  precise float tq = (zqi * sqj - zqj * sqi) * over_q, wq = eq * over_q;
  // dt / d azimuth along the edge is (dz - t dh) / ds; the edge spans the azimuth w ds.
  precise float rp = (zpj - zpi) - tp * (hpj - hpi), rq = (zqj - zqi) - tq * (hqj - hqi);
  precise float mp = rp / ep, mq = rq / eq;
  precise float fp = rp * wp, fq = rq * wq;
  bool p_low = tp < tq;
  precise float a = p_low ? tp : tq, b = p_low ? tq : tp, wa = p_low ? wp : wq, wb = p_low ? wq : wp;
  precise float steepness = (wb - wa) / (b - a);
  precise float at_0 = wa - steepness * a;
  float reach_a = p_low ? fp : fq, reach_b = p_low ? fq : fp;
  int crossed = side0 * side1 + side2 * side0 < 2.0F ? 1 : 0;
  bool in_fan = both(both(b - a > shortest_rad * (1.0F + a * a), b > -tan_limit), a < tan_limit);
  bool in_front = both(wp > 0.0F, wq > 0.0F), far_enough = both(wp < 1.0F / nearest_m, wq < 1.0F / nearest_m);
  int seen = in_fan ? cut_keeps : cut_misses;
  int not_in_front = both(wp <= 0.0F, wq <= 0.0F) ? cut_misses : cut_is_partly_behind;
  CutTriangle result;
  result.fate = crossed * (both(in_front, far_enough) ? seen : not_in_front);
  result.low = a;
  result.high = b;
  result.w_at_0 = at_0;
  result.w_slope = steepness;
  result.low_slope = p_low ? mp : mq;
  result.high_slope = p_low ? mq : mp;
  result.low_reach = reach_a < 0.0F ? -reach_a : reach_a;
  result.high_reach = reach_b < 0.0F ? -reach_b : reach_b;
  return result;
}
