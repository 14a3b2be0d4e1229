// SPDX-License-Identifier: Apache-2.0
// Counters of a head's work and rejected input, for logs and metrics.
#pragma once

#include <cstdint>

#include "protocol/ping/head.hpp"

namespace sonard::ping360 {

struct DeviceCounters : ping::HeadCounters {
  std::uint64_t commands_joined = 0;   ///< repeated an unanswered command, and share its answer
  std::uint64_t commands_dropped = 0;  ///< the queue was full
  std::uint64_t resets = 0;
};

}  // namespace sonard::ping360
