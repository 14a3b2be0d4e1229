// Samples of a grid -> echo patches.
#pragma once

#include <cstdint>
#include <vector>

#include "renderer/binning/echo_patch.hpp"
#include "renderer/sample_grid/sample_grid.hpp"
#include "renderer/sample_grid/surface_sample.hpp"

namespace sonard::render {

/// The patches of one column of one beam, cut at the beam's edges and the elevation limit: a pixel is not one
/// range but the span its cell covers on the plane it hit (docs/physics.md 2.3).
/// @param views the samples of every view of `grid`, row after row as SubView orders them.
/// @return the number of samples that were marked invalid.
std::uint64_t make_grid_patches(const SampleGrid& grid, const std::vector<const SurfaceSample*>& views,
                                const ColumnPart& part, std::vector<EchoPatch>& patches);

}  // namespace sonard::render
