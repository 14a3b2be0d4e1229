// SPDX-License-Identifier: Apache-2.0
// Durations of the parts of one line (protocol/micron/README.md 8.4).
#pragma once

#include <chrono>

#include "protocol/micron/device_config.hpp"
#include "protocol/micron/messages.hpp"

namespace sonard::micron {

/// Number of bins that a head delivers, and interval that it uses, for any requested values (4).
int effective_bins(const HeadCommand& command);
int effective_ad_interval(const HeadCommand& command);

/// Time for the motor to turn by `units` of bearing.
std::chrono::nanoseconds turning_time(const HeadCommand& command, int units);

struct LineTiming {
  std::chrono::nanoseconds listen{};  ///< from transmission to the last echo
  std::chrono::nanoseconds turn{};    ///< turn to the next bearing
  std::chrono::nanoseconds send{};    ///< transfer of the line on the link

  /// Minimum time from one transmission to the next. In full duplex a line is sent while the next ping
  /// listens; in half duplex before the next ping.
  std::chrono::nanoseconds period(const DeviceConfig& config) const;
};

/// Timing of a line after which the head turns by `units`.
LineTiming line_timing(const HeadCommand& command, const DeviceConfig& config, int units);

}  // namespace sonard::micron
