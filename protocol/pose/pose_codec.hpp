// SPDX-License-Identifier: Apache-2.0
// The native pose stream: bytes <-> PoseSample. The message is protocol/pose/pose.proto; docs/poses.md is the
// guide for publishers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/pose/transform.hpp"

namespace sonard::pose {

/// Axes that a publisher may use. Internally everything is enu_flu (docs/frames-and-units.md).
enum class Axes { enu_flu, ned_frd };

/// A body of the world, with its name in the world.
struct NamedTransform {
  std::string name;
  Transform T_world_body;
  std::optional<Velocity> twist = std::nullopt;  ///< relative to the world, in the body's axes
};

/// One message of a publisher. World axes east, north, up; vehicle axes forward, left, up. decode() ensures
/// that quaternions have norm 1 and all numbers are finite.
struct PoseSample {
  std::int64_t time_ns = 0;  ///< on the publisher's clock; |time_ns| <= max_time_ns
  Transform T_world_vehicle;
  std::optional<Velocity> twist;       ///< of the vehicle relative to the world, in the vehicle's axes
  std::vector<NamedTransform> bodies;  ///< with unique, non-empty names
};

/// With this limit, differences between time stamps, and between a time stamp and our time, fit in 64 bits.
inline constexpr std::int64_t max_time_ns = 4'000'000'000'000'000'000;
/// Metres per second and radians per second. Larger values are a unit mistake and could overflow.
inline constexpr double max_speed = 1e6;
/// Length limit of an encoded message: the maximum in a UDP datagram, so that both transports allow the same
/// messages.
inline constexpr std::size_t max_message_bytes = 65'507;

/// Why bytes are not a pose. Both views are string literals.
struct PoseError {
  enum class Kind {
    malformed,  ///< not a message of pose.proto: the stream has lost its framing, or is not a pose
                ///< stream
    bad_value,  ///< a message with an invalid value; the next one may be good
  };
  Kind kind = Kind::malformed;
  std::string_view field;    ///< "vehicle", "bodies.pose", ...
  std::string_view problem;  ///< "orientation is not finite", ...
};

/// One line, for example "vehicle: orientation is not finite".
std::string to_string(const PoseError& error);

/// Decodes a message without framing, as in a UDP datagram, and converts it to enu_flu. Never throws.
Result<PoseSample, PoseError> decode(std::span<const std::uint8_t> message);

/// Encodes a sample, always in enu_flu.
std::vector<std::uint8_t> encode(const PoseSample& sample);
/// One frame of the TCP stream: the length as a varint, then the bytes of encode().
std::vector<std::uint8_t> encode_frame(const PoseSample& sample);

/// Finds a frame of the TCP stream at the front of `buffer`.
/// @return n > 0: a frame of n bytes (length and message) starts here; n < 0: drop -n bytes, because the
/// length is not a varint or exceeds max_message_bytes (then all bytes, because the next frame cannot be
/// found); 0: the frame is incomplete.
std::ptrdiff_t next_frame(std::span<const std::uint8_t> buffer);
/// The message in a frame that next_frame() has found.
std::span<const std::uint8_t> frame_message(std::span<const std::uint8_t> frame);

/// Maximum size of a frame, which a receiver must be able to hold.
inline constexpr std::size_t max_frame_bytes = max_message_bytes + 3;

}  // namespace sonard::pose
