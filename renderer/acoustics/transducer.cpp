// SPDX-License-Identifier: Apache-2.0
#include "renderer/acoustics/transducer.hpp"

#include <cmath>
#include <numbers>

namespace sonard::render {

namespace {

/// The strongest amplitude behind two equal resonators in series. When the tone ends, the resonators have
/// amplitudes `first` and `second`. `second` rises until it equals the falling `first`.
/// @param length of the tone in time constants; 0: it does not end
double strongest_amplitude(double length) {
  if (!(length > 0)) {
    return 1.0;
  }
  const double first = -std::expm1(-length);
  const double second = first - length * std::exp(-length);
  return first * std::exp(second / first - 1);
}

}  // namespace

double band_loss_db(const TransducerBand& band, double frequency_hz, double duration_s) {
  const double width_hz = band.high_hz - band.low_hz;
  if (!(width_hz > 0)) {
    return 0.0;
  }
  const double resonance_hz = std::sqrt(band.low_hz * band.high_hz);
  const double detuning =
      resonance_hz / width_hz * (frequency_hz / resonance_hz - resonance_hz / frequency_hz);
  const double one_way = 1 / (1 + detuning * detuning);
  return 20 * std::log10(one_way * strongest_amplitude(duration_s * std::numbers::pi * width_hz));
}

}  // namespace sonard::render
