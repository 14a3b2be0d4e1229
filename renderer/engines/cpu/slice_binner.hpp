// SPDX-License-Identifier: Apache-2.0
// Slices -> echo per beam and range line.
#pragma once

#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/engines/cpu/slice_sampler.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Shades slices and sums what they echo, which always has footprints.
/// @param cells of `slices`, from port to starboard
/// @param memory as of bin_beams()
BinningResult bin_echoes(const SliceSampler& slices, const std::vector<const SliceCell*>& cells,
                         const Aperture& aperture, const RangeLines& range, const BinningOptions& options,
                         WorkerPool& workers, std::vector<float> memory);

}  // namespace sonard::render
