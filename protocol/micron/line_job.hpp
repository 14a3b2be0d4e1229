// SPDX-License-Identifier: Apache-2.0
// Jobs for pings with given parameters and for recorded lines (protocol/micron/README.md 4, 6.3).
#pragma once

#include "protocol/common/ping_record.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// The job of a ping at `bearing`, in units, 0..6399. A head that is mounted boot down without the invert bit
/// points to the opposite side of its reported bearing. The gain is the initial gain, 0..80 dB. The caller
/// sets number and transmit time.
PingJob make_line_job(const HeadCommand& parameters, const DeviceConfig& config, int bearing);

/// The job of a recorded line with the header `line`. The caller sets number, transmit time and record.
PingJob make_line_job(const ReplayedPing& recorded, const HeadData& line);

}  // namespace sonard::micron
