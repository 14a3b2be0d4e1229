// SPDX-License-Identifier: Apache-2.0
// Counters of a DVL's work and rejected input, for logs and metrics.
#pragma once

#include <cstdint>

#include "protocol/common/ping_cycle.hpp"

namespace sonard::dvl_a50 {

/// All counters only grow.
struct DeviceCounters : PingCounters {
  std::uint64_t commands = 0;        ///< understood
  std::uint64_t refused = 0;         ///< answered as failed
  std::uint64_t unreadable = 0;      ///< objects without a command, and lines that are no command
  std::uint64_t dropped_bytes = 0;   ///< between objects
  std::uint64_t bad_checksums = 0;   ///< of serial commands
  std::uint64_t overflows = 0;       ///< clients disconnected: an object without an end
  std::uint64_t without_bottom = 0;  ///< reports without bottom lock
  std::uint64_t http_requests = 0;
};

}  // namespace sonard::dvl_a50
