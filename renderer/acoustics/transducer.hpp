// SPDX-License-Identifier: Apache-2.0
// Loss of a tone in the band of a transducer (docs/physics.md 2.6).
#pragma once

namespace sonard::render {

/// One resonance, given by its two frequencies of 3 dB loss, one way. Both 0: every frequency passes.
struct TransducerBand {
  double low_hz = 0.0;   ///< >= 0
  double high_hz = 0.0;  ///< > low_hz, unless both are 0

  bool operator==(const TransducerBand&) const = default;
};

/// Level of the strongest echo of a tone that one transducer sends and receives, re a long tone at the
/// resonance; <= 0 dB. The steady level at the frequency is the level of a resonator, applied twice; a short
/// tone ends before two resonators in series have built up.
/// @param frequency_hz > 0. @param duration_s of the tone, > 0; 0: long
double band_loss_db(const TransducerBand& band, double frequency_hz, double duration_s);

}  // namespace sonard::render
