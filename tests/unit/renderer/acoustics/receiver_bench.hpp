// SPDX-License-Identifier: Apache-2.0
// Requests without gain, blanking or noise, and the intensities in samples.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "renderer/acoustics/receiver.hpp"

namespace sonard::render {

/// 256 beams of a Gemini, 16 bits, amplitude 1 is full scale at all ranges.
inline PingRequest bare_request(int lines) {
  PingRequest request;
  request.settings.aperture.beam_edges_rad = equal_sine_edges(256, 1.0471975511965976);
  request.settings.range = {lines, 0.01, 0, false};
  PhysicalModel& model = request.settings.physical;
  model.tvg.log_coefficient = 0;
  model.tvg.absorption_db_per_m = 0;
  model.gain_db = 0;
  model.noise.on = false;
  model.near_field_blank_m = 0;
  model.noise.broadside_stripe_db = 0;
  request.settings.sixteen_bit = true;
  request.seed = 5;
  return request;
}

inline EchoImage even_echo(const PingRequest& request, double intensity) {
  const int beams = request.settings.aperture.beam_count();
  const int lines = request.settings.range.count;
  return {beams, lines,
          std::vector<float>(static_cast<std::size_t>(beams) * static_cast<std::size_t>(lines),
                             static_cast<float>(intensity))};
}

/// Intensities of a ping, re full scale: [line * beams + beam].
inline std::vector<double> intensities_of(const PingSamples& samples) {
  std::vector<double> intensities;
  intensities.reserve(samples.u16.size());
  for (const std::uint16_t code : samples.u16) {
    intensities.push_back(std::pow(code / 65535.0, 2));
  }
  return intensities;
}

}  // namespace sonard::render
