// SPDX-License-Identifier: Apache-2.0
// Frames <-> messages of a Micron. Source: docs/protocols/micron.md 3, 5, 6. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/micron/frame.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// A frame from a host, as FrameBuffer gives it. Lengths and counts inside are not looked at, only what is
/// there; bytes beyond the message are ignored, and fields at its end that a head can do without may be
/// absent (layout.hpp). A type that a head does not serve gives Unknown; a frame too short for its type, or a
/// head command of a form that no client sends, gives an error.
Result<Command, WireError> decode_command(std::span<const std::uint8_t> frame);

/// A frame from a head, by the same rules; user blocks must have one of their two lengths.
/// HeadData::data views `frame`.
Result<Report, WireError> decode_report(std::span<const std::uint8_t> frame);

/// Exactly one frame, to or from the head at `head_node`. Any message struct converts to its variant. A line
/// of more than max_bins bytes is cut.
std::vector<std::uint8_t> encode(const Command& command, std::uint8_t head_node = default_head_node);
std::vector<std::uint8_t> encode(const Report& report, std::uint8_t head_node = default_head_node);

/// The type byte of whichever message is held, also for Unknown.
std::uint8_t type_of(const Command& command);
std::uint8_t type_of(const Report& report);

}  // namespace sonard::micron
