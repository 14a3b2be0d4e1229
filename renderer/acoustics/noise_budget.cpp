#include "renderer/acoustics/noise_budget.hpp"

#include <cmath>

namespace sonard::render {

double thermal_noise_db(double carrier_hz) {
  return -15 + 20 * std::log10(carrier_hz / 1000);
}

double noise_level_db(const NoiseBudget& budget) {
  return budget.spectral_level_db - budget.directivity_db + 10 * std::log10(budget.bandwidth_hz) -
         budget.source_level_db;
}

}  // namespace sonard::render
