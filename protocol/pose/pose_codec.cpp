// SPDX-License-Identifier: Apache-2.0
#include "protocol/pose/pose_codec.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "protocol/common/quiet_protobuf.hpp"
#include "protocol/pose/pose_message.hpp"

namespace sonard::pose {
namespace {

using Kind = PoseError::Kind;

Vec3 read(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// Checks a pose of a message and converts it to enu_flu.
Result<Transform, PoseError> read(const Pose& message, Axes axes, std::string_view field) {
  Transform transform;
  const TransformFault fault = pose::read(message, transform);
  if (fault != TransformFault::none) {
    return PoseError{Kind::bad_value, field, describe(fault)};
  }
  return axes == Axes::ned_frd ? enu_flu_from_ned_frd(transform) : transform;
}

bool is_speed(const Vec3& v) {
  return is_finite(v) && std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}) <= max_speed;
}

Result<Velocity, PoseError> read(const Twist& message, Axes axes, std::string_view field) {
  const Velocity twist{read(message.linear_mps()), read(message.angular_radps())};
  if (!is_speed(twist.linear_mps) || !is_speed(twist.angular_radps)) {
    return PoseError{Kind::bad_value, field, "is not finite or beyond 1e6"};
  }
  return axes == Axes::ned_frd ? flu_from_frd(twist) : twist;
}

/// Fills `sample.bodies`. @return the first error, or nullopt.
std::optional<PoseError> read_bodies(const PoseUpdate& update, Axes axes, PoseSample& sample) {
  std::unordered_set<std::string_view> names;
  for (const BodyPose& body : update.bodies()) {
    if (body.name().empty()) {
      return PoseError{Kind::bad_value, "bodies.name", "is empty"};
    }
    if (!names.insert(body.name()).second) {
      return PoseError{Kind::bad_value, "bodies.name", "appears twice in one message"};
    }
    const auto transform = read(body.pose(), axes, "bodies.pose");
    if (!transform) {
      return transform.error();
    }
    sample.bodies.push_back({body.name(), *transform});
    if (body.has_twist()) {
      const auto twist = read(body.twist(), axes, "bodies.twist");
      if (!twist) {
        return twist.error();
      }
      sample.bodies.back().twist = *twist;
    }
  }
  return std::nullopt;
}

void write(const Vec3& v, Vector3& message) {
  message.set_x(v.x);
  message.set_y(v.y);
  message.set_z(v.z);
}

void write(const Velocity& twist, Twist& message) {
  write(twist.linear_mps, *message.mutable_linear_mps());
  write(twist.angular_radps, *message.mutable_angular_radps());
}

/// Value and length of the varint at the front of a buffer. length 0: incomplete; -1: longer than any
/// accepted length prefix.
struct LengthPrefix {
  std::size_t value = 0;
  std::ptrdiff_t length = 0;
};

LengthPrefix read_length(std::span<const std::uint8_t> buffer) {
  // Three bytes hold 2^21 - 1, more than max_message_bytes.
  constexpr std::size_t longest = max_frame_bytes - max_message_bytes;
  std::size_t value = 0;
  for (std::size_t i = 0; i < std::min(buffer.size(), longest); ++i) {
    value |= static_cast<std::size_t>(buffer[i] & 0x7F) << (7 * i);
    if ((buffer[i] & 0x80) == 0) {
      return {value, static_cast<std::ptrdiff_t>(i + 1)};
    }
  }
  return {0, buffer.size() < longest ? 0 : -1};
}

}  // namespace

std::string to_string(const PoseError& error) {
  std::string text{error.field};
  text += ": ";
  text += error.problem;
  return text;
}

Result<PoseSample, PoseError> decode(std::span<const std::uint8_t> message) {
  PoseUpdate update;
  if (message.size() > max_message_bytes) {
    return PoseError{Kind::malformed, "message", "is longer than 65507 bytes"};
  }
  keep_protobuf_quiet();
  if (!update.ParseFromArray(message.data(), static_cast<int>(message.size()))) {
    return PoseError{Kind::malformed, "message", "is not a PoseUpdate (pose.proto)"};
  }
  if (update.frame() != FRAME_ENU_FLU && update.frame() != FRAME_NED_FRD) {
    return PoseError{Kind::bad_value, "frame", "is neither FRAME_ENU_FLU nor FRAME_NED_FRD"};
  }
  const Axes axes = update.frame() == FRAME_NED_FRD ? Axes::ned_frd : Axes::enu_flu;
  if (update.time_ns() > max_time_ns || update.time_ns() < -max_time_ns) {
    return PoseError{Kind::bad_value, "time_ns", "is beyond 4e18"};
  }
  if (!update.has_vehicle()) {
    return PoseError{Kind::bad_value, "vehicle", "is missing"};
  }
  PoseSample sample;
  sample.time_ns = update.time_ns();
  const auto vehicle = read(update.vehicle(), axes, "vehicle");
  if (!vehicle) {
    return vehicle.error();
  }
  sample.T_world_vehicle = *vehicle;
  if (update.has_twist()) {
    const auto twist = read(update.twist(), axes, "twist");
    if (!twist) {
      return twist.error();
    }
    sample.twist = *twist;
  }
  if (const auto error = read_bodies(update, axes, sample)) {
    return *error;
  }
  return sample;
}

std::vector<std::uint8_t> encode(const PoseSample& sample) {
  keep_protobuf_quiet();
  PoseUpdate update;
  update.set_time_ns(sample.time_ns);
  update.set_frame(FRAME_ENU_FLU);
  pose::write(sample.T_world_vehicle, *update.mutable_vehicle());
  if (sample.twist) {
    write(*sample.twist, *update.mutable_twist());
  }
  for (const NamedTransform& body : sample.bodies) {
    BodyPose& message = *update.add_bodies();
    message.set_name(body.name);
    pose::write(body.T_world_body, *message.mutable_pose());
    if (body.twist) {
      write(*body.twist, *message.mutable_twist());
    }
  }
  std::vector<std::uint8_t> bytes(update.ByteSizeLong());
  update.SerializeToArray(bytes.data(), static_cast<int>(bytes.size()));
  return bytes;
}

std::vector<std::uint8_t> encode_frame(const PoseSample& sample) {
  const std::vector<std::uint8_t> message = encode(sample);
  std::vector<std::uint8_t> frame;
  std::size_t rest = message.size();
  for (; rest >= 0x80; rest >>= 7) {
    frame.push_back(static_cast<std::uint8_t>(rest | 0x80));
  }
  frame.push_back(static_cast<std::uint8_t>(rest));
  frame.insert(frame.end(), message.begin(), message.end());
  return frame;
}

std::ptrdiff_t next_frame(std::span<const std::uint8_t> buffer) {
  const LengthPrefix prefix = read_length(buffer);
  if (prefix.length < 0 || prefix.value > max_message_bytes) {
    return -static_cast<std::ptrdiff_t>(buffer.size());
  }
  const std::size_t frame_bytes = static_cast<std::size_t>(prefix.length) + prefix.value;
  return prefix.length == 0 || buffer.size() < frame_bytes ? 0 : static_cast<std::ptrdiff_t>(frame_bytes);
}

std::span<const std::uint8_t> frame_message(std::span<const std::uint8_t> frame) {
  return frame.subspan(static_cast<std::size_t>(read_length(frame).length));
}

}  // namespace sonard::pose
