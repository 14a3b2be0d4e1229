// The ping that a head makes with given parameters, or made once (docs/protocols/micron.md 4, 6.3).
#pragma once

#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"
#include "protocol/micron/micron_job.hpp"

namespace sonard::micron {

/// A ping at `bearing`, in units, 0..6399. Its number and transmit time are left for the caller.
MicronJob make_line_job(const HeadCommand& parameters, const DeviceConfig& config, int bearing);

/// What a recorded line was made with; number and transmit time as above.
MicronJob make_line_job(const RecordedLine& recorded);

}  // namespace sonard::micron
