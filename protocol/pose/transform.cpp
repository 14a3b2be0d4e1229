// SPDX-License-Identifier: Apache-2.0
#include "protocol/pose/transform.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::pose {

Vec3 operator+(const Vec3& a, const Vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Vec3 operator-(const Vec3& a, const Vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Vec3 operator*(double factor, const Vec3& v) {
  return {factor * v.x, factor * v.y, factor * v.z};
}

Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

double norm(const Vec3& v) {
  return std::hypot(v.x, v.y, v.z);
}

Quat operator*(const Quat& a, const Quat& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quat conjugate(const Quat& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

double norm(const Quat& q) {
  return std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
}

Quat normalized(const Quat& q) {
  const double scale = 1.0 / norm(q);
  return {scale * q.w, scale * q.x, scale * q.y, scale * q.z};
}

Vec3 rotate(const Quat& q, const Vec3& v) {
  const Vec3 axis{q.x, q.y, q.z};
  const Vec3 twice = 2.0 * cross(axis, v);
  return v + q.w * twice + cross(axis, twice);
}

Quat from_rotation_vector(const Vec3& v) {
  const double angle_rad = norm(v);
  // sin(a/2)/a; for small angles by its series, because the quotient loses digits.
  const double scale =
      angle_rad < 1e-4 ? 0.5 - angle_rad * angle_rad / 48.0 : std::sin(0.5 * angle_rad) / angle_rad;
  return {std::cos(0.5 * angle_rad), scale * v.x, scale * v.y, scale * v.z};
}

Vec3 to_rotation_vector(const Quat& q) {
  const double sign = q.w < 0.0 ? -1.0 : 1.0;
  const Vec3 axis{sign * q.x, sign * q.y, sign * q.z};
  const double sine = norm(axis);
  const double scale = sine < 1e-12 ? 2.0 : 2.0 * std::atan2(sine, sign * q.w) / sine;
  return scale * axis;
}

Transform interpolate(const Transform& from, const Transform& to, double fraction) {
  if (from == to) {
    return from;
  }
  const Vec3 turn = to_rotation_vector(conjugate(from.orientation) * to.orientation);
  return {from.position_m + fraction * (to.position_m - from.position_m),
          normalized(from.orientation * from_rotation_vector(fraction * turn))};
}

Transform advance(const Transform& T_world_body, const Velocity& twist, double seconds) {
  const Vec3 turn = seconds * twist.angular_radps;
  const Vec3 step = seconds * twist.linear_mps;
  if (turn == Vec3{} && step == Vec3{}) {
    return T_world_body;
  }
  const double angle_rad = norm(turn);
  const double angle2 = angle_rad * angle_rad;
  // Exponential map of SE(3): the body turns while it moves, so its path is the integral of exp(s turn) step
  // over s in [0, 1] = step + a turn x step + b turn x (turn x step). Small angles use the series, because
  // the quotients lose digits.
  const bool small = angle_rad < 1e-3;
  const double a = small ? 0.5 - angle2 / 24.0 : (1.0 - std::cos(angle_rad)) / angle2;
  const double b =
      small ? 1.0 / 6.0 - angle2 / 120.0 : (angle_rad - std::sin(angle_rad)) / (angle2 * angle_rad);
  const Vec3 side = cross(turn, step);
  const Vec3 path = step + a * side + b * cross(turn, side);
  return {T_world_body.position_m + rotate(T_world_body.orientation, path),
          normalized(T_world_body.orientation * from_rotation_vector(turn))};
}

Transform enu_flu_from_ned_frd(const Transform& T_ned_frd) {
  // Half a turn about the axis between north and east swaps them and reverses down.
  static const double half = std::sqrt(0.5);
  const Quat q_enu_ned{0.0, half, half, 0.0};
  // Half a turn about forward reverses right and down.
  const Quat q_frd_flu{0.0, 1.0, 0.0, 0.0};
  const Vec3& p = T_ned_frd.position_m;
  return {{p.y, p.x, -p.z}, normalized(q_enu_ned * T_ned_frd.orientation * q_frd_flu)};
}

Velocity flu_from_frd(const Velocity& twist_frd) {
  const auto turned = [](const Vec3& v) { return Vec3{v.x, -v.y, -v.z}; };
  return {turned(twist_frd.linear_mps), turned(twist_frd.angular_radps)};
}

TransformFault normalize(Transform& transform) {
  const Vec3& p = transform.position_m;
  const Quat& q = transform.orientation;
  if (!is_finite(p)) {
    return TransformFault::position_not_finite;
  }
  if (std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) > max_coordinate_m) {
    return TransformFault::position_too_large;
  }
  if (!std::isfinite(q.w) || !is_finite({q.x, q.y, q.z})) {
    return TransformFault::orientation_not_finite;
  }
  const double length = norm(q);  // 0 or infinite if the squares leave the range of double
  if (length < min_quaternion_norm || length > max_quaternion_norm) {
    return TransformFault::orientation_norm;
  }
  transform.orientation = normalized(q);
  return TransformFault::none;
}

const char* describe(TransformFault fault) {
  switch (fault) {
    case TransformFault::none:
      return "no fault";
    case TransformFault::position_not_finite:
      return "position is not finite";
    case TransformFault::position_too_large:
      return "position is beyond 1e8 m";
    case TransformFault::orientation_not_finite:
      return "orientation is not finite";
    case TransformFault::orientation_norm:
      return "orientation has a norm outside 0.001..1000, so it is not a rotation";
  }
  return "unknown fault";
}

bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

}  // namespace sonard::pose
