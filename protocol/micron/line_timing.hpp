// SPDX-License-Identifier: Apache-2.0
// How long the parts of one line take (docs/protocols/micron.md 8.4).
#pragma once

#include <chrono>

#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Bins that a head really delivers, and the interval it really uses, for what a host may ask (4).
int effective_bins(const HeadCommand& command);
int effective_ad_interval(const HeadCommand& command);

/// For a motor to turn by `units` of bearing.
std::chrono::nanoseconds turning_time(const HeadCommand& command, int units);

struct LineTiming {
  std::chrono::nanoseconds listen{};  ///< for the echoes, from transmission on
  std::chrono::nanoseconds turn{};    ///< to the next bearing
  std::chrono::nanoseconds send{};    ///< of the line, on the link

  /// From one transmission to the next, without any wait. In full duplex a line travels while the next ping
  /// listens; in half duplex one comes after the other.
  std::chrono::nanoseconds period(const DeviceConfig& config) const;
};

/// Timing of a line after which the head turns by `units`.
LineTiming line_timing(const HeadCommand& command, const DeviceConfig& config, int units);

}  // namespace sonard::micron
