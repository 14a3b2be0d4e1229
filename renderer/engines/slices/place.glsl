// SPDX-License-Identifier: Apache-2.0
// The corners of triangles in the fan of a sonar, and what decides which beams and slices a triangle is for.

// Largest error of fast_azimuth().
CONSTANT float azimuth_error_rad = 2e-5F;
CONSTANT float half_turn = 3.14159265F;

// Angle of (x, y) from the x axis, towards y, in (-pi, pi]. Without branches, so that loops are vectorised.
SHARED float fast_azimuth(float y, float x) {
  float ax = x < 0.0F ? -x : x;
  float ay = y < 0.0F ? -y : y;
  float shorter = ax < ay ? ax : ay;
  float longer = ax < ay ? ay : ax;
  float q = shorter / (longer + 1e-30F);
  float q2 = q * q;
  // Abramowitz and Stegun 4.4.49: arctan on [0, 1].
  float angle =
      q * (0.9998660F + q2 * (-0.3302995F + q2 * (0.1801410F + q2 * (-0.0851330F + q2 * 0.0208351F))));
  angle = ax < ay ? 1.57079633F - angle : angle;
  angle = x < 0.0F ? half_turn - angle : angle;
  return y < 0.0F ? -angle : angle;
}

// p_sonar = R * p_part + t, row after row of R.
struct Placement {
  float xx, xy, xz, xt;
  float yx, yy, yz, yt;
  float zx, zy, zz, zt;
};

// `precise`: neighbouring clusters have their own copies of a vertex, which must stay in one place.
SHARED Corner place(Placement m, float x, float y, float z) {
  precise float px = m.xx * x + m.xy * y + m.xz * z + m.xt;
  precise float py = m.yx * x + m.yy * y + m.yz * z + m.yt;
  precise float pz = m.zx * x + m.zy * y + m.zz * z + m.zt;
  Corner placed;
  placed.x = px;
  placed.y = py;
  placed.z = pz;
  return placed;
}

// Directions of a corner from the sonar.
struct Sight {
  float azimuth;
  float horizontal_squared;
  float tangent;  // of the elevation
};

SHARED Sight sight_of(Corner p) {
  Sight sight;
  sight.azimuth = fast_azimuth(p.y, p.x);
  sight.horizontal_squared = p.x * p.x + p.y * p.y;
  sight.tangent = p.z / sqrt(sight.horizontal_squared + 1e-30F);
  return sight;
}

SHARED float least_of(float a, float b, float c) {
  float ab = a < b ? a : b;
  return ab < c ? ab : c;
}
SHARED float most_of(float a, float b, float c) {
  float ab = a > b ? a : b;
  return ab > c ? ab : c;
}

// The space in which a sonar sees (Fan).
struct FanSpace {
  float sampled_range_m;
  float sin_limit, cos_limit;                      // of the largest elevation
  int is_convex;                                   // 1: narrower than half a turn
  float port_x, port_y, starboard_x, starboard_y;  // horizontal unit normals of its sides, outwards
};

// Whether a sphere is wholly outside of the range, the elevation limits or the azimuths. False for some
// spheres that are just outside.
SHARED bool misses_fan(FanSpace fan, Corner centre, float radius_m) {
  const float slack = 1e-3F;  // radians; more than all rounding errors here
  float horizontal_m = sqrt(centre.x * centre.x + centre.y * centre.y);
  float distance_m = sqrt(horizontal_m * horizontal_m + centre.z * centre.z);
  float reach_m = radius_m + slack * distance_m;
  float port_m = centre.x * fan.port_x + centre.y * fan.port_y;
  float starboard_m = centre.x * fan.starboard_x + centre.y * fan.starboard_y;
  // A sphere beyond either side is outside a fan of up to half a turn; beyond both sides, outside a wider
  // one.
  float beside_m = fan.is_convex != 0 ? max(port_m, starboard_m) : min(port_m, starboard_m);
  return distance_m - radius_m > fan.sampled_range_m ||
         abs(centre.z) * fan.cos_limit - horizontal_m * fan.sin_limit > reach_m || beside_m > reach_m;
}

CONSTANT float thin_ratio = 3.0F;      // angular height over width
CONSTANT float least_upright = 0.02F;  // of the tangent of the fan's limit; lower edges have little effect

// Constants of a ping.
struct FanLimits {
  float tan_limit;    // tangent of the largest elevation
  float upright_rad;  // an edge whose azimuth changes by less runs along slices
};

// Numbers are 0 or 1.
struct TriangleBounds {
  int in_elevation;
  int thin;     // much taller than wide, as seen from the sonar: the leg of a frame
  int upright;  // has an edge that runs along slices
  float low_azimuth, high_azimuth;
};

SHARED bool is_upright(float lean, float rise, FanLimits fan) {
  float least_rise = least_upright * fan.tan_limit;
  return both(both(lean<fan.upright_rad, lean> - fan.upright_rad), (rise < 0.0F ? -rise : rise) > least_rise);
}

SHARED TriangleBounds bounds_of_triangle(Sight a, Sight b, Sight c, float za, float zb, float zc,
                                         FanLimits fan) {
  // The farthest corner has the most height within the elevation limits.
  float room = most_of(a.horizontal_squared, b.horizontal_squared, c.horizontal_squared) *
               (fan.tan_limit * fan.tan_limit);
  float bottom = least_of(za, zb, zc), top = most_of(za, zb, zc);
  int above = both(bottom > 0.0F, bottom * bottom > room) ? 1 : 0;
  int below = both(top<0.0F, top * top> room) ? 1 : 0;
  TriangleBounds bounds;
  bounds.in_elevation = 1 - above - below;
  bounds.low_azimuth = least_of(a.azimuth, b.azimuth, c.azimuth);
  bounds.high_azimuth = most_of(a.azimuth, b.azimuth, c.azimuth);
  float tall = most_of(a.tangent, b.tangent, c.tangent) - least_of(a.tangent, b.tangent, c.tangent);
  bounds.thin = tall > thin_ratio * (bounds.high_azimuth - bounds.low_azimuth) ? 1 : 0;
  int upright = (is_upright(a.azimuth - b.azimuth, a.tangent - b.tangent, fan) ? 1 : 0) +
                (is_upright(b.azimuth - c.azimuth, b.tangent - c.tangent, fan) ? 1 : 0) +
                (is_upright(c.azimuth - a.azimuth, c.tangent - a.tangent, fan) ? 1 : 0);
  bounds.upright = upright > 0 ? 1 : 0;
  return bounds;
}

// Whether a triangle turns its inner side to the sonar, by more than rounding can change.
// outwards: 1 if the winding's normals point to the outer side, -1 if to the inner side, 0 if either side may
// be seen
SHARED bool is_turned_away(Corner a, Corner b, Corner c, float outwards) {
  const float least_sine = 1e-5F;
  float bx = b.x - a.x, by = b.y - a.y, bz = b.z - a.z;
  float cx = c.x - a.x, cy = c.y - a.y, cz = c.z - a.z;
  float nx = by * cz - cy * bz, ny = bz * cx - cz * bx, nz = bx * cy - cx * by;
  float away = outwards * (nx * a.x + ny * a.y + nz * a.z);
  return both(away > 0.0F, away * away > least_sine * least_sine * (nx * nx + ny * ny + nz * nz) *
                                             (a.x * a.x + a.y * a.y + a.z * a.z));
}
