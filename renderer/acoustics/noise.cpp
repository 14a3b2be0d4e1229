// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/noise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "renderer/acoustics/decibels.hpp"

namespace sonard::render {

double thermal_noise_db(double carrier_hz) {
  return -15 + 20 * std::log10(carrier_hz / 1000);
}

double noise_level_db(const NoiseBudget& budget) {
  return budget.spectral_level_db - budget.directivity_db + 10 * std::log10(budget.bandwidth_hz) -
         budget.source_level_db;
}

std::vector<float> noise_profile(const NoiseSettings& noise, const Aperture& aperture) {
  std::vector<float> profile;
  const auto& edges = aperture.beam_edges_rad;
  const double peak = decibels_to_power(noise.broadside_stripe_db) - 1;
  for (std::size_t b = 0; b + 1 < edges.size(); ++b) {
    const double x = 0.5 * (edges[b] + edges[b + 1]) / aperture.receive_beamwidth_rad;
    profile.push_back(static_cast<float>(std::sqrt(1 + peak * std::exp(-x * x))));
  }
  return profile;
}

float noise_at_bearing(const NoiseSettings& noise, double bearing_rad, RandomKey key) {
  constexpr std::uint64_t levels = 40;
  const double turns = bearing_rad / (2 * std::numbers::pi);
  const double place = (turns - std::floor(turns)) * levels;
  const double below = std::floor(place);
  const auto level_db = [&](double number) {
    return noise.by_bearing_db * (uniform_number(key, static_cast<std::uint64_t>(number) % levels) - 0.5);
  };
  const double db = level_db(below) + (place - below) * (level_db(below + 1) - level_db(below));
  return static_cast<float>(std::sqrt(decibels_to_power(db)));
}

InterferenceBurst draw_interference(const Interference& interference, const RangeBins& range, RandomKey key) {
  if (!(uniform_number(key, 0) < interference.probability)) {
    return {};
  }
  const double raise_db =
      interference.least_db + (interference.most_db - interference.least_db) * uniform_number(key, 1);
  const double first_line = std::floor(range.count * uniform_number(key, 2));
  const double length_m = interference.median_length_m * std::exp2(2 * uniform_number(key, 3) - 1);
  const bool to_the_end = uniform_number(key, 4) < interference.to_the_end_probability;
  const double end_line = std::min<double>(range.count, first_line + std::ceil(length_m / range.step_m));
  return {static_cast<int>(first_line), to_the_end ? range.count : static_cast<int>(end_line),
          static_cast<float>(std::sqrt(decibels_to_power(raise_db)))};
}

}  // namespace sonard::render
