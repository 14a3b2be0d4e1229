// SPDX-License-Identifier: Apache-2.0
// Estimates the error of a beam from the samples that it was made of (docs/accuracy.md).
#pragma once

#include <vector>

#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sonar_settings.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// What the echo of a beam may be off by.
struct BeamError {
  double total = 0.0;           ///< relative
  double centroid_lines = 0.0;  ///< of the echo in range
};

/// What one column adds to the error of its beam; such errors do not depend on each other.
struct ColumnError {
  double port_rad = 0.0, starboard_rad = 0.0;
  BeamError error;
};

/// The estimated error of a beam by cause: an edge lies somewhere between two columns, or between two rows.
struct BeamErrorEstimate {
  std::vector<ColumnError> columns;  ///< from port to starboard; of a beam without echo none
  BeamError by_columns, by_rows;
  /// Some column has twice the echo of its neighbours: as thin an object may lie unseen between two columns.
  bool thin = false;
};

/// Estimates the error of every beam of `grid` from the change of its echo between columns and between rows.
/// Where a surface goes on, so does the change; where the change jumps there is an edge, which lies anywhere
/// between the centres of the two.
/// @param views what RasterSampler::sample() returned for `grid`.
/// @param line_weight what the echo of each line is yet to be multiplied with; empty: 1.
std::vector<BeamErrorEstimate> estimate_errors(const SampleGrid& grid,
                                               const std::vector<const SurfaceSample*>& views,
                                               const RangeLines& range, const std::vector<float>& line_weight,
                                               WorkerPool& workers);

}  // namespace sonard::render
