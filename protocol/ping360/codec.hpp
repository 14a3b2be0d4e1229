// SPDX-License-Identifier: Apache-2.0
// Frames <-> messages of a Ping360. Source: docs/protocols/ping360.md 2. No state; any thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "protocol/common/result.hpp"
#include "protocol/common/wire_error.hpp"
#include "protocol/ping360/frame.hpp"
#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

/// A frame from a host, as FrameBuffer gives it. A number that no host sends gives Unknown; a payload that is
/// shorter or longer than its message gives an error.
Result<Command, WireError> decode_command(std::span<const std::uint8_t> frame);

/// A frame from a head. A number that no head sends gives Unknown; bytes beyond the message are ignored.
/// DeviceData::data and AutoDeviceData::data view `frame`.
Result<Report, WireError> decode_report(std::span<const std::uint8_t> frame);

/// Exactly one frame. Any message struct converts to its variant. A text or data that would make the payload
/// longer than a receiver takes are cut.
std::vector<std::uint8_t> encode(const Command& command, std::uint8_t source = host_id,
                                 std::uint8_t destination = 0);
std::vector<std::uint8_t> encode(const Report& report, std::uint8_t source = default_device_id,
                                 std::uint8_t destination = host_id);

/// The number of whichever message is held, also for Unknown.
std::uint16_t id_of(const Command& command);
std::uint16_t id_of(const Report& report);

}  // namespace sonard::ping360
