// SPDX-License-Identifier: Apache-2.0
// From slices to echo per beam and range line.
#pragma once

#include <vector>

#include "renderer/binning/binning.hpp"
#include "renderer/binning/seen_patches.hpp"
#include "renderer/engines/cpu/slice_sampler.hpp"
#include "renderer/worker_pool.hpp"

namespace sonard::render {

/// Shades slices and bins their echoes, which always have footprints.
/// @param cells of `slices`, from port to starboard
/// @param memory see bin_beams()
BinningResult bin_echoes(const SliceSampler& slices, const std::vector<const SliceCell*>& cells,
                         const Aperture& aperture, const RangeBins& range, const BinningOptions& options,
                         WorkerPool& workers, std::vector<float> memory);

/// Shades slices; for sonars that measure directions.
/// @param cells as for bin_echoes()
SeenPatches see_patches(const SliceSampler& slices, const std::vector<const SliceCell*>& cells,
                        WorkerPool& workers);

}  // namespace sonard::render
