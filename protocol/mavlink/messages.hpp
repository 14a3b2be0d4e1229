// SPDX-License-Identifier: Apache-2.0
// The messages about a vehicle's pose, as defined in common.xml of the MAVLink project. Fields keep their
// names and frames; docs/frames-and-units.md describes the conversion.
#pragma once

#include <array>
#include <cstdint>
#include <variant>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/mavlink/frames.hpp"

namespace sonard::mavlink {

/// The values of MAV_FRAME for odometry.
enum class MavFrame : std::uint8_t {
  local_ned = 1,   ///< north, east, down from a fixed point
  body_ned = 8,    ///< for velocities: the axes of the vehicle (older name of body_frd)
  body_frd = 12,   ///< forward, right, down: the axes of the vehicle
  local_frd = 20,  ///< level, fixed to the earth, x in any direction, for example the initial heading
};

/// ATTITUDE (30). Rotates NED to the vehicle by yaw, then pitch, then roll. Radians, and radians per second
/// about the vehicle's axes (forward, right, down).
struct Attitude {
  std::uint32_t time_boot_ms = 0;
  float roll = 0.0F;
  float pitch = 0.0F;
  float yaw = 0.0F;
  float rollspeed = 0.0F;
  float pitchspeed = 0.0F;
  float yawspeed = 0.0F;

  bool operator==(const Attitude&) const = default;
};

/// ATTITUDE_QUATERNION (31). Maps FRD coordinates to NED; q1 is the real part. The extension repr_offset_q,
/// which is for displays, is not read.
struct AttitudeQuaternion {
  std::uint32_t time_boot_ms = 0;
  float q1 = 1.0F;
  float q2 = 0.0F;
  float q3 = 0.0F;
  float q4 = 0.0F;
  float rollspeed = 0.0F;
  float pitchspeed = 0.0F;
  float yawspeed = 0.0F;

  bool operator==(const AttitudeQuaternion&) const = default;
};

/// LOCAL_POSITION_NED (32). Metres and metres per second, north, east, down.
struct LocalPositionNed {
  std::uint32_t time_boot_ms = 0;
  float x = 0.0F;
  float y = 0.0F;
  float z = 0.0F;
  float vx = 0.0F;
  float vy = 0.0F;
  float vz = 0.0F;

  bool operator==(const LocalPositionNed&) const = default;
};

/// GLOBAL_POSITION_INT (33), without hdg, because the attitude is more accurate.
struct GlobalPositionInt {
  std::uint32_t time_boot_ms = 0;
  std::int32_t lat = 0;           ///< 1e-7 degrees
  std::int32_t lon = 0;           ///< 1e-7 degrees
  std::int32_t alt = 0;           ///< above mean sea level, millimetres
  std::int16_t vx = 0;            ///< north, cm/s
  std::int16_t vy = 0;            ///< east, cm/s
  std::int16_t vz = 0;            ///< down, cm/s
  std::int32_t relative_alt = 0;  ///< above home, millimetres

  bool operator==(const GlobalPositionInt&) const = default;
};

/// ODOMETRY (331), without covariances and extensions. `q` (w, x, y, z) maps vehicle coordinates to
/// `frame_id`. Velocities are in the axes of `child_frame_id`, turn rates about the axes of the vehicle.
/// Unknown values are NaN.
struct Odometry {
  std::uint64_t time_usec = 0;  ///< since boot, or Unix time
  float x = 0.0F;
  float y = 0.0F;
  float z = 0.0F;
  std::array<float, 4> q{1.0F, 0.0F, 0.0F, 0.0F};
  float vx = 0.0F;
  float vy = 0.0F;
  float vz = 0.0F;
  float rollspeed = 0.0F;
  float pitchspeed = 0.0F;
  float yawspeed = 0.0F;
  MavFrame frame_id = MavFrame::local_ned;       ///< any byte
  MavFrame child_frame_id = MavFrame::body_frd;  ///< any byte

  bool operator==(const Odometry&) const = default;
};

/// monostate: a message without information about a pose.
using Message =
    std::variant<std::monostate, Attitude, AttitudeQuaternion, LocalPositionNed, GlobalPositionInt, Odometry>;

/// Decodes a frame from FrameReader. Restores the zeros that version 2 cuts off and ignores extension fields.
/// Returns an error only if a frame of version 1 is shorter than its message.
Result<Message, WireError> decode(const Frame& frame);

}  // namespace sonard::mavlink
