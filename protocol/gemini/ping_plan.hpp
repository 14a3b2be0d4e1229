// SPDX-License-Identifier: Apache-2.0
// Converts a ping configuration to a plan of the head's pings (protocol/gemini/README.md 5, 6.2, 6.7).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/once_warnings.hpp"
#include "protocol/common/ping_job.hpp"
#include "protocol/gemini/device_config.hpp"
#include "protocol/gemini/messages.hpp"

namespace sonard::gemini {

/// Everything that all pings of one ping configuration share.
struct PingPlan {
  RunMode mode = RunMode::single;
  bool pings_out_of_water = false;
  std::chrono::nanoseconds interval{};  ///< start to start, in continuous mode
  /// Without number and time. Native bins are native lines: 32..20000 of sound speed / (2 * 90422 Hz) each.
  /// The gain is relative to 50 percent and nominal main gain (gain_law.hpp).
  PingJob job;
  int rle_threshold = 0;         ///< samples below it are sent as zero; 0: off
  PingHead head;                 ///< without the ping ID and the transmit time
  std::uint16_t line_scale = 0;  ///< PingLine::scale
};

/// Time from the transmit pulse until `native_lines` lines have been received, rounded up.
std::chrono::nanoseconds acoustic_time(int native_lines);

/// Returns the plan for a configuration; nullopt for the reserved run mode and for I/Q or channel data, whose
/// layouts are undocumented.
///
/// Clamps native lines to 32..20000 (8 bit) or 32..10000 (16 bit), the maxima of the client libraries. The
/// ping head reports the clamped number, so that the client expects the right number of lines. Clamps speeds
/// of sound to 1400..1588.8 m/s. Settings not named in PingPlan have no effect on a 720i or on this model.
std::optional<PingPlan> plan_ping(const PingConfig& config, const DeviceConfig& device);

/// Warns once about each field of a client's ping configurations whose value the head clamps.
class PingConfigWarnings {
 public:
  /// @return true if the head clamps a value of `config`
  bool check(const PingConfig& config, std::vector<Notice>& notices);

 private:
  OnceWarnings warnings_;
};

/// A speed of sound in 0.1 m/s, as in the ping head.
/// @param speed_mps 1400 to 1588.8
/// @param snap round to the grid of the device: 1400 + 3.2 k m/s, k = 0..59
std::uint16_t speed_code(double speed_mps, bool snap);

}  // namespace sonard::gemini
