// SPDX-License-Identifier: Apache-2.0
// Error of a beam's echo, estimated by the GPU from the samples (docs/accuracy.md).
#pragma once

#include <cstdint>

namespace sonard::render {

/// Error of a beam's echo.
struct BeamError {
  double total = 0.0;           ///< relative
  double centroid_lines = 0.0;  ///< of the echo in range
};

/// Estimated error of a beam's image, from its samples (docs/accuracy.md). The shaders use the same layout.
struct BeamEstimate {
  // By cause: unknown position of an edge between two columns, or between two rows.
  float columns_total = 0.0F, columns_centroid_lines = 0.0F;
  float rows_total = 0.0F, rows_centroid_lines = 0.0F;
  /// Over bins above 1e-2 of the beam's maximum: the sum of (thinned / image - 1)^2, and the number of bins.
  float bin_squares = 0.0F;
  std::uint32_t bins = 0;
  /// Number of columns with twice the echo of their neighbours: an equally thin object may lie unseen between
  /// two columns.
  std::uint32_t thin = 0;
  /// The columns [zone_begin, zone_end) of the beam that contain nearly all edges.
  std::int32_t zone_begin = 0, zone_end = 0;
  float zone_miss = 0.0F;  ///< error of these columns, re the allowed error
};

}  // namespace sonard::render
