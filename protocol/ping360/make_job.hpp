// SPDX-License-Identifier: Apache-2.0
// The ping that a head makes with given settings, or made once (docs/protocols/ping360.md 2.3).
#pragma once

#include "protocol/common/ping_record.hpp"
#include "protocol/ping360/device_config.hpp"
#include "protocol/ping360/ping_form.hpp"

namespace sonard::ping360 {

/// A ping of this form. Its number and transmit time are left for the caller.
PingJob make_job(const PingForm& form, const DeviceConfig& config);

/// What a recorded ping was made with, which said `form`; number and transmit time as above.
PingJob make_job(const RecordedPing& recorded, const PingForm& form, const DeviceConfig& config);

}  // namespace sonard::ping360
