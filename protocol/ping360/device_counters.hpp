// SPDX-License-Identifier: Apache-2.0
// What a head has done and what it refused, for logs and metrics.
#pragma once

#include <cstdint>

namespace sonard::ping360 {

/// They only grow, also across resets of the head.
struct DeviceCounters {
  std::uint64_t commands = 0;            ///< understood
  std::uint64_t refused = 0;             ///< answered by a nack
  std::uint64_t dropped_bytes = 0;       ///< part of no frame
  std::uint64_t bad_checksums = 0;       ///< of what looked like a frame
  std::uint64_t other_destinations = 0;  ///< frames for another device
  std::uint64_t unheard_bytes = 0;       ///< came while it restarted
  std::uint64_t commands_joined = 0;     ///< repeated an unanswered command, and share its answer
  std::uint64_t commands_dropped = 0;    ///< the queue was full
  std::uint64_t clients_dropped = 0;     ///< there were too many
  std::uint64_t locked_out = 0;          ///< datagrams of others while DeviceConfig::lock_to_first holds
  std::uint64_t resets = 0;

  std::uint64_t pings_started = 0;  ///< handed out for rendering
  std::uint64_t pings_sent = 0;
  std::uint64_t pings_failed = 0;     ///< could not be rendered, or the image had the wrong size
  std::uint64_t pings_cancelled = 0;  ///< overtaken by another command
  std::uint64_t stale_images = 0;     ///< answers to jobs that are not, or no longer, wanted
};

}  // namespace sonard::ping360
