// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/receiver_tables.hpp"

#include <cmath>

#include "renderer/acoustics/decibels.hpp"
#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/quantizer.hpp"
#include "renderer/acoustics/ring_down.hpp"
#include "renderer/acoustics/tvg.hpp"

namespace sonard::render {

ReceiverTables::ReceiverTables(const SonarSettings& settings)
    : aperture(settings.aperture),
      range(settings.range),
      model(settings.physical),
      sixteen_bit(settings.sixteen_bit),
      output_scale(settings.output_scale),
      rings(settings.transmit && model.ring_down.on),
      filter(receive_kernel(aperture), aperture.beam_count()),
      pulse_correlation(model.pulse, model.range_cell_m, range.step_m),
      gain(tvg_amplitudes(model, range)),
      profile(noise_profile(settings)),
      ring_down(ring_down_amplitudes(model.ring_down, range)),
      ring_down_lines(render::ring_down_lines(model.ring_down, range)) {
  const float codes = codes_per_amplitude(settings);
  for (float& g : gain) {
    g *= codes;
  }
  if (model.noise) {
    noise = static_cast<float>(std::sqrt(decibels_to_power(model.noise_level_db)));
  }
}

bool ReceiverTables::fits(const SonarSettings& settings) const {
  return aperture == settings.aperture && range == settings.range && model == settings.physical &&
         sixteen_bit == settings.sixteen_bit && output_scale == settings.output_scale &&
         rings == (settings.transmit && settings.physical.ring_down.on);
}

}  // namespace sonard::render
