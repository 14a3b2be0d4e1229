// SPDX-License-Identifier: Apache-2.0
// Counters of a head's work and rejected input, for logs and metrics.
#pragma once

#include <cstdint>

#include "protocol/common/ping_cycle.hpp"

namespace sonard::gemini {

/// All counters only grow, also across reboots of the head. A ping is sent completely with its original tail.
struct DeviceCounters : PingCounters {
  std::uint64_t commands = 0;        ///< understood and for this head
  std::uint64_t bad_datagrams = 0;   ///< too short, or with undecodable contents
  std::uint64_t wrong_id = 0;        ///< for another head
  std::uint64_t unknown_type = 0;    ///< for this head, of an unknown type
  std::uint64_t locked_out = 0;      ///< not from the client, with DeviceConfig::lock_to_first set
  std::uint64_t client_changes = 0;  ///< a command came from another address while one was connected
  std::uint64_t client_timeouts = 0;
  std::uint64_t reboots = 0;

  std::uint64_t pings_suppressed =
      0;  ///< not started: out of the water, or a trigger edge that came too early
  std::uint64_t configs_replaced = 0;  ///< requests of single pings that a newer configuration replaced
  std::uint64_t unsupported_data =
      0;  ///< configurations that request I/Q or channel data, or an unknown run mode

  std::uint64_t out_of_range = 0;  ///< configurations of which a value was clamped

  std::uint64_t lines_sent = 0;
  std::uint64_t retries_received = 0;
  std::uint64_t retries_dropped =
      0;  ///< requests not served: no such line, no ping, queue full, ping replaced
  std::uint64_t heads_resent = 0;
  std::uint64_t lines_resent = 0;
  std::uint64_t tails_resent = 0;
};

}  // namespace sonard::gemini
