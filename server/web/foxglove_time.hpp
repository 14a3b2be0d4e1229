// SPDX-License-Identifier: Apache-2.0
// Times in messages for Foxglove.
#pragma once

#include <chrono>

#include <nlohmann/json.hpp>

#include "server/clock/clock.hpp"

namespace sonard::server {

/// Unix time as {"sec": ..., "nsec": ...}.
inline nlohmann::json foxglove_time(TimePoint time) {
  const std::chrono::nanoseconds since_epoch = time + unix_time_offset();
  const auto seconds = std::chrono::floor<std::chrono::seconds>(since_epoch);
  return {{"sec", seconds.count()}, {"nsec", (since_epoch - seconds).count()}};
}

}  // namespace sonard::server
