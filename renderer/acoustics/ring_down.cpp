// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/ring_down.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "renderer/acoustics/decibels.hpp"

namespace sonard::render {

namespace {
constexpr double fall_db = 80.0;  // from the peak to the end
}

std::vector<float> ring_down_amplitudes(const RingDown& ring_down, const RangeLines& range) {
  std::vector<float> amplitudes(static_cast<std::size_t>(range.count), 0.0F);
  const double peak = std::sqrt(decibels_to_power(ring_down.level_db));
  const double begin_m = ring_down.peak_m / 2;
  for (std::size_t k = 0; ring_down.on && k < amplitudes.size(); ++k) {
    const double range_m = (static_cast<double>(k) + 0.5) * range.step_m;
    if (range_m <= begin_m) {
      continue;
    }
    const double past = (range_m - ring_down.peak_m) / (ring_down.end_m - ring_down.peak_m);
    const double rise = (range_m - begin_m) / (ring_down.peak_m - begin_m);
    const double shape = past > 0 ? std::sqrt(decibels_to_power(-fall_db * past))
                                  : 0.5 * (1 - std::cos(std::numbers::pi * rise));
    amplitudes[k] = static_cast<float>(peak * shape);
  }
  return amplitudes;
}

std::vector<float> vehicle_reverberation(const RingDown& ring_down, const RangeLines& range) {
  std::vector<float> intensities(static_cast<std::size_t>(range.count), 0.0F);
  for (std::size_t k = 0; ring_down.on && k < intensities.size(); ++k) {
    const double range_m = (static_cast<double>(k) + 0.5) * range.step_m;
    const double past_m = range_m - 1.0;
    const double level_db = ring_down.vehicle_level_db - ring_down.vehicle_fall_db_per_m * past_m;
    if (range_m >= ring_down.peak_m && past_m * ring_down.vehicle_fall_db_per_m < fall_db) {
      intensities[k] = static_cast<float>(decibels_to_power(level_db));
    }
  }
  return intensities;
}

int ring_down_lines(const RingDown& ring_down, const RangeLines& range) {
  return ring_down.on
             ? static_cast<int>(std::min<double>(range.count, std::ceil(ring_down.end_m / range.step_m)))
             : 0;
}

float draw_ring_down(const RingDown& ring_down, RandomKey key) {
  return static_cast<float>(std::sqrt(decibels_to_power(ring_down.sd_db * normal_number(key))));
}

}  // namespace sonard::render
