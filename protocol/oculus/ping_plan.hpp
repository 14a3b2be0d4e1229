// SPDX-License-Identifier: Apache-2.0
// Converts a fire to a plan: settings and period of the pings (protocol/oculus/README.md 3.3, 4, 8).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "protocol/oculus/image_form.hpp"
#include "protocol/oculus/models.hpp"

namespace sonard::oculus {

/// Properties of the water, and choices in which firmware versions differ.
struct PlanConfig {
  Model model = m750d;
  double temperature_c = 20.0;  ///< of the water; keep below 30, or clients put the head into standby
  double pressure_bar = 1.25;   ///< reported if the depth of the head is unknown
  /// Reported at the water surface; each metre of depth adds 0.1 bar. 1.013, or 0 for gauge pressure.
  double surface_pressure_bar = 1.013;
  // Factors on the reported SensorReadings: 1 unchanged, -1 negated, 0 not reported (4.2).
  int heading_sign = 1;
  int pitch_sign = 1;
  int roll_sign = 1;
  double water_sound_speed_mps = 0.0;  ///< true speed; 0: the client's, or as computed by the head
  int most_ranges = usual_most_ranges;
  std::chrono::nanoseconds ping_overhead{5'000'000};  ///< per ping, in addition to listening; > 0 (3.3)
  bool rescales_high_frequency_gain = true;           ///< report 40 + 0.6 gain in mode 2 (4.4)
  bool reports_sound_speed_used = true;  ///< if the fire has 0, report the speed used; false: report 0 (4.4)
  /// A ping that answers a fire of version 0 has version 1 in its header; false: 0 (4.4).
  bool reports_version_1 = true;
};

struct PingPlan {
  SimpleFire asked;
  PingResult result;  ///< without numbers, times and image
  double range_m = 0.0;
  std::chrono::nanoseconds listening{};
  std::chrono::nanoseconds period{};  ///< minimum time from this ping to the next

  /// Bytes of the image with the gain words.
  std::size_t image_size() const { return result.ranges * row_size(result); }
};

/// Limits to which a head clamps speeds of sound.
inline constexpr double least_sound_speed_mps = 1400.0;
inline constexpr double most_sound_speed_mps = 1600.0;

/// Time between pings for a rate code; nullopt: standby.
std::optional<std::chrono::nanoseconds> period_of_rate(std::uint8_t ping_rate);

/// Makes the plan for a fire, which must not be for standby.
PingPlan plan_ping(const SimpleFire& fire, const PlanConfig& config);

/// Pressure that a head reports at a depth below the water surface (negative above it; nullopt: unknown).
double pressure_bar(std::optional<double> depth_m, const PlanConfig& config);
/// Writes sensor readings into a ping: in degrees, heading in [0, 360).
void report_readings(const SensorReadings& readings, const PlanConfig& config, PingResult& ping);

/// The job of a plan, without number and transmit time. Mode 0 is the low frequency, 1 the high frequency.
PingJob job_of(const PingPlan& plan, const PlanConfig& config);

/// The image on the wire: in each row a gain word of 1, if the fire requests it, and samples widened to the
/// requested width. One of `u8` and `u16` must hold ranges x beams samples. nullopt if it does not, or if
/// 8-bit samples are requested and only 16-bit ones are given.
std::optional<std::vector<std::uint8_t>> image_bytes(const PingResult& ping,
                                                     const std::vector<std::uint8_t>& u8,
                                                     const std::vector<std::uint16_t>& u16);

}  // namespace sonard::oculus
