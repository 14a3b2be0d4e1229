// SPDX-License-Identifier: Apache-2.0
// Conversion of a Ping1D's pings to log records and back.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/common/ping_record.hpp"
#include "protocol/ping1d/messages.hpp"
#include "protocol/ping1d/scan.hpp"

namespace sonard::ping1d {

/// What a ping of this scan measures, without its number.
Distance measured_by(const Scan& scan, const DeviceConfig& config, std::uint32_t distance_mm,
                     std::uint16_t confidence_percent);
/// The record of a ping without number and transmit time. Bins are points of the profile; they count from the
/// start of the scan, which only `wire` tells. `wire` is the profile message without its points.
PingRecord record_of(const Distance& measured, std::vector<std::uint8_t> profile, double sound_speed_mps,
                     std::uint8_t device_id);
/// The measurement in PingRecord::wire; nullopt if it is not a profile.
std::optional<Distance> recorded_form(std::span<const std::uint8_t> wire);

/// The job that fetches a recorded ping.
PingJob make_job(const ReplayedPing& recorded, const Distance& measured);
/// Differences between the settings of a client and the recorded ping.
std::vector<Difference> differences(const Scan& asked, const Distance& recorded);

}  // namespace sonard::ping1d
