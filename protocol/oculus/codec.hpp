// SPDX-License-Identifier: Apache-2.0
// Bytes <-> messages of an Oculus. Source: protocol/oculus/README.md. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/oculus/messages.hpp"

namespace sonard::oculus {

/// The identity of a head in the headers of all its messages, including the status (1).
struct Identity {
  std::uint16_t device_id = 0;  ///< not 0
  std::uint16_t part_number = 0;
};

/// Decodes a command, as returned by CommandBuffer. A fire has version 2 if it is long enough for it,
/// whatever its header states (3.1). Ignores bytes after a message. Returns Unknown for other messages.
Result<Command, WireError> decode_command(std::span<const std::uint8_t> message);

/// Encodes a command as a client sends it, with its length in the header.
std::vector<std::uint8_t> encode(const SimpleFire& fire);
std::vector<std::uint8_t> encode(const UserConfig& config);

/// Encodes a message as a head sends it.
std::vector<std::uint8_t> encode(const UserConfig& config, const Identity& identity);
std::vector<std::uint8_t> encode(const Status& status, const Identity& identity);
/// Requires `image_offset` after the bearings; the bytes between are 0. Derives counts and sizes from the
/// bearings and image, not from the members of `ping`.
std::vector<std::uint8_t> encode(const PingResult& ping, const Identity& identity);
std::vector<std::uint8_t> encode_dummy(const Identity& identity);
std::vector<std::uint8_t> encode_log(std::string_view text, const Identity& identity);

/// Decodes a ping as a client. PingResult::image views `message`. Rejects inconsistent sizes (4.3).
Result<PingResult, WireError> decode_ping_result(std::span<const std::uint8_t> message);
/// Decodes a ping without its image; the message may end after the bearings.
Result<PingResult, WireError> decode_ping_head(std::span<const std::uint8_t> message);
Result<Status, WireError> decode_status(std::span<const std::uint8_t> datagram);

}  // namespace sonard::oculus
