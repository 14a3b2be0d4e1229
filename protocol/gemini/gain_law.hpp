// SPDX-License-Identifier: Apache-2.0
// How the gain fields of a ping configuration change the level of the image (protocol/gemini/README.md 5).
#pragma once

#include <cstdint>

namespace sonard::gemini {

/// The device's own law of `spreading` is not published. This law is inferred and adjustable.
struct GainLaw {
  /// Value of `spreading` that gives 0 dB; the early client library sends it for 50 percent. Later libraries
  /// send 213 for their 50 percent, which gives 11.6 dB more. Set 213 if all clients use a later library.
  double reference_spreading = 67.0;
  /// dB per percent of gain in the early library's percent scale: 40 dB from 0 to 100.
  double db_per_percent = 0.4;
  /// Main gain that gives 0 dB: 16.5 dB base gain plus 8 dB variable gain. Both libraries send this value,
  /// except at very short ranges.
  double nominal_main_gain_db = 24.5;
};

/// Base gain (bits 15..14: 0, 5.5, 11, 16.5 dB) plus variable gain (bits 13..0: 8 dB up to 1000, linear to
/// 50 dB at 3700, flat above).
double main_gain_db(std::uint16_t main_gain);

/// The gain setting, 0..100 percent, for which the early library sends this `spreading`.
double gain_percent(std::uint16_t spreading);

/// Level in dB relative to GainLaw::reference_spreading; rises with `spreading` and is flat at both ends.
double spreading_gain_db(std::uint16_t spreading, const GainLaw& law);

/// Main gain plus spreading gain in dB, relative to the nominal main gain and the reference spreading.
double receive_gain_db(std::uint16_t main_gain, std::uint16_t spreading, const GainLaw& law);

}  // namespace sonard::gemini
