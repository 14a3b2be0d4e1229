// SPDX-License-Identifier: Apache-2.0
// How far off the echo of a beam may be, as the GPU estimates it from the samples (docs/accuracy.md).
#pragma once

#include <cstdint>

namespace sonard::render {

/// What the echo of a beam may be off by.
struct BeamError {
  double total = 0.0;           ///< relative
  double centroid_lines = 0.0;  ///< of the echo in range
};

/// What the samples of a beam tell of the error of its image (docs/accuracy.md). Its layout is that of the
/// shaders.
struct BeamEstimate {
  // By cause: an edge lies somewhere between two columns, or between two rows.
  float columns_total = 0.0F, columns_centroid_lines = 0.0F;
  float rows_total = 0.0F, rows_centroid_lines = 0.0F;
  /// Of the bins above 1e-2 of the beam's maximum: the sum of (thinned / image - 1)^2, and their number.
  float bin_squares = 0.0F;
  std::uint32_t bins = 0;
  /// So many columns have twice the echo of their neighbours: as thin an object may lie unseen between two.
  std::uint32_t thin = 0;
  /// The columns [zone_begin, zone_end) of the beam outside of which there are hardly any edges.
  std::int32_t zone_begin = 0, zone_end = 0;
  float zone_miss = 0.0F;  ///< how often the errors of these columns are what they may be; 1: as large
};

}  // namespace sonard::render
