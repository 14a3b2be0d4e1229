// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/tvg.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "renderer/acoustics/decibels.hpp"

namespace sonard::render {

double tvg_db(const TvgSettings& tvg, double range_m) {
  return std::min(tvg.log_coefficient * std::log10(range_m) + 2 * tvg.absorption_db_per_m * range_m,
                  tvg.max_db);
}

std::vector<float> tvg_amplitudes(const PhysicalModel& model, const RangeBins& range) {
  std::vector<float> amplitudes(static_cast<std::size_t>(range.count));
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    const double range_m = (static_cast<double>(k) + 0.5) * range.step_m;
    amplitudes[k] =
        static_cast<float>(std::sqrt(decibels_to_power(tvg_db(model.tvg, range_m) + model.gain_db)));
  }
  return amplitudes;
}

}  // namespace sonard::render
