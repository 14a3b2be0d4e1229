// SPDX-License-Identifier: Apache-2.0
// Conversion of an Oculus' pings to log records and back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/oculus/ping_plan.hpp"

namespace sonard::oculus {

/// The record of a ping that is sent as `message`. Keeps the high byte of samples with more than 8 bits;
/// `wire` ends after the bearings. Number, time and gain are not set.
PingRecord record_of(const PingResult& ping, std::span<const std::uint8_t> message);

/// The ping in PingRecord::wire, without its image; nullopt if a head could not send it: it must have 256 or
/// 512 beams and at least one row.
std::optional<PingResult> recorded_form(std::span<const std::uint8_t> wire);

/// Changes the plan `asked` so that it sends this recorded ping, with the recorded rows, beams, bearings and
/// frequency. Samples have the requested width, but only 8 significant bits. The client's settings are
/// returned unchanged except the flag of the beams. Requires a recorded_form().
PingPlan held_to(const ReplayedPing& recorded, const PingPlan& asked);

/// Differences between `asked` and the ping that is sent instead. Rounding is ignored.
std::vector<Difference> differences(const PingPlan& asked, const PingPlan& sent,
                                    const RecordedSettings& recorded);

}  // namespace sonard::oculus
