// SPDX-License-Identifier: Apache-2.0
// Frames <-> messages of a Micron. Source: protocol/micron/README.md 3, 5, 6. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/micron/frame.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Decodes a frame from a client, as returned by FrameBuffer. Ignores the lengths and counts in the frame and
/// bytes beyond the message. Fields at the end that a head does not need may be absent (layout.hpp). Returns
/// Unknown for a type that a head does not serve. Returns an error if the frame is too short for its type or
/// has an unknown form of head command.
Result<Command, WireError> decode_command(std::span<const std::uint8_t> frame);

/// Decodes a frame from a head by the rules of decode_command(). In addition, the counts of lines and the
/// length of user blocks must be consistent. HeadData::data views `frame`.
Result<Report, WireError> decode_report(std::span<const std::uint8_t> frame);

/// Encodes one frame, to or from the head at `head_node`. Any message struct converts to its variant. Cuts
/// lines to max_bins bytes.
std::vector<std::uint8_t> encode(const Command& command, std::uint8_t head_node = default_head_node);
std::vector<std::uint8_t> encode(const Report& report, std::uint8_t head_node = default_head_node);

/// The type byte of the message in the variant, also for Unknown.
std::uint8_t type_of(const Command& command);
std::uint8_t type_of(const Report& report);

}  // namespace sonard::micron
