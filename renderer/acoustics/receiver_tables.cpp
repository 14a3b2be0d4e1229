// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/receiver_tables.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "renderer/acoustics/decibels.hpp"
#include "renderer/acoustics/noise.hpp"
#include "renderer/acoustics/quantizer.hpp"
#include "renderer/acoustics/ring_down.hpp"
#include "renderer/acoustics/tone.hpp"
#include "renderer/acoustics/tvg.hpp"

namespace sonard::render {

namespace {

constexpr int most_cells = 16;

bool joins_decibels(const SonarSettings& settings) {
  return settings.aperture.beam_count() == 1 && settings.output_scale == OutputScale::half_decibels;
}

/// Range cells per line, more than 1 only for a single beam with a receiver of decibels.
int cells_per_line(const SonarSettings& settings) {
  if (joins_decibels(settings) && settings.physical.bin_overlap > 0) {
    return 2;  // the receiver's band depends on the bin length, so half a bin is a cell
  }
  // The main lobe of a chirp with a Hann window is twice as wide.
  const bool windowed = settings.physical.pulse.shape == PulseSettings::Shape::windowed_chirp;
  const double cell_m = settings.physical.pulse.range_cell_m * (windowed ? 2.0 : 1.0);
  if (!joins_decibels(settings) || !(cell_m > 0)) {
    return 1;
  }
  return std::clamp(static_cast<int>(settings.range.step_m / cell_m), 1, most_cells);
}

/// A tone has no matched filter: noise has the band of the receiver.
PulseCorrelation noise_correlation_of(const PhysicalModel& model, double step_m) {
  const bool matched = !(model.noise.cell_m > 0);
  return {matched ? model.pulse.shape : PulseSettings::Shape::chirp,
          matched ? model.pulse.range_cell_m : model.noise.cell_m, step_m};
}

/// Noise power before the gain, re the noise with the usual pulse: the longer a tone, the less noise passes
/// its matched filter.
double matched_noise(const PhysicalModel& model) {
  const UsualPulse& usual = model.pulse.usual;
  if (model.pulse.shape != PulseSettings::Shape::tone || model.noise.cell_m > 0 ||
      !(model.pulse.range_cell_m > 0) || !(usual.cell_m > 0)) {
    return 1;
  }
  return tone_length_m(usual.cell_m, model.pulse.tone_rounding_m) /
         tone_length_m(model.pulse.range_cell_m, model.pulse.tone_rounding_m);
}

/// @param gain per range bin, amplitude
std::vector<float> noise_amplitudes(const PhysicalModel& model, const std::vector<float>& gain) {
  std::vector<float> amplitudes(gain.size(), 0.0F);
  const double before_gain = decibels_to_power(model.noise.level_db) * matched_noise(model);
  const double behind_gain = decibels_to_power(model.noise.output_db);
  for (std::size_t k = 0; model.noise.on && k < gain.size(); ++k) {
    const double power = static_cast<double>(gain[k]) * static_cast<double>(gain[k]);
    amplitudes[k] = static_cast<float>(std::sqrt(before_gain + behind_gain / power));
  }
  return amplitudes;
}

}  // namespace

ReceiverTables::ReceiverTables(const SonarSettings& settings)
    : aperture(settings.aperture),
      range(settings.range),
      model(settings.physical),
      sixteen_bit(settings.sixteen_bit),
      output_scale(settings.output_scale),
      rings(settings.transmit && model.ring_down.on),
      cells(cells_per_line(settings)),
      overlap(joins_decibels(settings) ? static_cast<float>(model.bin_overlap) : 0.0F),
      filter(receive_kernel(aperture), aperture.beam_count()),
      pulse_correlation(model.pulse.shape, model.pulse.range_cell_m, range.step_m / cells,
                        model.pulse.tone_rounding_m),
      noise_correlation(noise_correlation_of(model, range.step_m / cells)),
      gain(tvg_amplitudes(model, range)),
      profile(noise_profile(model.noise, aperture)),
      ring_down(ring_down_amplitudes(model, range)),
      ring_down_bins(render::ring_down_bins(model.ring_down, range)),
      vehicle(vehicle_reverberation(model.ring_down, range)) {
  noise = noise_amplitudes(model, gain);
  const float codes = codes_per_amplitude(settings);
  for (float& g : gain) {
    g *= codes;
  }
}

bool ReceiverTables::fits(const SonarSettings& settings) const {
  return aperture == settings.aperture && range == settings.range && model == settings.physical &&
         sixteen_bit == settings.sixteen_bit && output_scale == settings.output_scale &&
         rings == (settings.transmit && settings.physical.ring_down.on);
}

}  // namespace sonard::render
