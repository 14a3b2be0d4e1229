// SPDX-License-Identifier: Apache-2.0
// What the gain fields of a ping configuration do to the level of the image (docs/protocols/gemini.md 5).
#pragma once

#include <cstdint>

namespace sonard::gemini {

/// The device's own law of `spreading` is not published; this one is inferred and can be moved.
struct GainLaw {
  /// Value of `spreading` that gives 0 dB: what the early client library sends for 50 percent. Later
  /// libraries send 213 for their 50 percent and are 11.6 dB louder for it; set 213 where those are the only
  /// clients.
  double reference_spreading = 67.0;
  /// dB for one percent of gain as the early library counts percent: 40 dB from 0 to 100.
  double db_per_percent = 0.4;
  /// Main gain at which the level is 0 dB: 16.5 dB base gain and 8 dB variable gain, what both libraries send
  /// beyond very short ranges.
  double nominal_main_gain_db = 24.5;
};

/// Base gain (bits 15..14: 0, 5.5, 11, 16.5 dB) plus variable gain (bits 13..0: 8 dB up to 1000, linear to 50
/// dB at 3700, flat above).
double main_gain_db(std::uint16_t main_gain);

/// The gain that a client of the early library set to send this `spreading`, 0..100 percent.
double gain_percent(std::uint16_t spreading);

/// Level relative to GainLaw::reference_spreading; rises with `spreading` and is flat at both ends.
double spreading_gain_db(std::uint16_t spreading, const GainLaw& law);

/// Both together, relative to 50 percent and the nominal main gain.
double receive_gain_db(std::uint16_t main_gain, std::uint16_t spreading, const GainLaw& law);

}  // namespace sonard::gemini
