// SPDX-License-Identifier: Apache-2.0
// What a ping configuration makes the head do (docs/protocols/gemini.md 5, 6.2, 6.7).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "protocol/common/ping_job.hpp"
#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// A ping configuration understood: what is the same for every ping made from it.
struct PingPlan {
  RunMode mode = RunMode::single;
  bool pings_out_of_water = false;
  std::chrono::nanoseconds interval{};  ///< start to start, in continuous mode
  /// Lacks the number and the time. Native bins are native lines: 32..20000 of sound speed / (2 * 90422 Hz)
  /// each. The gain is relative to 50 percent and nominal main gain (gain_law.hpp).
  PingJob job;
  int rle_threshold = 0;         ///< samples below it become zero when the image travels; 0: none do
  PingHead head;                 ///< lacks the ping ID and the transmit time
  std::uint16_t line_scale = 0;  ///< PingLine::scale
};

/// Time from the transmit pulse until `native_lines` lines have been received, rounded up.
std::chrono::nanoseconds acoustic_time(int native_lines);

/// nullopt when the head cannot do it: I/Q or channel data, whose layouts are undocumented, or the reserved
/// run mode.
///
/// Limits of a head that stands for the real one: fewer than 32 native lines count as 32, more than the
/// libraries ever ask for (20000 of 8 bit, 10000 of 16 bit) as that; the ping head then reports what is
/// really sent, so that the topside expects the right number. Speeds of sound outside 1400..1588.8 m/s are
/// moved inside. Everything not named in PingPlan has no effect on a 720i or on this model of it.
std::optional<PingPlan> plan_ping(const PingConfig& config, const DeviceConfig& device);

/// In 0.1 m/s, as the ping head carries it.
/// @param speed_mps 1400 to 1588.8
/// @param snap to the grid of the device: 1400 + 3.2 k m/s, k =
/// 0..59
std::uint16_t speed_code(double speed_mps, bool snap);

}  // namespace sonard::gemini
