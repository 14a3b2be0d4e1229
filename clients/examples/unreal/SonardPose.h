// SPDX-License-Identifier: Apache-2.0
// Converts a pose in Unreal's axes to a message for sonard (protocol/pose/pose.proto), without protobuf or
// the engine. It accepts any types with the members of FVector and FQuat. SonardPublisher.h uses it.
//
// Unreal is left-handed: x forward, y right, z up, centimetres. The world's x is sent as east, so y is south.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace sonard_unreal {
// Mirroring y makes the axes right-handed: world x east, y north, z up; vehicle x forward, y to port, z up.
struct Vector {
  double x, y, z;
};
struct Rotation {
  double w, x, y, z;
};

template <class FVectorLike>
Vector Position(const FVectorLike& cm) {
  return {cm.X / 100, -cm.Y / 100, cm.Z / 100};
}

// In the vehicle's axes (FQuat::UnrotateVector), cm/s.
template <class FVectorLike>
Vector Velocity(const FVectorLike& cmPerSecond) {
  return Position(cmPerSecond);
}

// In the vehicle's axes, rad/s. Mirroring y also reverses rotations, so x and z change sign instead of y.
template <class FVectorLike>
Vector TurnRate(const FVectorLike& radPerSecond) {
  return {-radPerSecond.X, radPerSecond.Y, -radPerSecond.Z};
}

template <class FQuatLike>
Rotation Orientation(const FQuatLike& q) {
  return {q.W, -q.X, q.Y, -q.Z};
}

// ---- The message, in protobuf's encoding. Requires a little-endian machine; Unreal runs on no other.

inline void AppendVarint(std::string& bytes, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) {
    bytes += static_cast<char>(value | 0x80);
  }
  bytes += static_cast<char>(value);
}

inline void AppendDouble(std::string& bytes, int field, double value) {
  char raw[sizeof value];
  std::memcpy(raw, &value, sizeof value);
  AppendVarint(bytes, static_cast<unsigned>(field) << 3 | 1);
  bytes.append(raw, sizeof raw);
}

inline void AppendPart(std::string& bytes, int field, const std::string& part) {
  AppendVarint(bytes, static_cast<unsigned>(field) << 3 | 2);
  AppendVarint(bytes, part.size());
  bytes += part;
}

inline std::string Encode(const Vector& v) {
  std::string bytes;
  AppendDouble(bytes, 1, v.x);
  AppendDouble(bytes, 2, v.y);
  AppendDouble(bytes, 3, v.z);
  return bytes;
}

inline std::string Encode(const Rotation& q) {
  std::string bytes;
  AppendDouble(bytes, 1, q.w);
  AppendDouble(bytes, 2, q.x);
  AppendDouble(bytes, 3, q.y);
  AppendDouble(bytes, 4, q.z);
  return bytes;
}

inline std::string EncodePose(const Vector& position, const Rotation& orientation) {
  std::string pose;
  AppendPart(pose, 1, Encode(position));
  AppendPart(pose, 2, Encode(orientation));
  return pose;
}

inline std::string EncodeTwist(const Vector& velocity, const Vector& turnRate) {
  std::string twist;
  AppendPart(twist, 1, Encode(velocity));
  AppendPart(twist, 2, Encode(turnRate));
  return twist;
}

// A datagram. Results of EncodeBody() may be appended to it, for other moving objects.
inline std::string EncodeUpdate(double seconds, const Vector& position, const Rotation& orientation,
                                const Vector& velocity, const Vector& turnRate) {
  std::string update;
  AppendVarint(update, 1 << 3);  // time_ns
  AppendVarint(update, static_cast<std::uint64_t>(seconds * 1e9));
  AppendPart(update, 3, EncodePose(position, orientation));
  AppendPart(update, 4, EncodeTwist(velocity, turnRate));
  return update;
}

// Another moving object, by the name of its model in sonard's world. Velocity and turn rate are in its axes.
inline std::string EncodeBody(const std::string& name, const Vector& position, const Rotation& orientation,
                              const Vector& velocity, const Vector& turnRate) {
  std::string body;
  AppendPart(body, 1, name);
  AppendPart(body, 2, EncodePose(position, orientation));
  AppendPart(body, 3, EncodeTwist(velocity, turnRate));
  std::string field;
  AppendPart(field, 5, body);
  return field;
}
}  // namespace sonard_unreal
