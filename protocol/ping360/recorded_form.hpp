// SPDX-License-Identifier: Apache-2.0
// Conversion of a Ping360's pings to log records and back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/ping360/ping_form.hpp"

namespace sonard::ping360 {

/// PingRecord::wire of a ping: its message without data.
std::vector<std::uint8_t> recorded_wire(const PingForm& form, std::uint8_t device_id);
/// The form of the ping in PingRecord::wire; nullopt if it is not a ping.
std::optional<PingForm> recorded_form(std::span<const std::uint8_t> wire);

/// Differences between `asked` and the ping that is sent instead, except rounding on the wire and in logs.
std::vector<Difference> differences(const PingForm& asked, const PingJob& sent, const PingForm& recorded);

}  // namespace sonard::ping360
