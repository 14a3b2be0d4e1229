// SPDX-License-Identifier: Apache-2.0
// Settings of the accuracy of sampling.
#pragma once

namespace sonard::render {

/// Nearer surfaces are invisible; distance along the axis of the view.
inline constexpr float nearest_depth_m = 0.02F;

/// Accuracy of sampling: a target error (docs/accuracy.md), pooled RMS over all bins above 1e-2 of their
/// beam's maximum, or a fixed grid of samples.
struct Sampling {
  enum class Preset {
    fast,       ///< 5 %
    normal,     ///< 1 %
    reference,  ///< the smallest possible error, for offline use
    grid,       ///< the grid below, regardless of the error
  } preset = Preset::normal;
  // Only with `grid`:
  int views = 3;  ///< side-by-side frusta; more are used if one would exceed 60 degrees
  int columns_per_view = 256;
  int rows = 512;
  /// false: a sample is a point in range, as in a renderer without footprints; for comparison
  /// (docs/benchmark.md).
  bool footprint = true;
  /// For masks, which must end where their bodies end. Engine `cpu`, not with `grid`: the echo of a facet (a
  /// triangle) lies between its nearest and its furthest range in each slice. Otherwise its ends follow
  /// straight lines across the slice, which may lead beyond its corners, and neighbouring facets make up for
  /// that.
  bool within_facets = false;

  static Sampling of_grid(int views, int columns_per_view, int rows) {
    return {Preset::grid, views, columns_per_view, rows, true, false};
  }
  bool operator==(const Sampling&) const = default;
};

}  // namespace sonard::render
