// SPDX-License-Identifier: Apache-2.0
// Frames <-> messages of a Ping360. Source: protocol/ping360/README.md 2. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

/// Decodes a frame from a client, as returned by FrameBuffer. Returns Unknown for an id that no client sends,
/// and an error if the payload is shorter or longer than its message.
Result<Command, WireError> decode_command(std::span<const std::uint8_t> frame);

/// Decodes a frame from a head. Returns Unknown for an id that no head sends, and an error if the payload is
/// too short. Ignores bytes beyond the message. DeviceData::data and AutoDeviceData::data view `frame`.
Result<Report, WireError> decode_report(std::span<const std::uint8_t> frame);

/// Encodes one frame. Any message struct converts to its variant. Cuts text or data that would make the
/// payload longer than max_payload_size.
std::vector<std::uint8_t> encode(const Command& command, std::uint8_t source = client_id,
                                 std::uint8_t destination = 0);
std::vector<std::uint8_t> encode(const Report& report, std::uint8_t source = default_device_id,
                                 std::uint8_t destination = client_id);

/// The id of the message in the variant, also for Unknown.
std::uint16_t id_of(const Command& command);
std::uint16_t id_of(const Report& report);

}  // namespace sonard::ping360
