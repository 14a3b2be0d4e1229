// SPDX-License-Identifier: Apache-2.0
// A client's settings as text for the log.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/common/device.hpp"
#include "protocol/ping360/ping_form.hpp"

namespace sonard::ping360 {

/// Settings of a ping: range, sampling, pulse, gain, scan. Without the angle, which changes with each ping.
std::vector<Setting> settings_of(const PingJob& job, const PingForm& form);

/// "0 to 399 gradians, step 1"
std::string scan_text(const AutoTransmit& scan);

}  // namespace sonard::ping360
