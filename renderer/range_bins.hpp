// SPDX-License-Identifier: Apache-2.0
// The range bins of a ping.
#pragma once

namespace sonard::render {

/// The range bins of a ping: bin i holds echoes from [i, i+1) * step_m. Output bins are averages (or peaks)
/// of 2^compression_log2 range bins. A remainder is dropped, as in the device.
struct RangeBins {
  int count = 1;             ///< range bins, >= 1
  double step_m = 0.01;      ///< > 0
  int compression_log2 = 0;  ///< 0..4
  bool compression_peak = false;

  double max_range_m() const { return count * step_m; }
  /// Range within which surfaces are rendered: a little beyond the last bin, so that footprints across it
  /// are complete.
  double sampled_range_m() const { return max_range_m() * 1.05; }
  int output_count() const { return count >> compression_log2; }

  bool operator==(const RangeBins&) const = default;
};

}  // namespace sonard::render
