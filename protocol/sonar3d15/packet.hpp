// SPDX-License-Identifier: Apache-2.0
// The frame of a message: id, length, payload, checksum. Source: protocol/sonar3d15/README.md 1. No state;
// any thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"

namespace sonard::sonar3d15 {

/// First four bytes of a packet, as a little-endian integer.
enum class PacketId : std::uint32_t {
  rip1 = 0x31504952,  ///< "RIP1": the payload is the message
  rip2 = 0x32504952,  ///< "RIP2": the payload is the message as a raw block of Snappy
};

struct PacketHeader {
  PacketId id = PacketId::rip2;
  std::uint32_t length = 0;  ///< of the whole packet
};

inline constexpr std::size_t packet_header_size = 8;
inline constexpr std::size_t checksum_size = 4;
inline constexpr std::size_t most_packet_size = 65'507;  ///< payload of a UDP datagram

/// Frames a message. The result may be longer than most_packet_size, which no client accepts.
std::vector<std::uint8_t> pack(std::span<const std::uint8_t> message, PacketId id);

/// The packet at the front of `bytes`, with its frame; other bytes may follow. An error if the id is unknown,
/// the length is invalid or beyond `bytes`, or the checksum is wrong.
Result<std::span<const std::uint8_t>, WireError> front_packet(std::span<const std::uint8_t> bytes);

/// The message in a packet, which must fill `packet`.
Result<std::vector<std::uint8_t>, WireError> unpack(std::span<const std::uint8_t> packet);

}  // namespace sonard::sonar3d15
