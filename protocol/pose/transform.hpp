// SPDX-License-Identifier: Apache-2.0
// Rigid motion in double precision, as plain values, for pose streams and trajectories.
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

/// Hamilton quaternion. It is a rotation if its norm is 1, which the rotation functions below require.
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
/// `q` scaled to norm 1. Its norm must not be 0 or infinite.
Quat normalized(const Quat& q);
Vec3 rotate(const Quat& q, const Vec3& v);

/// Rotation by |v| radians about v.
Quat from_rotation_vector(const Vec3& v);
/// The shortest rotation vector of `q`: its length is at most pi; q and -q give equal vectors.
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

/// Interpolates position on the straight line and orientation on the shortest arc, `fraction` in [0, 1].
/// Equal transforms give a bit-identical result, so that a comparison of poses detects a body at rest.
Transform interpolate(const Transform& from, const Transform& to, double fraction);

/// The pose of a body after moving with a constant twist for `seconds` (may be negative) along a helix. With
/// a twist of zero the result is bit-identical.
Transform advance(const Transform& T_world_body, const Velocity& twist, double seconds);

/// Converts a pose from T_ned_frd to T_enu_flu: world axes (north, east, down) become (east, north, up), body
/// axes (forward, right, down) become (forward, left, up).
Transform enu_flu_from_ned_frd(const Transform& T_ned_frd);
/// Converts a twist from axes (forward, right, down) to axes (forward, left, up).
Velocity flu_from_frd(const Velocity& twist_frd);

/// Why a transform from outside was rejected; `none` if it is valid.
enum class TransformFault {
  none,
  position_not_finite,
  position_too_large,  ///< a coordinate beyond max_coordinate_m
  orientation_not_finite,
  orientation_norm,  ///< norm outside [min_quaternion_norm, max_quaternion_norm]
};

/// Large enough for earth-centred coordinates; double still resolves 15 nm.
inline constexpr double max_coordinate_m = 1e8;
inline constexpr double min_quaternion_norm = 1e-3;
inline constexpr double max_quaternion_norm = 1e3;

/// Checks a transform from outside and scales its quaternion to norm 1. On a fault it is unchanged.
TransformFault normalize(Transform& transform);
/// Text of a fault, for example "position is not finite".
const char* describe(TransformFault fault);
bool is_finite(const Vec3& v);

}  // namespace sonard::pose
