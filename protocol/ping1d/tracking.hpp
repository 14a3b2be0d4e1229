// SPDX-License-Identifier: Apache-2.0
// Distance and confidence over the pings of a head. Source: protocol/ping1d/README.md 3.4.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

#include "protocol/ping1d/echo.hpp"

namespace sonard::ping1d {

/// Follows an echo with a filter for distance and speed, which has no lag behind a steady motion. An echo
/// elsewhere replaces the followed one at once. The confidence is a mean over pings.
class Tracking {
 public:
  explicit Tracking(int confidence_window) : window_(static_cast<std::size_t>(confidence_window)) {}

  /// Adds the echo of a ping that left `since_last` after the last one.
  void add(const Echo& echo, std::chrono::nanoseconds since_last);

  /// 0 before the first echo. Without an echo, the distance of the last one.
  std::uint32_t distance_mm() const;
  /// 0 without an echo in the newest ping.
  std::uint8_t confidence_percent() const;
  /// True if the newest ping has an echo.
  bool has_echo() const { return has_echo_; }

 private:
  std::size_t window_;
  double distance_mm_ = 0.0;
  double speed_mmps_ = 0.0;
  bool has_echo_ = false;
  std::deque<double> confidences_;
};

}  // namespace sonard::ping1d
