// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping1d/auto_mode.hpp"

#include <algorithm>
#include <cmath>

namespace sonard::ping1d {
namespace {

constexpr double above_target = 0.2;  // the scan grows if the echo is further beyond its target than this
constexpr double below_target = 0.3;  // the scan may shrink if the echo is nearer than its target by this
constexpr double room_in_shorter =
    0.05;  // so that an echo at the limit does not change the length to and fro
constexpr int too_weak = 100;
constexpr int most_saturated = 10;

std::uint32_t millimetres(double metres) {
  return static_cast<std::uint32_t>(std::lround(1e3 * metres));
}

}  // namespace

Scan next_auto_scan(const Scan& scan, const Echo& echo, const DeviceConfig& config) {
  const std::vector<double>& lengths = config.auto_lengths_m;
  const double length_m = 1e-3 * scan.length_mm;
  const double high = config.auto_target + above_target;
  Scan next = scan;
  next.start_mm = 0;
  const auto longer = std::ranges::upper_bound(lengths, length_m);
  const auto not_shorter = std::ranges::lower_bound(lengths, length_m);
  const double distance_m = 1e-3 * echo.distance_mm.value_or(0.0);
  if (!echo.distance_mm || distance_m > high * length_m) {
    next.length_mm = millimetres(longer == lengths.end() ? lengths.back() : *longer);
  } else if (not_shorter != lengths.begin() && distance_m < (config.auto_target - below_target) * length_m) {
    const double shorter_m = *std::prev(not_shorter);
    if (distance_m <= (high - room_in_shorter) * shorter_m) {
      next.length_mm = millimetres(shorter_m);
    }
  }
  if (echo.saturated > most_saturated && next.gain > 0) {
    --next.gain;
  } else if (echo.peak < too_weak && next.gain < most_gain) {
    ++next.gain;
  }
  return next;
}

}  // namespace sonard::ping1d
