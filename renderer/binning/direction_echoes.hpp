// SPDX-License-Identifier: Apache-2.0
// From patches to the strongest echo of each direction.
#pragma once

#include <vector>

#include "renderer/binning/seen_patches.hpp"
#include "renderer/direction_grid.hpp"
#include "renderer/range_bins.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// The strongest echo of each beam. Its intensity is the largest energy within two adjacent range bins, which
/// are as long as the sonar's range resolution. Its range is the mean of the echo around this peak, down to
/// half of it. If a beam meets two surfaces, the stronger one counts, unless their echoes overlap in range.
/// @param seen within the field of view and 1.25 beamwidths around it, without an elevation pattern
/// @param loss_of_bin factor per range bin
DirectionEchoes find_directions(const SeenPatches& seen, const DirectionGrid& grid, const RangeBins& range,
                                const std::vector<float>& loss_of_bin, WorkerPool& workers);

}  // namespace sonard::render
