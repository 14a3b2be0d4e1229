// SPDX-License-Identifier: Apache-2.0
// The scan with which known clients cover a range (protocol/ping360/README.md 2.3).
#pragma once

#include <optional>

#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

/// A full-circle scan from `ahead` in single steps, with the sampling and pulse that clients choose for
/// `range_m` at their assumed speed of sound. Without `samples` it has the maximum number of samples.
/// @return nullopt if the sample period would be out of range
std::optional<AutoTransmit> usual_scan(double range_m, std::optional<int> samples, double sound_speed_mps,
                                       int ahead);

}  // namespace sonard::ping360
