// SPDX-License-Identifier: Apache-2.0
// The ping that a head makes with given parameters, or made once (docs/protocols/micron.md 4, 6.3).
#pragma once

#include "protocol/common/ping_record.hpp"
#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// A ping at `bearing`, in units, 0..6399. A head mounted boot down without the invert bit looks to the other
/// side than it says. The gain is the initial gain, 0..80 dB. Its number and transmit time are left for the
/// caller.
PingJob make_line_job(const HeadCommand& parameters, const DeviceConfig& config, int bearing);

/// What a recorded line was made with, which said `line`; number and transmit time as above.
PingJob make_line_job(const RecordedPing& recorded, const HeadData& line);

}  // namespace sonard::micron
