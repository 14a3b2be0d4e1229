// SPDX-License-Identifier: Apache-2.0
// Noise of a head's measurements.
#pragma once

#include "protocol/common/noise.hpp"

namespace sonard::dvl_a50 {

using sonard::Noise;

}  // namespace sonard::dvl_a50
