// SPDX-License-Identifier: Apache-2.0
// The scan by which known clients cover a range (docs/protocols/ping360.md 2.3).
#pragma once

#include <optional>

#include "protocol/ping360/messages.hpp"

namespace sonard::ping360 {

/// All round from `ahead`, in single steps, with the sampling and the pulse that clients choose for `range_m`
/// at the speed of sound that they assume. Without `samples` there are as many as there may be.
/// @return nullopt: no head samples so finely, or so coarsely
std::optional<AutoTransmit> usual_scan(double range_m, std::optional<int> samples, double sound_speed_mps,
                                       int ahead);

}  // namespace sonard::ping360
