// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/ring_down.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "renderer/acoustics/decibels.hpp"
#include "renderer/acoustics/tvg.hpp"

namespace sonard::render {

namespace {
constexpr double fall_db = 80.0;  // from the peak to the end

/// Amplitude re the peak, at ranges before the peak.
double before_peak(const PhysicalModel& model, double range_m) {
  const double peak_m = model.ring_down.peak_m;
  if (model.ring_down.from_start) {
    return std::sqrt(decibels_to_power(tvg_db(model.tvg, peak_m) - tvg_db(model.tvg, range_m)));
  }
  const double rise = std::max(0.0, 2 * range_m / peak_m - 1);
  return 0.5 * (1 - std::cos(std::numbers::pi * rise));
}

}  // namespace

std::vector<float> ring_down_amplitudes(const PhysicalModel& model, const RangeBins& range) {
  const RingDown& ring_down = model.ring_down;
  std::vector<float> amplitudes(static_cast<std::size_t>(range.count), 0.0F);
  const double peak = std::sqrt(decibels_to_power(ring_down.level_db));
  for (std::size_t k = 0; ring_down.on && k < amplitudes.size(); ++k) {
    const double range_m = (static_cast<double>(k) + 0.5) * range.step_m;
    const double past = (range_m - ring_down.peak_m) / (ring_down.end_m - ring_down.peak_m);
    amplitudes[k] = static_cast<float>(
        peak * (past > 0 ? std::sqrt(decibels_to_power(-fall_db * past)) : before_peak(model, range_m)));
  }
  return amplitudes;
}

std::vector<float> vehicle_reverberation(const RingDown& ring_down, const RangeBins& range) {
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

int ring_down_bins(const RingDown& ring_down, const RangeBins& range) {
  return ring_down.on
             ? static_cast<int>(std::min<double>(range.count, std::ceil(ring_down.end_m / range.step_m)))
             : 0;
}

float draw_ring_down(const RingDown& ring_down, RandomKey key) {
  return static_cast<float>(std::sqrt(decibels_to_power(ring_down.sd_db * normal_number(key))));
}

}  // namespace sonard::render
