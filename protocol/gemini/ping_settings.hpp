// SPDX-License-Identifier: Apache-2.0
// What an application asks of a head, and the ping configuration that the early client library makes of it.
// Source: docs/protocols/gemini.md 5, "How V1 fills it".
#pragma once

#include <chrono>
#include <optional>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// In the units of a user interface. Values outside the stated ranges are clamped, as the libraries do.
struct PingSettings {
  double range_m = 20.0;            ///< 0.27..150; rounded to whole range lines
  double gain_percent = 50.0;       ///< 0..100
  double sound_speed_mps = 1500.0;  ///< 1400..1588; also what range_m is counted in
  int compression_log2 = 0;         ///< 0..4: 1, 2, 4, 8, 16 native lines averaged into each sent line
  int rle_threshold = 0;            ///< 0 off; 1..255: samples below it become zero and travel shorter
  bool sixteen_bit = false;
  std::optional<std::chrono::microseconds>
      interval;  ///< continuous pinging, start to start; nullopt: single pings
};

/// The header is left for the sender to fill in.
PingConfig make_ping_config(const PingSettings& settings);

}  // namespace sonard::gemini
