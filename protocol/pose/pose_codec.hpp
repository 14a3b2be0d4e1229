// SPDX-License-Identifier: Apache-2.0
// The native pose stream: bytes <-> PoseSample. The message is protocol/pose/pose.proto; docs/poses.md tells
// publishers about it.
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

/// Axes a publisher may speak in. Inside, everything is enu_flu (docs/frames-and-units.md).
enum class Axes { enu_flu, ned_frd };

/// A body of the world, by its name there.
struct NamedTransform {
  std::string name;
  Transform T_world_body;
};

/// What a publisher said at one instant. World axes east, north, up; vehicle axes forward, left, up.
/// Quaternions have norm 1 and every number is finite: decode() has checked.
struct PoseSample {
  std::int64_t time_ns = 0;  ///< on the publisher's clock; |time_ns| <= max_time_ns
  Transform T_world_vehicle;
  std::optional<Velocity> twist;       ///< of the vehicle relative to the world, in the vehicle's axes
  std::vector<NamedTransform> bodies;  ///< names are not empty and unique
};

/// Leaves room to subtract any two time stamps, and one of them from a time of ours, in 64 bits.
inline constexpr std::int64_t max_time_ns = 4'000'000'000'000'000'000;
/// Metres per second and radians per second; more is a unit mistake, and would overflow sooner or later.
inline constexpr double max_speed = 1e6;
/// Length limit of an encoded message: what fits a UDP datagram, so that both transports carry the same
/// messages.
inline constexpr std::size_t max_message_bytes = 65'507;

/// Why bytes are no pose. Both views are string literals.
struct PoseError {
  enum class Kind {
    malformed,  ///< no message of pose.proto: a stream that sends this has lost its framing, or is no pose
                ///< stream
    bad_value,  ///< a message with a value that means nothing; the next one may be good
  };
  Kind kind = Kind::malformed;
  std::string_view field;    ///< "vehicle", "bodies.pose", ...
  std::string_view problem;  ///< "orientation is not finite", ...
};

/// One line, for example "vehicle: orientation is not finite".
std::string to_string(const PoseError& error);

/// A message without framing, as in a UDP datagram. Converted to enu_flu; never throws.
Result<PoseSample, PoseError> decode(std::span<const std::uint8_t> message);

/// Encodes a sample, always in enu_flu.
std::vector<std::uint8_t> encode(const PoseSample& sample);
/// encode() behind its length as a varint: one frame of the TCP stream.
std::vector<std::uint8_t> encode_frame(const PoseSample& sample);

/// Framing of the TCP stream. Looks at the front of `buffer`:
/// @return n > 0: a frame of n bytes (length and message) starts here; n < 0: drop -n bytes, they are no
/// frame (a length that is no varint or beyond max_message_bytes; there is no way to find the next frame in
/// such a stream, so all bytes go); 0: the frame is not complete yet.
std::ptrdiff_t next_frame(std::span<const std::uint8_t> buffer);
/// The message inside a frame that next_frame() has found.
std::span<const std::uint8_t> frame_message(std::span<const std::uint8_t> frame);

/// Most bytes a receiver must hold to see a whole frame.
inline constexpr std::size_t max_frame_bytes = max_message_bytes + 3;

}  // namespace sonard::pose
