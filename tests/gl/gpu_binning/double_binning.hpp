// SPDX-License-Identifier: Apache-2.0
// Binning of a grid of samples in double precision, straight from docs/physics.md 2.3: the truth for both
// ways to bin. Of renderer/ it takes the cells of the grid, nothing else.
#pragma once

#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/sample_grid/sample_grid.hpp"

namespace sonard::test {

/// What BinningResult::echo is to hold.
std::vector<double> bin_in_double(const render::SampleGrid& grid,
                                  const std::vector<const render::SurfaceSample*>& views,
                                  const render::RangeLines& range, const render::BinningOptions& options);

}  // namespace sonard::test
