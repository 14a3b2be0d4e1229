// SPDX-License-Identifier: Apache-2.0
// What the band of a transducer leaves of a tone (docs/physics.md 2.6).
#pragma once

namespace sonard::render {

/// One resonance, between the frequencies at which one way loses 3 dB. Both 0: every frequency passes.
struct TransducerBand {
  double low_hz = 0.0;   ///< >= 0
  double high_hz = 0.0;  ///< > low_hz, but for both 0

  bool operator==(const TransducerBand&) const = default;
};

/// Level of the strongest echo of a tone that one transducer sends and receives, re a long tone at the
/// resonance; <= 0 dB. The steady level at the frequency is that of a resonator, twice; a short tone ends
/// before two resonators in a row have built up.
/// @param frequency_hz > 0. @param duration_s of the tone, > 0; 0: long
double band_loss_db(const TransducerBand& band, double frequency_hz, double duration_s);

}  // namespace sonard::render
