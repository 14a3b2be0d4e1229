// SPDX-License-Identifier: Apache-2.0
// Rigid motion in double precision, as plain values: what a pose stream and a trajectory are made of.
#pragma once

namespace sonard::pose {

struct Vec3 {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  bool operator==(const Vec3&) const = default;
};

Vec3 operator+(const Vec3& a, const Vec3& b);
Vec3 operator-(const Vec3& a, const Vec3& b);
Vec3 operator*(double factor, const Vec3& v);
Vec3 cross(const Vec3& a, const Vec3& b);
double norm(const Vec3& v);

/// Hamilton quaternion. A rotation when its norm is 1, which every function below takes for granted.
struct Quat {
  double w = 1.0;
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;

  bool operator==(const Quat&) const = default;
};

Quat operator*(const Quat& a, const Quat& b);
Quat conjugate(const Quat& q);
double norm(const Quat& q);
/// `q` scaled to norm 1, which it must not be far from.
Quat normalized(const Quat& q);
Vec3 rotate(const Quat& q, const Vec3& v);

/// Rotation by |v| radians about v.
Quat from_rotation_vector(const Vec3& v);
/// The rotation vector of `q`, the short way round: its length is at most pi, and q and -q give the same one.
Vec3 to_rotation_vector(const Quat& q);

/// T_a_b: maps coordinates of frame b to frame a; the position is the origin of b in a.
struct Transform {
  Vec3 position_m;
  Quat orientation;

  bool operator==(const Transform&) const = default;
};

/// Twist of frame b relative to frame a, in the axes of b.
struct Velocity {
  Vec3 linear_mps;
  Vec3 angular_radps;
};

/// Position on the straight line, orientation on the shortest arc. `fraction` in [0, 1]. What rests keeps
/// every bit, so that comparing poses shows it at rest.
Transform interpolate(const Transform& from, const Transform& to, double fraction);

/// Where a body is after moving with a constant twist for `seconds` (which may be negative): a helix. A twist
/// of zero keeps every bit.
Transform advance(const Transform& T_world_body, const Velocity& twist, double seconds);

/// T_enu_flu of a pose given as T_ned_frd: world axes (north, east, down) become (east, north, up), body
/// axes (forward, right, down) become (forward, left, up).
Transform enu_flu_from_ned_frd(const Transform& T_ned_frd);
/// Converts a twist from axes (forward, right, down) to axes (forward, left, up).
Velocity flu_from_frd(const Velocity& twist_frd);

/// Why a transform from outside was refused; `none` when it was not.
enum class TransformFault {
  none,
  position_not_finite,
  position_too_large,  ///< a coordinate beyond max_coordinate_m
  orientation_not_finite,
  orientation_norm,  ///< outside [min_quaternion_norm, max_quaternion_norm]: no rotation was meant
};

/// Earth-centred coordinates fit, and double still resolves 15 nm.
inline constexpr double max_coordinate_m = 1e8;
inline constexpr double min_quaternion_norm = 1e-3;
inline constexpr double max_quaternion_norm = 1e3;

/// Checks a transform from outside and scales its quaternion to norm 1. Unchanged on a fault.
TransformFault normalize(Transform& transform);
/// "position is not finite" and so on.
const char* describe(TransformFault fault);
bool is_finite(const Vec3& v);

}  // namespace sonard::pose
