// SPDX-License-Identifier: Apache-2.0
// Counters of a head's work and rejected input, for logs and metrics.
#pragma once

#include <cstdint>

#include "protocol/common/ping_cycle.hpp"

namespace sonard::micron {

/// All counters only grow, also across reboots of the head. A ping is a line.
struct DeviceCounters : PingCounters {
  std::uint64_t commands = 0;             ///< understood and for this head
  std::uint64_t dropped_bytes = 0;        ///< not part of a frame
  std::uint64_t bad_frames = 0;           ///< with undecodable contents
  std::uint64_t cut_frames = 0;           ///< shorter than their length field, but understood
  std::uint64_t wrong_node = 0;           ///< for another head
  std::uint64_t unknown_type = 0;         ///< for this head, of an unknown type
  std::uint64_t out_of_range = 0;         ///< head commands of which a value was clamped
  std::uint64_t unheard_bytes = 0;        ///< arrived while the head booted
  std::uint64_t not_ready = 0;            ///< commands that need parameters, before there were any
  std::uint64_t requests_beyond_cap = 0;  ///< requested lines beyond the cap, which are not owed
  std::uint64_t boots = 0;                ///< after the first one
  std::uint64_t alives_sent = 0;
};

}  // namespace sonard::micron
