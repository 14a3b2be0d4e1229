// SPDX-License-Identifier: Apache-2.0
// A ping of a Ping360 as logs keep it, and back: what goes to a log, and how a head sends what comes from
// one.
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
/// The form that it says; nullopt where it is no ping.
std::optional<PingForm> recorded_form(std::span<const std::uint8_t> wire);

/// How `asked` differs from what is sent in its place. Rounding of the wire and of logs is no difference.
std::vector<Difference> differences(const PingForm& asked, const PingJob& sent, const PingForm& recorded);

}  // namespace sonard::ping360
