// SPDX-License-Identifier: Apache-2.0
// Counters of a head's work and rejected input, for logs and metrics.
#pragma once

#include <cstdint>

#include "protocol/common/ping_cycle.hpp"

namespace sonard::ping1d {

/// All counters only grow, also across restarts of the head.
struct DeviceCounters : PingCounters {
  std::uint64_t commands = 0;            ///< understood
  std::uint64_t refused = 0;             ///< answered by a nack
  std::uint64_t refused_in_auto = 0;     ///< of range or gain, which the head chooses
  std::uint64_t dropped_bytes = 0;       ///< not part of a frame
  std::uint64_t bad_checksums = 0;       ///< frames with a wrong checksum
  std::uint64_t other_destinations = 0;  ///< frames for another device
  std::uint64_t unheard_bytes = 0;       ///< arrived while the head restarted
  std::uint64_t locked_out = 0;          ///< datagrams of other addresses, by ClientsConfig::lock_to_first
};

}  // namespace sonard::ping1d
