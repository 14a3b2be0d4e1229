// SPDX-License-Identifier: Apache-2.0
// Bytes <-> messages of a Gemini 720i. One datagram is one message; there is no checksum and no length field.
// Source: protocol/gemini/README.md 2, 3, 5, 6. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Decodes the common header only, so that a head can check the sonar ID first. Fails only if `datagram` is
/// shorter than 8 bytes.
Result<Header, WireError> decode_header(std::span<const std::uint8_t> datagram);

/// Decodes a datagram from a client. Ignores bytes beyond the message. Returns Unknown for a type that no
/// client sends. Returns an error if the datagram is too short for its type or has an inconsistent count.
Result<Command, WireError> decode_command(std::span<const std::uint8_t> datagram);

/// Decodes a datagram from a head, by the rules of decode_command(). PingLine::data views `datagram`.
Result<Report, WireError> decode_report(std::span<const std::uint8_t> datagram);

/// Encodes one datagram. Any message struct converts to its variant: encode(PingTail{...}).
std::vector<std::uint8_t> encode(const Command& command);
std::vector<std::uint8_t> encode(const Report& report);

/// Appends the bytes to `out` without an allocation if its capacity suffices. Used for ping lines.
void encode(const Command& command, std::vector<std::uint8_t>& out);
void encode(const Report& report, std::vector<std::uint8_t>& out);

/// The header of the message in the variant.
const Header& header_of(const Command& command);
const Header& header_of(const Report& report);

/// The type byte of the message in the variant, also for Unknown.
std::uint8_t type_of(const Command& command);
std::uint8_t type_of(const Report& report);

}  // namespace sonard::gemini
