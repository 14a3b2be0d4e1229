// SPDX-License-Identifier: Apache-2.0
// Conversion of a DVL's pings to log records and back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "protocol/common/ping_record.hpp"
#include "protocol/dvl_a50/messages.hpp"

namespace sonard::dvl_a50 {

/// The record of a ping without number and transmit time. Its samples are marks at the distances of the
/// beams, in one line; `wire` is the JSON report.
PingRecord record_of(const Velocity& report, double range_m, double sound_speed_mps);
/// The report in PingRecord::wire; nullopt if it is none.
std::optional<Velocity> recorded_form(std::span<const std::uint8_t> wire);

/// The job that fetches a recorded ping.
PingJob make_job(const ReplayedPing& recorded);

}  // namespace sonard::dvl_a50
