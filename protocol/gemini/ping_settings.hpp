// SPDX-License-Identifier: Apache-2.0
// Settings of an application, and the ping configuration that the early client library sends for them.
// Source: protocol/gemini/README.md 5, "How V1 fills it".
#pragma once

#include <chrono>
#include <optional>

#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Settings in user units. Values out of range are clamped, as in the libraries.
struct PingSettings {
  double range_m = 20.0;            ///< 0.27..150; rounded to whole range lines
  double gain_percent = 50.0;       ///< 0..100
  double sound_speed_mps = 1500.0;  ///< 1400..1588; also used to convert range_m to lines
  int compression_log2 = 0;         ///< 0..4: 1, 2, 4, 8, 16 native lines averaged into each sent line
  int rle_threshold = 0;            ///< 0: off; 1..255: samples below it become zero and are run-length coded
  bool sixteen_bit = false;
  std::optional<std::chrono::microseconds>
      interval;  ///< of continuous pinging, start to start; nullopt: single pings
};

/// Makes the configuration; the sender must set the header.
PingConfig make_ping_config(const PingSettings& settings);

}  // namespace sonard::gemini
