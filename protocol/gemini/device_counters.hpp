// SPDX-License-Identifier: Apache-2.0
// What a head has done and what it refused, for logs and metrics.
#pragma once

#include <cstdint>

namespace sonard::gemini {

/// They only grow, also across reboots of the head.
struct DeviceCounters {
  std::uint64_t commands = 0;       ///< understood and for this head
  std::uint64_t bad_datagrams = 0;  ///< too short, or with contents that mean nothing
  std::uint64_t wrong_id = 0;       ///< for another head
  std::uint64_t unknown_type = 0;   ///< for this head, of a type it does not know
  std::uint64_t locked_out = 0;     ///< of another than the topside, where DeviceConfig::lock_to_first is set
  std::uint64_t topside_changes = 0;  ///< a command came from another address while one was connected
  std::uint64_t topside_timeouts = 0;
  std::uint64_t reboots = 0;

  std::uint64_t pings_started = 0;  ///< handed out for rendering
  std::uint64_t pings_sent = 0;     ///< to their original tail
  std::uint64_t pings_failed = 0;   ///< could not be rendered, or the image had the wrong size
  std::uint64_t pings_cancelled =
      0;  ///< given up before their tail: topside gone, reboot, overtaken by a command
  std::uint64_t pings_suppressed =
      0;  ///< not started: out of the water, or a trigger edge that came too early
  std::uint64_t configs_replaced = 0;  ///< single pings asked for that a newer configuration replaced
  std::uint64_t unsupported_data =
      0;  ///< configurations that ask for I/Q or channel data, or an unknown run mode
  std::uint64_t stale_images = 0;  ///< images of jobs that are not, or no longer, wanted

  std::uint64_t lines_sent = 0;
  std::uint64_t retries_received = 0;
  std::uint64_t retries_dropped =
      0;  ///< requests not served: no such line, no ping, queue full, ping overtaken
  std::uint64_t heads_resent = 0;
  std::uint64_t lines_resent = 0;
  std::uint64_t tails_resent = 0;
};

}  // namespace sonard::gemini
