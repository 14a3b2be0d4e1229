// SPDX-License-Identifier: Apache-2.0
// What a fire makes a head do: the ping it forms and how often (docs/protocols/oculus.md 3.3, 4, 8).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <vector>

#include "protocol/common/ping_job.hpp"
#include "protocol/oculus/image_form.hpp"
#include "protocol/oculus/models.hpp"

namespace sonard::oculus {

/// Of the water and of choices in which firmware differs.
struct PlanConfig {
  Model model = m750d;
  double temperature_c = 20.0;  ///< of the water; below 30, or clients put the head into standby
  double pressure_bar = 1.25;   ///< reported if the depth of the head is not known
  /// Reported at the surface, to which each metre of depth adds 0.1 bar: 1.013, or 0 of a gauge.
  double surface_pressure_bar = 1.013;
  // What is reported of SensorReadings: 1 as it is, -1 the other way round, 0 nothing (4.2).
  int heading_sign = 1;
  int pitch_sign = 1;
  int roll_sign = 1;
  double water_sound_speed_mps = 0.0;  ///< true; 0: what the client says, or what the head computes
  int most_ranges = usual_most_ranges;
  std::chrono::nanoseconds ping_overhead{5'000'000};  ///< of each ping, beside listening (3.3)
  bool rescales_high_frequency_gain = true;           ///< reports 40 + 0.6 gain in mode 2 (4.4)
  bool reports_sound_speed_used = true;  ///< where the fire says 0; otherwise 0 is reported (4.4)
  /// The header of a ping that answers a fire of version 0 says 1; false: 0 (4.4).
  bool reports_version_1 = true;
};

struct PingPlan {
  SimpleFire asked;
  PingResult result;  ///< all but numbers, times and image
  double range_m = 0.0;
  std::chrono::nanoseconds listening{};
  std::chrono::nanoseconds period{};  ///< from this ping to the next, at the least

  /// Bytes of the image, with the gain words.
  std::size_t image_size() const { return result.ranges * row_size(result); }
};

/// Time between pings that a rate code asks for; nullopt: standby.
std::optional<std::chrono::nanoseconds> period_of_rate(std::uint8_t ping_rate);

/// Requires a fire that is not for standby.
PingPlan plan_ping(const SimpleFire& fire, const PlanConfig& config);

/// Pressure that a head reports at a depth below the surface, negative above it; nullopt: not known.
double pressure_bar(std::optional<double> depth_m, const PlanConfig& config);
/// Writes what the sensors read into a ping: degrees, heading in [0, 360).
void report_readings(const SensorReadings& readings, const PlanConfig& config, PingResult& ping);

/// The job of a plan, but for its number and times. Its mode is 0 at the low frequency and 1 at the high one.
PingJob job_of(const PingPlan& plan, const PlanConfig& config);

/// The image as it goes out: each row's gain word of 1, where the fire asks for it, and samples that are
/// widened to what it asks for. One of `u8` and `u16` holds ranges x beams samples; nullopt: they do not, or
/// 8 bits are asked for and 16 there.
std::optional<std::vector<std::uint8_t>> image_bytes(const PingResult& ping,
                                                     const std::vector<std::uint8_t>& u8,
                                                     const std::vector<std::uint16_t>& u16);

}  // namespace sonard::oculus
