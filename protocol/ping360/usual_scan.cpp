// SPDX-License-Identifier: Apache-2.0
#include "protocol/ping360/usual_scan.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "protocol/ping360/units.hpp"

namespace sonard::ping360 {
namespace {

constexpr double most_samples = 1200.0;

/// Sample period in wire units: the two-way travel time divided by `samples`, rounded down. The term 1e-9
/// keeps whole results from becoming one less by rounding errors.
int units_per_sample(double range_m, double samples, double sound_speed_mps) {
  return static_cast<int>(2.0 * range_m / (samples * sample_time_s(1) * sound_speed_mps) + 1e-9);
}

/// The maximum number of samples, limited by the shortest sample period of a head.
int usual_samples(double range_m, double sound_speed_mps) {
  const double finest = 2.0 * range_m / (sample_time_s(least_sample_period) * sound_speed_mps);
  return static_cast<int>(std::min(most_samples, finest));
}

/// Pulse length: longer for a longer range, at least 2.5 samples.
std::uint16_t usual_pulse_us(double range_m, int sample_period, double sound_speed_mps) {
  const double sample_us = 1e6 * sample_time_s(sample_period);
  const double wanted_us = std::max(std::round(8000.0 * range_m / sound_speed_mps), 2.5 * sample_us);
  return static_cast<std::uint16_t>(std::clamp(wanted_us, 5.0, std::min(500.0, 64.0 * sample_us)));
}

}  // namespace

std::optional<AutoTransmit> usual_scan(double range_m, std::optional<int> samples, double sound_speed_mps,
                                       int ahead) {
  const int count = samples.value_or(usual_samples(range_m, sound_speed_mps));
  const int period = units_per_sample(range_m, count, sound_speed_mps);
  if (period < least_sample_period || period > most_sample_period) {
    return std::nullopt;
  }
  AutoTransmit scan;
  scan.number_of_samples = static_cast<std::uint16_t>(count);
  scan.sample_period = static_cast<std::uint16_t>(period);
  scan.transmit_duration_us = usual_pulse_us(range_m, period, sound_speed_mps);
  scan.start_angle = static_cast<std::uint16_t>(ahead);
  scan.stop_angle = static_cast<std::uint16_t>(wrapped(ahead - 1));
  return scan;
}

}  // namespace sonard::ping360
