// SPDX-License-Identifier: Apache-2.0
// How far off a beam may be, judged by the samples that it was made of (docs/accuracy.md).
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

/// The same of a whole beam, by cause: edges lie somewhere between two columns, or between two rows.
struct JudgedBeam {
  std::vector<ColumnError> columns;  ///< from port to starboard; of a beam without echo none
  BeamError by_columns, by_rows;
  /// Some column hears twice what its neighbours do: as narrow a thing may lie unseen between two columns.
  bool thin = false;
};

/// Judges every beam of `grid` by how its echo changes from column to column and from row to row. Where a
/// surface goes on, the change goes on; where it jumps there is an edge, and that lies anywhere between the
/// centres of the two.
/// @param views what RasterSampler::sample() returned for `grid`.
/// @param line_weight of every line, what the echo is to be multiplied with; empty: 1.
std::vector<JudgedBeam> judge_beams(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                                    const RangeLines& range, const std::vector<float>& line_weight,
                                    WorkerPool& workers);

}  // namespace sonard::render
