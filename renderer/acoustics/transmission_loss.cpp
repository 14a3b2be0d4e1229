// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/transmission_loss.hpp"

#include <cmath>
#include <cstddef>

namespace sonard::render {

TransmissionLoss::TransmissionLoss(const SonarSettings& settings)
    : step_m(settings.range.step_m),
      absorption_db_per_m(settings.physical.absorption_db_per_m),
      of_line(static_cast<std::size_t>(settings.range.count)) {
  for (std::size_t k = 0; k < of_line.size(); ++k) {
    const double range_m = (static_cast<double>(k) + 0.5) * step_m;
    of_line[k] = static_cast<float>(std::pow(10.0, -absorption_db_per_m * range_m / 5) / (range_m * range_m));
  }
}

bool TransmissionLoss::fits(const SonarSettings& settings) const {
  return step_m == settings.range.step_m && absorption_db_per_m == settings.physical.absorption_db_per_m &&
         of_line.size() == static_cast<std::size_t>(settings.range.count);
}

void apply_loss(const std::vector<float>& loss, EchoImage& image) {
  for (std::size_t beam = 0; beam < static_cast<std::size_t>(image.beams); ++beam) {
    float* line = &image.intensity[beam * loss.size()];
    for (std::size_t k = 0; k < loss.size(); ++k) {
      line[k] *= loss[k];
    }
  }
}

}  // namespace sonard::render
