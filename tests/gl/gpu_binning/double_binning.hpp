// SPDX-License-Identifier: Apache-2.0
// Binning of a grid of samples in double precision by docs/physics.md 2.3: the truth for both binners. From
// renderer/ it uses the cells of the grid only.
#pragma once

#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/sample_grid/sample_grid.hpp"

namespace sonard::test {

/// The truth of BinningResult::echo.
std::vector<double> bin_in_double(const render::SampleGrid& grid,
                                  const std::vector<const render::SurfaceSample*>& views,
                                  const render::RangeLines& range, const render::BinningOptions& options);

}  // namespace sonard::test
