// SPDX-License-Identifier: Apache-2.0
// Random fields of a ping, line after line, correlated across beams by the array and along the range by the
// pulse.
#pragma once

#include <optional>
#include <vector>

#include "renderer/acoustics/beam_correlation.hpp"
#include "renderer/acoustics/complex_row.hpp"
#include "renderer/acoustics/pulse.hpp"
#include "renderer/acoustics/random.hpp"
#include "renderer/acoustics/speckle_field.hpp"
#include "renderer/skip_ledger.hpp"

namespace sonard::render {

/// CN(0, 1) per range bin and beam.
struct RandomFieldOfPing {
  RandomKey key;
  SpeckleField* kept = nullptr;  ///< the field kept from ping to ping; null: drawn for each ping
  /// The whole field of a single beam, bin by bin; null for several beams.
  Phasors beam{nullptr, nullptr};
};

/// Draws the field of a single beam: `lines` numbers correlated along the range. `white` and `out` grow as
/// needed.
Phasors draw_along_range(RandomKey key, int lines, const PulseCorrelation& along_range, ComplexRow& white,
                         ComplexRow& out);
/// out[i] = sum_j c_j white[i + reach + j].
Phasors correlate_along_range(const ComplexRow& white, int lines, const PulseCorrelation& along_range,
                              ComplexRow& out);

/// Reads one field; one reader per thread. If lines share a pulse, all lines of a kept field must be evolved
/// before any is read.
class FieldReader {
 public:
  /// All arguments must outlive the reader. @param along_range correlation from line to line. @param skipped
  /// counts the work left out.
  FieldReader(const BeamFilter& filter, const PulseCorrelation& along_range, const RandomFieldOfPing& field,
              const SkipSwitches& skip, SkipCounts& skipped);

  /// The field in one line; valid until the next call.
  Phasors line(int bin);
  /// The real part alone, for half the work.
  const float* real_line(int bin);
  /// Brings one line of a kept field up to date; lines run from -reach of the pulse to `reach` beyond the
  /// last line.
  void evolve(int bin);

 private:
  bool skips(SkipRule rule);
  /// The line if it is not a sum of several rows; nullopt: it is the sum of the rows now in `real_` and
  /// `imaginary_`.
  std::optional<Phasors> unjoined(int bin);
  /// A line of the field correlated across beams alone.
  Phasors row(int bin);
  Phasors draw(int bin, ComplexRow& row);
  int place(int bin) const { return bin + along_range_.reach(); }

  const BeamFilter& filter_;
  const PulseCorrelation& along_range_;
  const RandomFieldOfPing& field_;
  const SkipSwitches& skip_;
  SkipCounts& skipped_;
  int beams_;
  bool copies_;  ///< beams share nothing: rows are not filtered
  ComplexRow white_;
  /// A drawn row, kept because neighbouring lines use it too.
  struct Drawn {
    ComplexRow row;
    int bin;
    Phasors phasors;
  };
  std::vector<Drawn> drawn_;
  std::vector<const float*> real_, imaginary_;  ///< the rows whose weighted sum is a line
  ComplexRow joined_;
};

}  // namespace sonard::render
