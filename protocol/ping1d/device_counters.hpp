// SPDX-License-Identifier: Apache-2.0
// Counters of a head's work and rejected input, for logs and metrics.
#pragma once

#include <cstdint>

#include "protocol/ping/head.hpp"

namespace sonard::ping1d {

struct DeviceCounters : ping::HeadCounters {
  std::uint64_t refused_in_auto = 0;  ///< of range or gain, which the head chooses
};

}  // namespace sonard::ping1d
