// SPDX-License-Identifier: Apache-2.0
// What a head has done and what it refused, for logs and metrics.
#pragma once

#include <cstdint>

namespace sonard::micron {

/// They only grow, also across reboots of the head.
struct DeviceCounters {
  std::uint64_t commands = 0;             ///< understood and for this head
  std::uint64_t dropped_bytes = 0;        ///< part of no frame
  std::uint64_t bad_frames = 0;           ///< whole, with contents that mean nothing
  std::uint64_t cut_frames = 0;           ///< shorter than their length field, but understood
  std::uint64_t wrong_node = 0;           ///< for another head
  std::uint64_t unknown_type = 0;         ///< for this head, of a type it does not know
  std::uint64_t unheard_bytes = 0;        ///< came while it booted
  std::uint64_t not_ready = 0;            ///< needs parameters, and there were none
  std::uint64_t requests_beyond_cap = 0;  ///< lines asked for that are not owed
  std::uint64_t boots = 0;                ///< after the first one
  std::uint64_t alives_sent = 0;

  std::uint64_t pings_started = 0;  ///< handed out for rendering
  std::uint64_t lines_sent = 0;
  std::uint64_t pings_failed = 0;     ///< could not be rendered, or the line had the wrong size
  std::uint64_t pings_cancelled = 0;  ///< overtaken by new parameters or a reboot
  std::uint64_t stale_lines = 0;      ///< answers to jobs that are not, or no longer, wanted
};

}  // namespace sonard::micron
