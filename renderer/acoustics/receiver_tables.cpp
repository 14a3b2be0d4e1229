#include "renderer/acoustics/receiver_tables.hpp"

#include <algorithm>
#include <cmath>

#include "renderer/acoustics/beam_kernel.hpp"
#include "renderer/acoustics/decibels.hpp"
#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/output_lines.hpp"
#include "renderer/acoustics/ring_down.hpp"

namespace sonard::render {

std::vector<float> tvg_amplitudes(const PhysicalModel& model, const RangeLines& range) {
  std::vector<float> amplitudes(static_cast<std::size_t>(range.count));
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    const double range_m = (static_cast<double>(k) + 0.5) * range.step_m;
    const double tvg_db =
        model.tvg_log_coefficient * std::log10(range_m) + 2 * model.tvg_absorption_db_per_m * range_m;
    amplitudes[k] =
        static_cast<float>(std::sqrt(decibels_to_power(std::min(tvg_db, model.tvg_max_db) + model.gain_db)));
  }
  return amplitudes;
}

ReceiverTables::ReceiverTables(const SonarSettings& settings)
    : aperture(settings.aperture),
      range(settings.range),
      model(settings.physical),
      sixteen_bit(settings.sixteen_bit),
      output_scale(settings.output_scale),
      rings(settings.transmit && model.ring_down.on),
      filter(receive_kernel(aperture), aperture.beam_count()),
      range_grain(model.pulse, model.range_cell_m, range.step_m),
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
