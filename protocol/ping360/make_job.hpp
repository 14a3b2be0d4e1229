// SPDX-License-Identifier: Apache-2.0
// Jobs for pings with given settings and for recorded pings (protocol/ping360/README.md 2.3).
#pragma once

#include "protocol/common/ping_record.hpp"
#include "protocol/ping360/device_config.hpp"
#include "protocol/ping360/ping_form.hpp"

namespace sonard::ping360 {

/// The job of a ping of this form. The caller sets number and transmit time.
PingJob make_job(const PingForm& form, const DeviceConfig& config);

/// The job of a recorded ping with this form. The caller sets number, transmit time and record.
PingJob make_job(const ReplayedPing& recorded, const PingForm& form, const DeviceConfig& config);

}  // namespace sonard::ping360
