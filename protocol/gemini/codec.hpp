// SPDX-License-Identifier: Apache-2.0
// Bytes <-> messages of a Gemini 720i. One datagram is one message; there is no checksum and no length field.
// Source: docs/protocols/gemini.md 2, 3, 5, 6. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// The common header alone; fails only when `datagram` is shorter than 8 bytes. Lets a head look at the sonar
/// ID before it spends time on the rest.
Result<Header, WireError> decode_header(std::span<const std::uint8_t> datagram);

/// A datagram from a topside. Bytes beyond the message are ignored; a type that no topside sends gives
/// Unknown; a datagram too short for its type or with a count that does not fit gives an error.
Result<Command, WireError> decode_command(std::span<const std::uint8_t> datagram);

/// A datagram from a head, by the same rules. PingLine::data views `datagram`.
Result<Report, WireError> decode_report(std::span<const std::uint8_t> datagram);

/// Exactly one datagram. Any message struct converts to its variant: encode(PingTail{...}).
std::vector<std::uint8_t> encode(const Command& command);
std::vector<std::uint8_t> encode(const Report& report);

/// Appends the bytes to `out`: no allocation when its capacity is enough. Ping lines take this path.
void encode(const Command& command, std::vector<std::uint8_t>& out);
void encode(const Report& report, std::vector<std::uint8_t>& out);

/// The header of whichever message is held.
const Header& header_of(const Command& command);
const Header& header_of(const Report& report);

/// The type byte of whichever message is held, also for Unknown.
std::uint8_t type_of(const Command& command);
std::uint8_t type_of(const Report& report);

}  // namespace sonard::gemini
