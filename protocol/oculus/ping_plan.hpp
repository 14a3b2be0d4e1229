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
  double pressure_bar = 1.25;
  double water_sound_speed_mps = 0.0;  ///< true; 0: what the client says, or what the head computes
  int most_ranges = usual_most_ranges;
  std::chrono::nanoseconds ping_overhead{5'000'000};  ///< of each ping, beside listening (3.3)
  bool rescales_high_frequency_gain = true;           ///< reports 40 + 0.6 gain in mode 2 (4.4)
  bool reports_sound_speed_used = true;  ///< where the fire says 0; otherwise 0 is reported (4.4)
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

/// The job of a plan, but for its number and times. Its mode is 0 at the low frequency and 1 at the high one.
PingJob job_of(const PingPlan& plan, const PlanConfig& config);

/// The image as it goes out: each row's gain word of 1, where the fire asks for it, and samples that are
/// widened to what it asks for. One of `u8` and `u16` holds ranges x beams samples; nullopt: they do not, or
/// 8 bits are asked for and 16 there.
std::optional<std::vector<std::uint8_t>> image_bytes(const PingResult& ping,
                                                     const std::vector<std::uint8_t>& u8,
                                                     const std::vector<std::uint16_t>& u16);

}  // namespace sonard::oculus
