// SPDX-License-Identifier: Apache-2.0
// The known messages with id, checksum seed and length, from the definitions in minimal.xml (HEARTBEAT) and
// common.xml (the others) of the MAVLink project.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace sonard::mavlink {

enum class MessageId : std::uint32_t {
  heartbeat = 0,
  attitude = 30,
  attitude_quaternion = 31,
  local_position_ned = 32,
  global_position_int = 33,
  odometry = 331,
};

struct MessageKind {
  MessageId id;
  std::uint8_t seed;      ///< CRC_EXTRA
  std::size_t base_size;  ///< size of the payload without extension fields, as in version 1
};

inline constexpr std::array<MessageKind, 6> message_kinds{{
    {MessageId::heartbeat, 50, 9},
    {MessageId::attitude, 39, 28},
    {MessageId::attitude_quaternion, 246, 32},
    {MessageId::local_position_ned, 185, 28},
    {MessageId::global_position_int, 104, 28},
    {MessageId::odometry, 91, 230},
}};

/// The kind of a message id; nullptr if it is unknown.
constexpr const MessageKind* kind_of(std::uint32_t id) {
  for (const MessageKind& kind : message_kinds) {
    if (static_cast<std::uint32_t>(kind.id) == id) {
      return &kind;
    }
  }
  return nullptr;
}

}  // namespace sonard::mavlink
