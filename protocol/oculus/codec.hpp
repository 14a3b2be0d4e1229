// SPDX-License-Identifier: Apache-2.0
// Bytes <-> messages of an Oculus. Source: docs/protocols/oculus.md. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/oculus/messages.hpp"

namespace sonard::oculus {

/// How a head names itself in the header of all that it sends, the status too (1).
struct Identity {
  std::uint16_t device_id = 0;  ///< not 0
  std::uint16_t part_number = 0;
};

/// A command as CommandBuffer gives it. A fire is of version 2 where it is long enough for one, whatever its
/// header states (3.1); what is behind a message is ignored. Another message gives Unknown.
Result<Command, WireError> decode_command(std::span<const std::uint8_t> message);

/// A command as a client sends it that states its length.
std::vector<std::uint8_t> encode(const SimpleFire& fire);
std::vector<std::uint8_t> encode(const UserConfig& config);

/// As heads answer.
std::vector<std::uint8_t> encode(const UserConfig& config, const Identity& identity);
std::vector<std::uint8_t> encode(const Status& status, const Identity& identity);
/// Requires `image_offset` behind the bearings; bytes between are 0. Counts and sizes that `ping` states are
/// replaced by those of its bearings and image.
std::vector<std::uint8_t> encode(const PingResult& ping, const Identity& identity);
std::vector<std::uint8_t> encode_dummy(const Identity& identity);
std::vector<std::uint8_t> encode_log(std::string_view text, const Identity& identity);

/// What a client reads. PingResult::image views `message`. Refuses sizes that do not fit each other (4.3).
Result<PingResult, WireError> decode_ping_result(std::span<const std::uint8_t> message);
/// The same without the image, of a message that may end behind its bearings.
Result<PingResult, WireError> decode_ping_head(std::span<const std::uint8_t> message);
Result<Status, WireError> decode_status(std::span<const std::uint8_t> datagram);

}  // namespace sonard::oculus
