// SPDX-License-Identifier: Apache-2.0
// From samples of a grid to echo per beam and range line.
#pragma once

#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Bins the samples of a grid. Sums are exact (RangeProfile), so the result is the same for any number of
/// threads.
/// @param weights of the grid
/// @param views the samples of every view, row after row in the order of SubView
/// @param memory see bin_beams()
BinningResult bin_samples(const SampleGrid& grid, const CellWeights& weights,
                          const std::vector<const SurfaceSample*>& views, const RangeBins& range,
                          const BinningOptions& options, WorkerPool& workers, std::vector<float> memory = {});

}  // namespace sonard::render
