// SPDX-License-Identifier: Apache-2.0
// Poses as the daemon gives them: {position_m: [x, y, z], orientation_wxyz: [w, x, y, z]}, z up; a sonar looks along x
// with y to port.

/** Turns a vector by a unit quaternion. */
export function rotate([w, x, y, z], [a, b, c]) {
  const tx = 2 * (y * c - z * b);
  const ty = 2 * (z * a - x * c);
  const tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}

/** Where a point of the pose's own frame lies in the world. */
export function place(pose, point) {
  return rotate(pose.orientation_wxyz, point).map((value, axis) => value + pose.position_m[axis]);
}

/** A point at a range, bearing (positive to starboard) and elevation in the frame of a sonar. */
export function towards(range_m, bearing_rad, elevation_rad) {
  const level = range_m * Math.cos(elevation_rad);
  return [level * Math.cos(bearing_rad), -level * Math.sin(bearing_rad), range_m * Math.sin(elevation_rad)];
}

/** Roll, pitch and yaw in radians; yaw counter-clockwise from x, which is east. */
export function angles([w, x, y, z]) {
  return [
    Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
    Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x)))),
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
  ];
}
